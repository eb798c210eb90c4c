"""Triangles given by edge lengths, without positions in space: Delaunay, Laplacian, spectrum; the working surface."""
