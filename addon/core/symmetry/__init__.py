"""Left and right of a surface: which vertices mirror each other, and forms held to that."""
