"""Transfers weights, UV maps, colours, shape keys and materials from another object."""
