"""What all methods share: settings and their options, costs, the features of a surface, the catalogue."""
