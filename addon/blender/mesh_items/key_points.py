"""Positions of shape keys."""

from __future__ import annotations

import bpy
import numpy as np


def key_points(key: bpy.types.ShapeKey) -> np.ndarray:
    """Read the positions of a shape key.

    Parameters
    ----------
    key : bpy.types.ShapeKey
        The key.

    Returns
    -------
    (n, 3) ndarray of float32
        The positions.
    """
    points = np.empty((len(key.data), 3), dtype=np.float32)
    key.points.foreach_get("co", points.ravel())
    return points
