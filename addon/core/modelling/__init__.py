"""A human body made of simple solids, for poses to be taken from."""
