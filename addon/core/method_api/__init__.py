"""Shared by all methods: settings and their options, costs, the features of a surface, the catalogue."""
