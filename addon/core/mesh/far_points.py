"""Points of a cloud that lie far from each other in space."""

from __future__ import annotations

import numpy as np

from ..numerics.arrays import FloatArray, IntArray


def far_points(points: FloatArray, count: int) -> IntArray:
    """Choose points that lie far from each other, one by one, the farthest from the centre first.

    `points` (n, 3); gives their numbers, (min(count, n),), in the order of the points if they are all.

    Examples
    --------
    >>> far_points(np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0], [9, 0, 0]]), 2).tolist()
    [3, 0]
    """
    if len(points) <= count:
        return np.arange(len(points))
    chosen = np.empty(count, dtype=np.int64)
    nearest = ((points - points.mean(axis=0)) ** 2).sum(axis=1)
    for number in range(count):
        chosen[number] = int(np.argmax(nearest))
        apart = ((points - points[chosen[number]]) ** 2).sum(axis=1)
        nearest = apart if number == 0 else np.minimum(nearest, apart)
    return chosen
