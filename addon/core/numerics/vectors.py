"""Vectors of space as columns, one coordinate after the other: arithmetic on them is several times faster so."""

from __future__ import annotations

import numpy as np

from .arrays import FloatArray, IntArray


def gathered(vectors: FloatArray, chosen: IntArray) -> FloatArray:
    """Gather some vectors as columns.

    `vectors` (n, 3); `chosen` (k,); gives (3, k).

    Examples
    --------
    >>> gathered(np.array([[1.0, 2, 3], [4, 5, 6]]), np.array([1])).tolist()
    [[4.0], [5.0], [6.0]]
    """
    return np.ascontiguousarray(vectors.take(chosen, axis=0).T)


def cross(one: FloatArray, two: FloatArray) -> FloatArray:
    """Compute vector products.

    `one, two` (3, k); gives (3, k).

    Examples
    --------
    >>> cross(np.array([[1.0], [0], [0]]), np.array([[0.0], [1], [0]])).ravel().tolist()
    [0.0, 0.0, 1.0]
    """
    (a, b, c), (x, y, z) = one, two
    return np.stack([b * z - c * y, c * x - a * z, a * y - b * x])


def dot(one: FloatArray, two: FloatArray) -> FloatArray:
    """Compute scalar products.

    `one, two` (3, k); gives (k,).

    Examples
    --------
    >>> dot(np.array([[1.0], [2], [3]]), np.array([[4.0], [5], [6]])).tolist()
    [32.0]
    """
    return np.asarray(one[0] * two[0] + one[1] * two[1] + one[2] * two[2])


def angle(one: FloatArray, two: FloatArray) -> float:
    """Compute the angle between two vectors (3,) in degrees.

    Examples
    --------
    >>> angle(np.array([2.0, 0, 0]), np.array([0.0, 1, 0]))
    90.0
    """
    return float(np.degrees(np.arctan2(np.linalg.norm(np.cross(one, two)), one @ two)))
