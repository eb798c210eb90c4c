"""Limbs numbered, left and right; mirror images of vertices; limbs rolled, forms made symmetric and upright."""
