"""Heat method, fast marching, spectral distances, paths along edges; their cost."""
