"""The pairs of equation 10: which distances the stress asks for, and with what weights."""

from __future__ import annotations

import numpy as np

from .distances import GreensFunction, all_geodesics, commute_time_squared
from .heat import HeatMethod
from .monitor import Monitor
from .settings import Settings
from .spectrum import Spectrum
from .stress import CrossPairs, PairSet, pair_set
from .surface import FloatArray, IntArray, Triangulation, triangulated

_NO_DISTANCE = 1e-6  # share of the mean distance in a patch below which the heat method has failed for a pair,
_SMALL_DISTANCE = 1e-3  # and the share that such a pair gets instead
_CHUNK = 32
_NEAR = 0.05  # in units of the square root of the diffusion time: so near the plain geodesic is taken


def all_patch_pairs(
    points: FloatArray,
    patches: list[IntArray],
    cells: IntArray,
    spectrum: Spectrum,
    green: GreensFunction,
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
        The eigenpairs, for commute times as published.
    green : GreensFunction
        For exact commute times.
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
        if settings.heat_time is None:
            distance = all_geodesics(surface, monitor, effort[index], effort[index + 1] - effort[index])
        else:
            distance = patch_geodesics(surface, np.arange(len(vertices)), settings.heat_time, monitor)
            distance = (distance + distance.T) / 2
            np.fill_diagonal(distance, 0.0)
            monitor.tick(float(effort[index + 1]))
        if settings.as_published:  # open cells: the pairs of the cell's own vertices only
            own = np.flatnonzero(cells[vertices] == index)
            vertices, distance = vertices[own], distance[np.ix_(own, own)]
        mean = float(distance.mean())
        missing = distance < _NO_DISTANCE * mean
        np.fill_diagonal(missing, False)
        short += np.count_nonzero(missing) // 2
        distance[missing] = _SMALL_DISTANCE * mean
        whole = None if settings.as_published else green.commute_time_squared(vertices, monitor)

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

        sets.append(pair_set(vertices, distance, weights))
    _tell_of_missing(short, monitor)
    return sets


def sampled_patch_pairs(
    points: FloatArray,
    patches: list[IntArray],
    features: IntArray,
    spectrum: Spectrum,
    settings: Settings,
    monitor: Monitor,
) -> list[CrossPairs]:
    """Measure every closed cell from samples spread over it, and weight their pairs with all its vertices.

    The weights are those of all pairs, times p / 2s so that the sum stands for all. Of the commute time the pairs
    beyond the spectrum are not summed but taken as they are on average by Weyl's law, ``Σ_{k>K} 2/(4πk)``; without
    them the fingers would have no weight.

    Parameters
    ----------
    points : (n, 3) ndarray of float
        Vertices, of a surface of unit area.
    patches : list of (f, 3) ndarray of int
        Triangles of each closed cell.
    features : (k,) ndarray of int
        Feature point of each patch.
    spectrum : Spectrum
        The eigenpairs.
    settings : Settings
        Number of samples and smoothing of the geodesics.
    monitor : Monitor
        Told the progress, warned, and asked whether to stop.

    Returns
    -------
    list of CrossPairs
        One a patch.

    Raises
    ------
    CancelledError
        If the monitor says so.
    """
    tail = np.log(max(len(points) / len(spectrum.eigenvalues), 1.0)) / (2 * np.pi)
    sets = []
    short = 0
    for index, patch in enumerate(patches):
        monitor.tick(index / len(patches))
        vertices, corners = np.unique(patch, return_inverse=True)
        surface = triangulated(points[vertices], corners.reshape(-1, 3))
        first = int(np.searchsorted(vertices, features[index]))
        sample = spread_samples(spectrum, vertices, first, settings.samples)
        distance = patch_geodesics(surface, sample, settings.heat_time, monitor)
        mean = float(distance.mean())
        missing = distance < _NO_DISTANCE * mean
        own = (np.arange(len(sample)), sample)
        missing[own] = False
        short += np.count_nonzero(missing)
        distance[missing] = _SMALL_DISTANCE * mean
        distance[own] = 1.0
        weight = (commute_time_squared(spectrum, vertices[sample], vertices) + tail) / distance**2
        weight *= len(vertices) / (2 * len(sample))
        distance[own], weight[own] = 0.0, 0.0
        sets.append(CrossPairs(vertices[sample], vertices, distance, weight))
    _tell_of_missing(short, monitor)
    return sets


def patch_geodesics(surface: Triangulation, sources: IntArray, time: float | None, monitor: Monitor) -> FloatArray:
    """Measure geodesics by the heat method, as they are near the source and smoothed far from it.

    Parameters
    ----------
    surface : Triangulation
        The patch.
    sources : (s,) ndarray of int
        Vertices to measure from.
    time : float or None
        Diffusion time of the smoothed ones; None for none.
    monitor : Monitor
        Asked whether to stop.

    Returns
    -------
    (s, p) ndarray of float
        Distances.

    Raises
    ------
    CancelledError
        If the monitor says so.
    """
    near = HeatMethod(surface, refine=False, monitor=monitor)
    far = None if time is None else HeatMethod(surface, time, refine=False, monitor=monitor)
    distance = np.empty((len(sources), surface.vertex_count))
    for start in range(0, len(sources), _CHUNK):
        monitor.check()
        some = sources[start : start + _CHUNK]
        block = near.distances(some)
        if far is not None and time is not None:
            smooth = (1 - np.exp(-(block**2) / (_NEAR**2 * time))) * (far.distances(some) - block)
            block = np.maximum(block + smooth, block / 2)  # far too smooth is 0, or less, around the source
        distance[start : start + _CHUNK] = block.T
    return distance


def spread_samples(spectrum: Spectrum, vertices: IntArray, first: int, count: int) -> IntArray:
    """Choose vertices far from each other in commute time, one after the other.

    Parameters
    ----------
    spectrum : Spectrum
        The eigenpairs.
    vertices : (p,) ndarray of int
        The vertices to choose from.
    first : int
        Position of the first sample among them.
    count : int
        Number of samples wanted.

    Returns
    -------
    (s,) ndarray of int
        Positions of the samples; s = min(count, p).
    """
    place = spectrum.eigenvectors[vertices] / np.sqrt(spectrum.eigenvalues)
    samples = [first]
    nearest = ((place - place[first]) ** 2).sum(axis=1)
    while len(samples) < min(count, len(vertices)):
        tie = np.flatnonzero(nearest >= nearest.max() * (1 - 1e-7))  # mirrored pairs: the first, on every machine
        samples.append(int(tie[0]))
        nearest = np.minimum(nearest, ((place - place[samples[-1]]) ** 2).sum(axis=1))
        nearest[samples[-1]] = -1.0
    return np.array(samples)


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


def arrangement_pairs(landmarks: IntArray, distances: FloatArray) -> PairSet:
    """Pair all landmarks, among them the feature points, evenly: the second sum of equation 10, made wider.

    Parameters
    ----------
    landmarks : (l,) ndarray of int
        The landmarks.
    distances : (l, l) ndarray of float
        Wanted distances between them.

    Returns
    -------
    PairSet
        The pairs.
    """
    return pair_set(landmarks, distances, lambda rows, columns, target: np.ones_like(target))


def balanced(pairs: PairSet, patches: list[PairSet] | list[CrossPairs], vertex_count: int, share: float) -> PairSet:
    """Scale the pairs between patches to a share of the weight with which the patches hold the same vertices.

    Parameters
    ----------
    pairs : PairSet
        Pairs between patches.
    patches : list of PairSet or list of CrossPairs
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
        if isinstance(patch, PairSet):
            total[patch.vertices] += patch.total_weights()
        else:
            total[patch.rows] += patch.weights.sum(axis=1)
            total[patch.columns] += patch.weights.sum(axis=0)
    own = float(pairs.total_weights().sum())
    return pairs.scaled(share * float(total[pairs.vertices].sum()) / own) if own > 0 else pairs


def _tell_of_missing(short: int, monitor: Monitor) -> None:
    if short:
        monitor.warn(
            f"{short} pairs of points came out with no distance between them, because of very thin triangles, and were "
            "given a small one. Merge vertices by distance, or remesh, for a better form."
        )
