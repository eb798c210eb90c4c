"""The pairs of equation 10: which distances the stress asks for, and with what weights."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..distances.farthest_points import farthest_of
from ..distances.patch_geodesics import geodesics
from ..numerics.arrays import FloatArray, IntArray
from ..patching.cells import Patch
from ..run.monitor import Monitor
from ..surface.triangulation import triangulated
from .stress import PairList, PairSet, pair_set

CommuteTimes = Callable[[IntArray], FloatArray]  # squared commute times between all pairs of some vertices

_NO_DISTANCE = 1e-6  # share of the mean distance in a patch below which the heat method has failed for a pair,
_SMALL_DISTANCE = 1e-3  # and the share that such a pair gets instead
_FEWEST_SOURCES = 40  # in a patch
_STRUT_SHARE = 0.5  # weight of the struts of a vertex in the stress, over all its other weight


def patch_pairs(
    points: FloatArray,
    patches: list[Patch],
    commute_times: CommuteTimes,
    *,
    heat_time: float | None = None,
    source_share: float = 1.0,
    monitor: Monitor,
) -> list[PairSet]:
    """Measure every patch and weight its pairs: ``w_ij = c_ij² / δ_ij²`` (first sum of equation 10).

    Parameters
    ----------
    points : (n, 3) ndarray of float
        Vertices, of a surface of unit area.
    patches : list of Patch
        The patches.
    commute_times : callable
        Gives c² between all pairs of some vertices, (p, p).
    heat_time : float, optional
        Diffusion time of smoothed geodesics; without it they are as accurate as the heat method is.
    source_share : float
        Share of the vertices of a patch, far from each other, from which distances are measured, at least 40 vertices.
        At 1 all pairs are, below it those that have a source.
    monitor : Monitor
        Receives progress and warnings; polled for cancellation.

    Returns
    -------
    list of PairSet
        One per patch.

    Raises
    ------
    CancelledError
        If the run is cancelled.

    Examples
    --------
    >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
    >>> patch = Patch(np.array([[0, 1, 2], [1, 3, 2]]), np.arange(4))
    >>> (pairs,) = patch_pairs(square, [patch], lambda vertices: np.ones((4, 4)), monitor=Monitor())
    >>> np.allclose(pairs.weights[0] * pairs.targets[0] ** 2, np.triu(np.ones((4, 4)), 1))
    True

    References
    ----------
    The paper, equation 10. Few sources fix the rest: De Silva and Tenenbaum, "Sparse multidimensional scaling using
    landmark points", 2004.
    """
    sets = []
    effort = np.cumsum([0.0] + [float(len(patch.faces)) ** 2 for patch in patches])
    effort /= effort[-1]
    zero = 0
    for index, patch in enumerate(patches):
        measured, corners = np.unique(patch.faces, return_inverse=True)
        surface = triangulated(points[measured], corners.reshape(-1, 3))
        commute = commute_times(patch.vertices)  # (p, p)
        count = min(max(round(source_share * len(commute)), _FEWEST_SOURCES), len(commute))
        order = _sources_first(commute, count)
        place = np.searchsorted(measured, patch.vertices[order])  # an open cell has fewer vertices than are measured
        distance = geodesics(
            surface,
            place[:count],
            place,
            smooth=heat_time,
            monitor=monitor,
            done=effort[index],
            share=effort[index + 1] - effort[index],
        )  # (s, p)
        mean = float(distance.mean())
        missing = distance < _NO_DISTANCE * mean
        np.fill_diagonal(missing, False)
        distance[missing] = 0.0  # near a source that is measured from one end only: no pair
        both = missing[:, :count]
        zero += np.count_nonzero(both) // 2
        distance[:, :count][both] = _SMALL_DISTANCE * mean

        def weights(
            rows: slice, columns: slice, target: FloatArray, commute: FloatArray = commute, order: IntArray = order
        ) -> FloatArray:
            monitor.check()
            squared = commute[np.ix_(order[rows], order[columns])]
            return np.divide(squared, target**2, out=np.zeros_like(target), where=target > 0)

        sets.append(pair_set(patch.vertices[order], distance, weights))
        monitor.check()
    if zero:
        monitor.warn("zero_distances", count=zero)
    return sets


def _sources_first(commute: FloatArray, count: int) -> IntArray:
    """Order the vertices of a patch: first so many that lie far from each other, then the others as they are."""
    everything = np.arange(len(commute))
    if count == len(commute):
        return everything
    sources = farthest_of(commute, count)
    return np.concatenate([sources, np.setdiff1d(everything, sources)])


def feature_pairs(features: IntArray, biharmonic: FloatArray, adf: FloatArray) -> PairSet:
    """Weight the pairs of feature points by ``(ADF_i + ADF_j) / 2`` (second sum of equation 10).

    Parameters
    ----------
    features : (k,) ndarray of int
        Feature points.
    biharmonic : (k, k) ndarray of float
        Wanted distances between them.
    adf : (n,) ndarray of float
        Auto Diffusion Function.

    Returns
    -------
    PairSet
        The pairs.

    Examples
    --------
    >>> pairs = feature_pairs(np.array([0, 2]), np.array([[0.0, 3], [3, 0]]), np.array([1.0, 9, 7]))
    >>> pairs.targets[0].tolist(), pairs.weights[0].tolist()
    ([[0.0, 3.0], [3.0, 0.0]], [[0.0, 4.0], [0.0, 0.0]])
    """
    heat = adf[features]
    return pair_set(features, biharmonic, lambda rows, columns, _: (heat[rows, None] + heat[None, columns]) / 2)


def arrangement_pairs(landmarks: IntArray, start: FloatArray) -> PairSet:
    """Pair all landmarks, feature points included, with equal weights: equation 10's second sum, extended.

    Parameters
    ----------
    landmarks : (l,) ndarray of int
        The landmarks.
    start : (n, 3) ndarray of float
        The arrangement, whose distances are wanted.

    Returns
    -------
    PairSet
        The pairs.

    Examples
    --------
    >>> pairs = arrangement_pairs(np.array([0, 1]), np.array([[0.0, 0, 0], [3, 4, 0]]))
    >>> pairs.targets[0].tolist()
    [[0.0, 5.0], [5.0, 0.0]]
    """
    from scipy.spatial.distance import pdist, squareform

    wanted = squareform(pdist(start[landmarks]))
    return pair_set(landmarks, wanted, lambda rows, columns, target: np.ones_like(target))


def balanced(pairs: PairSet, patches: list[PairSet], vertex_count: int, share: float) -> PairSet:
    """Scale the weights between patches to a share of the weights that the patches put on the same vertices.

    Parameters
    ----------
    pairs : PairSet
        Pairs between patches.
    patches : list of PairSet
        Pairs inside the patches.
    vertex_count : int
        Number of vertices n.
    share : float
        The share.

    Returns
    -------
    PairSet
        The same pairs under new weights.

    Examples
    --------
    >>> pairs = arrangement_pairs(np.arange(3), np.eye(3))
    >>> balanced(pairs, [pairs], 3, 0.5).total_weights().tolist()
    [1.0, 1.0, 1.0]
    """
    total = np.zeros(vertex_count)
    for patch in patches:
        total[patch.vertices] += patch.total_weights()
    own = float(pairs.total_weights().sum())
    return pairs.scaled(share * float(total[pairs.vertices].sum()) / own) if own > 0 else pairs


def braced(patch: PairSet, points: FloatArray, struts: IntArray) -> PairSet:
    """Add struts through the surface, which weigh more than the distances along it.

    Geodesics alone would rather have a mouth outside its head, where straight distances come nearer to the way over
    the lips.

    Parameters
    ----------
    patch : PairSet
        Pairs inside a patch.
    points : (n, 3) ndarray of float
        Vertices.
    struts : (s, 2) ndarray of int
        Pairs of vertices; those that leave the patch are left out.

    Returns
    -------
    PairSet
        The pairs, and the struts at their lengths. The struts of a vertex weigh half of all else there together; a
        strut takes the mean of its ends.

    Examples
    --------
    >>> points = np.array([[0.0, 0, 0], [3, 4, 0], [0, 1, 0]])
    >>> around = arrangement_pairs(np.arange(3), 2 * points)
    >>> found = braced(around, points, np.array([[0, 1]])).further
    >>> found.pairs.tolist(), found.targets.tolist(), found.weights.tolist()
    ([[0, 1]], [5.0], [1.0])
    """
    place = np.full(len(points), -1)
    place[patch.vertices] = np.arange(len(patch.vertices))
    pairs = place[struts]
    inside = pairs.min(axis=1, initial=len(points)) >= 0
    length = np.linalg.norm(points[struts[inside, 0]] - points[struts[inside, 1]], axis=1)
    pairs = pairs[inside]
    many = np.bincount(pairs.ravel(), minlength=len(patch.vertices))
    share = _STRUT_SHARE * patch.total_weights() / np.maximum(many, 1)
    return replace(patch, further=PairList(pairs, length, share[pairs].mean(axis=1)))
