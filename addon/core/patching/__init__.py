"""Geodesic Voronoi cells, open and closed."""
