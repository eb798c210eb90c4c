"""Triangles with edge lengths, without a place in space: Delaunay, Laplacian, spectrum; the working surface."""
