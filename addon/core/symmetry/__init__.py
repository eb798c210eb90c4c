"""Limbs numbered, left and right; mirror images of vertices; arms rolled, forms made symmetric and upright."""
