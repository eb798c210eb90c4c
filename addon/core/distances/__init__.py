"""Heat method, fast marching, spectral distances, paths along edges; what they cost."""
