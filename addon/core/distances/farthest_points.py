"""Farthest point sampling."""

from __future__ import annotations

import numpy as np

from ..numerics.arrays import FloatArray, IntArray
from ..run.monitor import Monitor
from .heat import HeatMethod


def farthest_points(heat: HeatMethod, first: IntArray, count: int, *, monitor: Monitor) -> tuple[IntArray, FloatArray]:
    """Choose points that lie far from each other, one by one.

    `heat`: measures distances on the surface; `first` (k,); `count`: number l of points wanted; gives points (l,),
    distances from them (n, l).

    Examples
    --------
    >>> from addon.core.surface.triangulation import triangulated
    >>> points = np.array([[x, y, 0.0] for y in range(5) for x in range(5)])
    >>> corners = [5 * y + x for y in range(4) for x in range(4)]
    >>> faces = np.array([[i, i + a, i + b] for i in corners for a, b in ((1, 6), (6, 5))])
    >>> heat = HeatMethod(triangulated(points, faces))
    >>> farthest_points(heat, np.array([0]), 2, monitor=Monitor())[0].tolist()
    [0, 24]
    """
    distances = heat.distances(first)
    count = max(min(count, len(distances)), len(first))
    points = [int(point) for point in first]
    columns = [distances[:, i] for i in range(len(first))]
    nearest = distances.min(axis=1)
    while len(points) < count:
        points.append(_farthest(nearest))
        columns.append(heat.distances([points[-1]])[:, 0])
        nearest = np.minimum(nearest, columns[-1])
        monitor.tick(len(points) / count)
    return np.array(points), np.column_stack(columns)


def _farthest(nearest: FloatArray) -> int:
    """Find the largest distance; of mirrored pairs the first, on every machine."""
    return int(np.flatnonzero(nearest >= nearest.max() * (1 - 1e-7))[0])
