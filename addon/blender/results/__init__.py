"""Writes and clears shape key, groups and colours; limbs, in-betweens, frames; one slider for several objects."""
