"""The pairs of equation 10: which distances the stress asks for, and with what weights."""

from __future__ import annotations

import numpy as np

from ..distances.geodesics import all_geodesics
from ..distances.spectral import GreensFunction, commute_time_squared
from ..numerics.arrays import FloatArray, IntArray
from ..run.monitor import Monitor
from ..surface.spectrum import Spectrum
from ..surface.triangulation import triangulated
from ..unfolding.settings import Settings
from .stress import PairSet, pair_set

_NO_DISTANCE = 1e-6  # share of the mean distance in a patch below which the heat method has failed for a pair,
_STRUT_SHARE = 0.5  # weight of the struts of a vertex in the stress, over all its other weight
_SMALL_DISTANCE = 1e-3  # and the share that such a pair gets instead


def patch_pairs(
    points: FloatArray,
    patches: list[IntArray],
    cells: IntArray,
    spectrum: Spectrum,
    green: GreensFunction | None,
    struts: IntArray | None,
    settings: Settings,
    monitor: Monitor,
) -> list[PairSet]:
    """Measure every closed cell and weight all its pairs: ``w_ij = c_ij² / δ_ij²`` (first sum of equation 10).

    Parameters
    ----------
    points : (n, 3) ndarray of float
        Vertices, of a surface of unit area.
    patches : list of (f, 3) ndarray of int
        Triangles of each closed cell.
    cells : (n,) ndarray of int
        Cell of every vertex.
    spectrum : Spectrum
        The eigenpairs.
    green : GreensFunction or None
        For exact commute times. Without it they are summed over the eigenpairs at hand, as published.
    struts : (s, 2) ndarray of int or None
        Pairs of vertices that are to keep their straight distance.
    settings : Settings
        Smoothing of the geodesics, and whether to do as published.
    monitor : Monitor
        Told the progress, warned, and asked whether to stop.

    Returns
    -------
    list of PairSet
        One a patch.

    Raises
    ------
    CancelledError
        If the monitor says so.
    """
    sets = []
    effort = np.cumsum([0.0] + [float(len(patch)) ** 2 for patch in patches])
    effort /= effort[-1]
    short = 0
    for index, patch in enumerate(patches):
        vertices, corners = np.unique(patch, return_inverse=True)
        surface = triangulated(points[vertices], corners.reshape(-1, 3))
        distance = all_geodesics(surface, monitor, settings.heat_time, effort[index], effort[index + 1] - effort[index])
        if settings.as_published:  # open cells: the pairs of the cell's own vertices only
            own = np.flatnonzero(cells[vertices] == index)
            vertices, distance = vertices[own], distance[np.ix_(own, own)]
        mean = float(distance.mean())
        missing = distance < _NO_DISTANCE * mean
        np.fill_diagonal(missing, False)
        short += np.count_nonzero(missing) // 2
        distance[missing] = _SMALL_DISTANCE * mean
        whole = None if green is None else green.commute_time_squared(vertices, monitor)

        def weights(
            rows: slice,
            columns: slice,
            target: FloatArray,
            vertices: IntArray = vertices,
            whole: FloatArray | None = whole,
        ) -> FloatArray:
            monitor.check()
            if whole is None:
                commute = commute_time_squared(spectrum, vertices[rows], vertices[columns])
            else:
                commute = whole[rows, columns]
            return np.divide(commute, target**2, out=np.zeros_like(target), where=target > 0)

        pairs = pair_set(vertices, distance, weights)
        monitor.check()
        sets.append(pairs if struts is None else braced(pairs, points, struts, monitor))
    if short:
        monitor.warn(
            f"{short} pairs of points came out with no distance between them, because of very thin triangles, and were "
            "given a small one. Merge vertices by distance, or remesh, for a better form."
        )
    return sets


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
    """
    heat = adf[features]
    return pair_set(features, biharmonic, lambda rows, columns, _: (heat[rows, None] + heat[None, columns]) / 2)


def arrangement_pairs(landmarks: IntArray, start: FloatArray) -> PairSet:
    """Pair all landmarks, among them the feature points, evenly: the second sum of equation 10, made wider.

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
    """
    from scipy.spatial.distance import pdist, squareform

    wanted = squareform(pdist(start[landmarks]))
    return pair_set(landmarks, wanted, lambda rows, columns, target: np.ones_like(target))


def balanced(pairs: PairSet, patches: list[PairSet], vertex_count: int, share: float) -> PairSet:
    """Scale the pairs between patches to a share of the weight with which the patches hold the same vertices.

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
    """
    total = np.zeros(vertex_count)
    for patch in patches:
        total[patch.vertices] += patch.total_weights()
    own = float(pairs.total_weights().sum())
    return pairs.scaled(share * float(total[pairs.vertices].sum()) / own) if own > 0 else pairs


def braced(patch: PairSet, points: FloatArray, struts: IntArray, monitor: Monitor | None = None) -> PairSet:
    """Ask the stress for the lengths of struts instead of the way round on the surface.

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
    monitor : Monitor, optional
        Asked whether to stop.

    Returns
    -------
    PairSet
        The pairs, those of the struts at their lengths. The struts of a vertex weigh half of all else there together;
        a strut takes the mean of its ends.
    """
    place = np.full(len(points), -1)
    place[patch.vertices] = np.arange(len(patch.vertices))
    pairs = np.sort(place[struts], axis=1)
    inside = pairs[:, 0] >= 0
    length = np.linalg.norm(points[struts[inside, 0]] - points[struts[inside, 1]], axis=1)
    pairs = pairs[inside]
    many = np.bincount(pairs.ravel(), minlength=len(patch.vertices))
    share = _STRUT_SHARE * patch.total_weights() / np.maximum(many, 1)
    return patch.replaced(pairs, length, share[pairs].mean(axis=1), monitor)
