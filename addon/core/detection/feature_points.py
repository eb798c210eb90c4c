"""Feature points: the prominent maxima of the Auto Diffusion Function (paper section 4)."""

from __future__ import annotations

import numpy as np

from ..mesh.edges import vertex_pairs
from ..numerics.arrays import FloatArray, IntArray

_TIE = 1e-7  # relative difference below which two values count as equal: symmetric shapes have such pairs


def prominent_maxima(values: FloatArray, faces: IntArray, threshold: float = 0.5) -> tuple[IntArray, FloatArray]:
    """Find the local maxima of a positive function and their prominence above their surroundings.

    The prominence of a maximum is the logarithm of its height over the height of the highest pass that leads to a
    higher one (0-dimensional persistence of the super-level sets); for the highest maximum, over the minimum. Ratios
    separate limbs from folds far better than differences: one thin tail stretches the range of the function, but
    not its ratios.

    `values` (n,); `faces` (m, 3); `threshold`: minimum prominence; 0.5 requires 1.65 times the height of the pass;
    gives maxima (k,), prominence (k,).

    Examples
    --------
    >>> strip = np.array([[0, 1, 2], [1, 3, 2], [2, 3, 4]])
    >>> maxima, prominence = prominent_maxima(np.array([8.0, 1, 2, 1, 4]), strip)
    >>> maxima.tolist(), np.exp(prominence).round(6).tolist()
    ([0, 4], [8.0, 2.0])
    """
    values = np.log(values)
    height = _rank(values, _TIE)  # (n,) a strict order, the same for equal values on any machine
    pairs = vertex_pairs(faces)
    summit = _ascend(height, pairs)  # (n,) the maximum that the steepest ascent leads to
    passes = pairs[summit[pairs[:, 0]] != summit[pairs[:, 1]]]
    lower = np.where(height[passes[:, 0]] < height[passes[:, 1]], passes[:, 0], passes[:, 1])
    order = np.argsort(-height[lower], kind="stable")
    parent = {int(peak): int(peak) for peak in np.unique(summit)}
    prominence = dict.fromkeys(parent, float(np.ptp(values)))

    def root(peak: int) -> int:
        while parent[peak] != peak:
            peak = parent[peak]
        return peak

    # only the first pass between two summits can join them: drop the rest before the loop in Python
    ends = np.sort(summit[passes[order]], axis=1)
    _, first = np.unique(ends, axis=0, return_index=True)
    for index in np.sort(first):
        one, two = root(int(ends[index, 0])), root(int(ends[index, 1]))
        if one == two:
            continue
        high, low = (one, two) if height[one] > height[two] else (two, one)
        parent[low] = high
        prominence[low] = float(values[low] - values[lower[order[index]]])
    peaks = np.array(sorted(prominence), dtype=np.int64)
    heights = np.array([prominence[int(peak)] for peak in peaks])
    rank = _rank(heights, _TIE)
    peaks, heights = peaks[np.argsort(-rank)], heights[np.argsort(-rank)]
    keep = heights >= threshold
    keep[0] = True
    return peaks[keep], heights[keep]


def merged(points: IntArray, distances: FloatArray, radius: float) -> IntArray:
    """Drop every feature point that lies close to a more prominent one.

    `points` (k,); `distances` (k, k); `radius`: minimum distance kept, in the same unit; gives (k',).

    Examples
    --------
    >>> distances = np.array([[0.0, 1, 9], [1, 0, 8], [9, 8, 0]])
    >>> merged(np.array([7, 3, 5]), distances, 2.0).tolist()
    [0, 2]
    """
    kept: list[int] = []
    for candidate in range(len(points)):
        if all(distances[candidate, other] >= radius for other in kept):
            kept.append(candidate)
    return np.array(kept, dtype=np.int64)


def _rank(values: FloatArray, tie: float) -> IntArray:
    """Rank the values in ascending order; values that differ by less than `tie` count as equal, lower index first."""
    order = np.argsort(values, kind="stable")
    group = np.concatenate([[0], np.cumsum(np.diff(values[order]) > tie)])
    level = np.empty(len(values), dtype=np.int64)
    level[order] = group
    rank = np.empty(len(values), dtype=np.int64)
    rank[np.lexsort((-np.arange(len(values)), level))] = np.arange(len(values))
    return rank


def _ascend(height: IntArray, pairs: IntArray) -> IntArray:
    """Follow the steepest ascent from every vertex."""
    highest = height.copy()
    np.maximum.at(highest, pairs[:, 0], height[pairs[:, 1]])
    np.maximum.at(highest, pairs[:, 1], height[pairs[:, 0]])
    upwards = np.argsort(height)[highest]
    while True:
        further = upwards[upwards]
        if (further == upwards).all():
            return upwards
        upwards = further
