"""Accuracy of matches: pairs of poses with known correspondences, matched by several methods."""
