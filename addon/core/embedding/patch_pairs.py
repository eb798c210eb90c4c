"""The pairs of equation 10: which distances the stress asks for, and with what weights."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..distances.patch_geodesics import geodesics
from ..numerics.arrays import FloatArray, IntArray
from ..patching.cells import Patch
from ..run.monitor import Monitor
from ..stress.pairs import AllPairs
from ..surface.triangulation import triangulated

_NO_DISTANCE = 1e-6  # share of the mean distance in a patch below which the heat method has failed for a pair,
_SMALL_DISTANCE = 1e-3  # and the share that such a pair gets instead


def patch_pairs(
    points: FloatArray,
    patches: list[Patch],
    commute_times: Callable[[IntArray], FloatArray],
    heat_time: float | None,
    monitor: Monitor,
) -> list[AllPairs]:
    """Measure every patch and weight its pairs, ``w_ij = c_ij² / δ_ij²`` (first sum of equation 10).

    `commute_times` gives c² between some vertices; `heat_time` is the time over which geodesics are averaged, None for
    the shortest. Warns of pairs without a distance.
    """
    sets, failed = [], 0
    effort = np.cumsum([0.0] + [float(len(patch.faces)) ** 2 for patch in patches])
    effort /= effort[-1]
    for index, patch in enumerate(patches):
        measured, corners = np.unique(patch.faces, return_inverse=True)
        place = np.searchsorted(measured, patch.vertices)  # an open cell has fewer vertices than are measured
        distance = geodesics(
            triangulated(points[measured], corners.reshape(-1, 3)),
            place,
            place,
            smooth=heat_time,
            monitor=monitor,
            done=effort[index],
            share=effort[index + 1] - effort[index],
        )  # δ, (p, p)
        mean = float(distance.mean())
        missing = distance < _NO_DISTANCE * mean
        np.fill_diagonal(missing, False)
        failed += np.count_nonzero(missing) // 2
        distance[missing] = _SMALL_DISTANCE * mean
        weight = np.divide(commute_times(patch.vertices), distance**2, out=np.zeros_like(distance), where=distance > 0)
        sets.append(AllPairs(patch.vertices, distance, weight, len(points)))
        monitor.check()
    if failed:
        monitor.warn("zero_distances", count=failed)
    return sets


def feature_pairs(features: IntArray, biharmonic: FloatArray, adf: FloatArray) -> AllPairs:
    """Weight the pairs of feature points by ``(ADF_i + ADF_j) / 2`` (second sum of equation 10).

    Examples
    --------
    >>> pairs = feature_pairs(np.array([0, 2]), np.array([[0.0, 3], [3, 0]]), np.array([1.0, 9, 5]))
    >>> pairs.weights.tolist()
    [[1.0, 3.0], [3.0, 5.0]]
    """
    heat = adf[features]
    return AllPairs(features, biharmonic, (heat[:, None] + heat) / 2, len(adf))


def landmark_pairs(landmarks: IntArray, layout: FloatArray, patches: list[AllPairs], share: float) -> AllPairs:
    """Pair all landmarks alike: equation 10's second sum, extended; they want the distances that a layout has.

    Their weights are a share of those that the patches put on the same vertices.

    Examples
    --------
    >>> line = np.array([[0.0, 0, 0], [1, 0, 0], [3, 0, 0]])
    >>> patch = AllPairs(np.arange(3), np.ones((3, 3)), np.ones((3, 3)) - np.eye(3), 3)
    >>> pairs = landmark_pairs(np.array([0, 2]), line, [patch], 0.5)
    >>> pairs.distances.tolist(), pairs.weights.sum()
    ([[0.0, 3.0], [3.0, 0.0]], 2.0)
    """
    from scipy.spatial.distance import cdist

    wanted = cdist(layout[landmarks], layout[landmarks])
    weights = 1.0 - np.eye(len(landmarks))
    total = total_weights(patches, len(layout))
    weights *= share * total[landmarks].sum() / max(weights.sum(), 1.0)
    return AllPairs(landmarks, wanted, weights, len(layout))


def total_weights(patches: list[AllPairs], count: int) -> FloatArray:
    """Sum the weights of all pairs that each of `count` vertices is in."""
    total = np.zeros(count)
    for patch in patches:
        total[patch.chosen] += patch.weights.sum(axis=1)
    return total
