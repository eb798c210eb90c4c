"""What a mesh and its object hold by name: shape keys, vertex groups, colours, drivers."""
