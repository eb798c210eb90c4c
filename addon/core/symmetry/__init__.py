"""Limbs identified and numbered, left and right; mirror images of vertices; forms made symmetric and upright."""
