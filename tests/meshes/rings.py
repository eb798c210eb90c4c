"""Surfaces with a handle."""

import numpy as np


def ring():
    """A torus of 96 times 16 quads, and the angle of each vertex along it."""
    long, round_ = 96, 16
    u, v = np.meshgrid(np.arange(long), np.arange(round_), indexing="ij")
    along, across = 2 * np.pi * u / long, 2 * np.pi * v / round_
    points = np.stack(
        [
            (1 + 0.12 * np.cos(across)) * np.cos(along),
            (1 + 0.12 * np.cos(across)) * np.sin(along),
            0.12 * np.sin(across),
        ],
        axis=-1,
    )
    number = lambda a, b: (a % long) * round_ + b % round_  # noqa: E731
    corners = [number(u, v), number(u + 1, v), number(u + 1, v + 1), number(u, v + 1)]
    a, b, c, d = (each.ravel() for each in corners)
    faces = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    return points.reshape(-1, 3), faces, along.ravel()
