"""The whole way from a mesh to its canonical form, step by step in the order of the paper."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .alignment import keeps_outside_out, rigid_fit
from .deformation import deformed_towards
from .delaunay import intrinsic_delaunay
from .distances import GreensFunction, all_geodesics, commute_time_squared
from .errors import InvalidSettingsError, TooLargeError
from .features import merged, prominent_maxima
from .heat import HeatMethod
from .laplacian import mass, stiffness
from .measures import surface_area
from .monitor import Cancelled, Monitor, Progress
from .patches import closed_cell_faces, voronoi_cells
from .scaling import farthest_points, landmark_scaling
from .settings import Settings
from .smacof import WeightInverse, minimise_stress
from .spectrum import Spectrum, auto_diffusion, compute_spectrum
from .stress import PairSet, Stress, pair_set
from .surface import FloatArray, IntArray, Triangulation, checked_mesh, triangulated

_NO_DISTANCE = 1e-6  # share of the mean distance in a patch below which the heat method has failed for a pair,
_SMALL_DISTANCE = 1e-3  # and the share that such a pair gets instead
_INFLATION_PULL = 10.0  # 1/area: the layout shapes what is larger than a limb, the surface what is smaller
_INFLATION_STEPS = 20


@dataclass(frozen=True, eq=False)
class CanonicalForm:
    """The canonical form of a mesh and what was found on the way.

    Attributes
    ----------
    vertices : (n, 3) ndarray of float
        The form: the input's area, rigidly aligned to the input.
    feature_points : (k,) ndarray of int
        Vertices, most prominent first.
    patches : (n,) ndarray of int
        Index into `feature_points` of the patch that each vertex belongs to.
    adf : (n,) ndarray of float
        Auto Diffusion Function of the surface scaled to unit area.
    stress : (s + 1,) ndarray of float
        Equation 10 before each of the s steps and after the last, of the surface scaled to unit area.
    pair_count : int
        Entries of the distance matrices that the stress uses, counted as the paper does: Σ p² over the patches and
        the feature points. Each pair of points is kept once.
    pair_reduction : float
        ``1 - pair_count / n²``.
    timings : dict of str to float
        Seconds by stage.
    warnings : list of str
        Sentences for the user.
    """

    vertices: FloatArray
    feature_points: IntArray
    patches: IntArray
    adf: FloatArray
    stress: FloatArray
    pair_count: int
    pair_reduction: float
    timings: dict[str, float]
    warnings: list[str]


def canonical_form(
    vertices: ArrayLike,
    faces: ArrayLike,
    settings: Settings | None = None,
    progress: Progress | None = None,
    cancelled: Cancelled | None = None,
) -> CanonicalForm:
    """Compute the canonical form of a posed mesh: its shape with the pose taken out.

    Parameters
    ----------
    vertices : (n, 3) array_like of float
        Vertex positions, any unit of length.
    faces : (m, 3) array_like of int
        Triangles of one connected surface, with or without borders.
    settings : Settings, optional
        Options.
    progress : callable, optional
        Called with the fraction done (0 to 1) and the name of the stage.
    cancelled : callable, optional
        Asked at least twice a second; the computation stops when it returns True.

    Returns
    -------
    CanonicalForm
        The form, feature points, patches and figures.

    Raises
    ------
    InvalidMeshError
        If the mesh cannot be used; the message says what to do.
    InvalidSettingsError
        If a feature point given by hand is not a vertex, or is given twice.
    TooLargeError
        If all pairs inside the patches do not fit into the memory limit.
    SolverError
        If the spectrum cannot be computed accurately.
    CancelledError
        If `cancelled` returned True.
    """
    settings = settings or Settings()
    monitor = Monitor(progress, cancelled)
    with monitor.stage("Surface", 0.01):
        points, triangles = checked_mesh(vertices, faces)
        given = _checked_features(settings.feature_points, len(points))
        centre, unit = points.mean(axis=0), float(np.ptp(points, axis=0).max())
        points = (points - centre) / unit
        size = np.sqrt(surface_area(points, triangles))
        points, unit = points / size, unit * size
        surface = intrinsic_delaunay(triangulated(points, triangles))
        L, M = stiffness(surface), mass(surface)
    with monitor.stage("Spectrum", 0.06):
        spectrum = compute_spectrum(L, M, settings.eigenpairs, monitor)
        if len(spectrum.eigenvalues) < settings.eigenpairs:
            monitor.warn(f"The mesh is small: all {len(spectrum.eigenvalues)} eigenpairs that it has were used.")
    with monitor.stage("Feature points", 0.08):
        adf = auto_diffusion(spectrum, settings.diffusion_time)
        heat = HeatMethod(surface, monitor=monitor)
        features = prominent_maxima(adf, triangles, settings.prominence)[0] if given is None else given
        monitor.check()
        to_features = heat.distances(features)
        if given is None:
            kept = merged(features, to_features[features], settings.merge_distance * float(to_features.max()))
            features, to_features = features[kept], to_features[:, kept]
    with monitor.stage("Patches", 0.09):
        cells = voronoi_cells(to_features, features, triangles)
        patches = [triangles[closed_cell_faces(cells, triangles, index)] for index in range(len(features))]
        _require_memory(len(points), [len(np.unique(patch)) for patch in patches], settings.memory_limit)
    with monitor.stage("Distances", 0.45):
        green = GreensFunction(L, M)
        sets = _patch_pairs(points, patches, cells, spectrum, green, settings, monitor)
        if len(features) > 1:
            sets.append(
                _feature_pairs(features, to_features, green.biharmonic_distances(features), adf, sets, settings)
            )
        pair_count = sum(len(pairs.vertices) ** 2 for pairs in sets)
    start = points
    if settings.start == "intrinsic":
        with monitor.stage("Landmarks", 0.48):
            landmarks, to_landmarks = farthest_points(heat, features, to_features, settings.landmarks, monitor)
            layout = landmark_scaling(to_landmarks, landmarks)
        with monitor.stage("Start", 0.5):
            start = _inflated(surface, points, layout, monitor)
    with monitor.stage("Factorisation", 0.55):
        inverse = WeightInverse(len(points), sets, monitor)
    with monitor.stage("Embedding", 0.99):
        stress = Stress(len(points), sets, monitor)
        extrapolation = 0 if settings.as_published else settings.extrapolation
        form, history = minimise_stress(
            stress, inverse, start, settings.iterations, settings.tolerance, extrapolation, monitor
        )
        if _still_falls(history, settings):
            monitor.warn(
                f"The stress was still falling after {settings.iterations} steps. More iterations will change the form "
                "a little further."
            )
    with monitor.stage("Alignment", 1.0):
        if not keeps_outside_out(surface, points, form):
            form = form * [1.0, 1.0, -1.0]
        form = form / np.sqrt(surface_area(form, triangles))
        rotation, shift = rigid_fit(form, points, M)
        form = (form @ rotation + shift) * unit + centre
    return CanonicalForm(
        form,
        features,
        cells,
        adf,
        history,
        pair_count,
        1 - pair_count / len(points) ** 2,
        monitor.timings,
        monitor.warnings,
    )


def _inflated(surface: Triangulation, points: FloatArray, layout: FloatArray, monitor: Monitor) -> FloatArray:
    """Give the limbs of a layout, which classical scaling squashes, the roundness they have on the surface."""
    if not keeps_outside_out(surface, points, layout):
        layout = layout * [1.0, 1.0, -1.0]
    return deformed_towards(surface, points, layout, pull=_INFLATION_PULL, steps=_INFLATION_STEPS, monitor=monitor)


def _still_falls(history: FloatArray, settings: Settings) -> bool:
    """Tell whether the minimisation ran out of steps before it met the tolerance, where there is one."""
    steps = len(history) - 1
    if settings.tolerance == 0 or not 0 < steps == settings.iterations:
        return False
    return bool(history[-2] - history[-1] >= settings.tolerance * history[-2])


def _checked_features(given: object, vertex_count: int) -> IntArray | None:
    if given is None:
        return None
    features = np.asarray(given)
    if features.ndim != 1 or not features.size or not np.issubdtype(features.dtype, np.integer):
        raise InvalidSettingsError("feature_points must be a list of at least one vertex index.")
    if features.min() < 0 or features.max() >= vertex_count:
        raise InvalidSettingsError(f"feature_points must lie between 0 and {vertex_count - 1}.")
    if len(np.unique(features)) < len(features):
        raise InvalidSettingsError("feature_points names a vertex twice.")
    return features.astype(np.int64)


def _require_memory(vertex_count: int, sizes: list[int], limit: float) -> None:
    """Refuse before the memory is spent: tiles and factors of every patch, three matrices of the largest."""
    needed = 8 * (2 * sum(p**2 for p in sizes) + 3 * max(sizes) ** 2) / 1e9
    if needed > limit:
        raise TooLargeError(
            f"All pairs of points inside the {len(sizes)} patches need about {needed:.1f} GB, more than the limit of "
            f"{limit:g} GB. Reduce the mesh to about {int(vertex_count * np.sqrt(limit / needed)):,} vertices (for "
            "instance with a Decimate modifier, applied), or raise the memory limit."
        )


def _patch_pairs(
    points: FloatArray,
    patches: list[IntArray],
    cells: IntArray,
    spectrum: Spectrum,
    green: GreensFunction,
    settings: Settings,
    monitor: Monitor,
) -> list[PairSet]:
    """Measure every closed cell and weight its pairs: ``w_ij = c_ij² / δ_ij²`` (first sum of equation 10)."""
    sets = []
    effort = np.cumsum([0.0] + [float(len(patch)) ** 2 for patch in patches])
    effort /= effort[-1]
    short = 0
    for index, patch in enumerate(patches):
        vertices, corners = np.unique(patch, return_inverse=True)
        surface = triangulated(points[vertices], corners.reshape(-1, 3))
        distance = all_geodesics(surface, monitor, effort[index], effort[index + 1] - effort[index])
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
    if short:
        monitor.warn(
            f"{short} pairs of points came out with no distance between them, because of very thin triangles, and were "
            "given a small one. Merge vertices by distance, or remesh, for a better form."
        )
    return sets


def _feature_pairs(
    features: IntArray,
    to_features: FloatArray,
    biharmonic: FloatArray,
    adf: FloatArray,
    patch_sets: list[PairSet],
    settings: Settings,
) -> PairSet:
    """Weight the pairs of feature points by ``(ADF_i + ADF_j) / 2`` (second sum of equation 10)."""
    heat = adf[features]
    scale = 1.0  # s: biharmonic distances in the measure of geodesic ones, by least squares
    if not settings.as_published:
        scale = float(np.vdot(biharmonic, to_features[features]) / np.vdot(biharmonic, biharmonic))
    pairs = pair_set(
        features, scale * biharmonic, lambda rows, columns, _: (heat[rows, None] + heat[None, columns]) / 2
    )
    if settings.as_published:
        return pairs
    held = sum(float(patch.total_weights()[np.isin(patch.vertices, features)].sum()) for patch in patch_sets)
    return pairs.scaled(settings.feature_share * held / float(pairs.total_weights().sum()))
