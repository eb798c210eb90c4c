"""Splits a mesh into pieces, finds bodies and riders, builds bridges, gathers results."""
