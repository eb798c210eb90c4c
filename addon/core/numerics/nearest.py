"""Nearest neighbours among points of many dimensions, where trees do not help."""

from __future__ import annotations

import numpy as np

from ..run.monitor import Monitor
from .arrays import FloatArray, IntArray
from .products import product

_ROWS = 256  # their distances from a few thousand points stay in the cache


def nearest_rows(points: FloatArray, others: FloatArray, monitor: Monitor) -> IntArray:
    """Find the nearest of other points to each point; on a tie, the first.

    `points` (r, d); `others` (s, d); gives (r,).

    Examples
    --------
    >>> nearest_rows(np.array([[0.2], [0.9]]), np.array([[1.0], [0.0]]), Monitor()).tolist()
    [1, 0]
    """
    ends = np.vstack([others.T, (others**2).sum(axis=1)])  # (d + 1, s)
    ways = np.column_stack([-2 * points, np.ones(len(points))])  # (r, d + 1); their product: |o|² - 2 p o
    found = np.empty(len(points), dtype=np.int64)
    for start in range(0, len(points), _ROWS):
        monitor.check()
        rows = slice(start, start + _ROWS)
        found[rows] = product(ways[rows], ends).argmin(axis=1)
    return found


def nearest_others(distances: FloatArray) -> FloatArray:
    """Find how far each of some points is from the nearest other.

    `distances` (k, k); gives (k,).

    Examples
    --------
    >>> nearest_others(np.array([[0.0, 2, 5], [2, 0, 4], [5, 4, 0]])).tolist()
    [2.0, 2.0, 4.0]
    """
    return np.asarray(np.where(np.eye(len(distances), dtype=bool), np.inf, distances).min(axis=1))
