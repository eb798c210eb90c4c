"""What was written to a mesh, kept on the mesh, so that exactly that can be found again and cleared."""
