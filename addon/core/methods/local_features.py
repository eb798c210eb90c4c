"""The method of this project, from what was found on a surface to its form."""

from __future__ import annotations

import numpy as np

from ..deformation.detail import carried_by_frames, detailed
from ..deformation.elastic_body import ElasticBody
from ..deformation.struts import struts_through
from ..distances.farthest_points import farthest_points
from ..distances.heat import HeatMethod
from ..distances.spectral import GreensFunction
from ..embedding.pairs import arrangement_pairs, balanced, feature_pairs, patch_pairs
from ..embedding.pushing import Pushing
from ..embedding.smacof import minimise_stress
from ..embedding.start import inflated, laid_out, landmark_distances
from ..embedding.stress import PairSet, Stress
from ..embedding.weight_inverse import WeightInverse
from ..measures.alignment import keeps_outside_out
from ..numerics.arrays import FloatArray, IntArray
from ..patching.cells import closed_cell_faces
from ..run.memory import require_pair_memory
from ..run.monitor import Monitor
from ..surface.triangulation import Triangulation
from ..unfolding.embedding import Embedding
from ..unfolding.recognition import Recognition
from ..unfolding.settings import Settings

_FEATURE_SHARE = 0.03  # of the feature points alone, from the input; far more would pull spikes out of the surface
_LAYOUT_SMOOTHING = 0.02  # diffusion time of the landmarks' geodesics over that of the patches


def local_feature_form(found: Recognition, settings: Settings, monitor: Monitor) -> Embedding:
    """Unfold a surface by the paper's method: patch by patch, the patches held together by feature points.

    Parameters
    ----------
    found : Recognition
        The mesh, its spectrum, feature points and patches.
    settings : Settings
        Options.
    monitor : Monitor
        Told the progress, warned, and asked whether to stop.

    Returns
    -------
    Embedding
        The form, not yet aligned to the input.

    Raises
    ------
    TooLargeError
        If all pairs inside the patches do not fit into the memory limit.
    CancelledError
        If the monitor says so.

    References
    ----------
    The paper, section 3.4 and equation 10.
    """
    points, triangles, surface, spectrum = found.points, found.triangles, found.surface, found.spectrum
    features, to_features, cells = found.features, found.to_features, found.cells
    L, M = found.stiffness, found.mass
    patches = [triangles[closed_cell_faces(cells, triangles, index)] for index in range(len(features))]
    require_pair_memory(len(points), [len(np.unique(patch)) for patch in patches], settings)
    with monitor.stage("Struts", 0.44):
        struts = None
        if settings.heat_time is not None:
            struts = struts_through(points, triangles, to_features, monitor)
        body = ElasticBody(surface, points, triangles, struts)
    with monitor.stage("Distances", 0.61):
        green = None if settings.as_published else GreensFunction(L, M)
        sets = patch_pairs(points, patches, cells, spectrum, green, struts, settings, monitor)
    start = points
    if settings.start == "intrinsic":
        with monitor.stage("Landmarks", 0.65):
            landmarks, to_landmarks = _landmarks(surface, features, settings, monitor)
            distances = to_landmarks
            if settings.smoothing > 0:
                distances = landmark_distances(to_landmarks, landmarks, spectrum)
        with monitor.stage("Start", 0.7):
            layout, depth = laid_out(distances, landmarks, points, triangles)
            monitor.check()
            start = inflated(body, layout, monitor)
    with monitor.stage("Factorisation", 0.72):
        between = None
        if settings.start == "intrinsic" and not settings.as_published:
            between = arrangement_pairs(landmarks, start)
        elif len(features) > 1:
            between = _feature_pairs(features, to_features, green or GreensFunction(L, M), found.adf, settings)
        if between is not None:
            if not settings.as_published:
                share = settings.arrangement_share if settings.start == "intrinsic" else _FEATURE_SHARE
                between = balanced(between, sets, len(points), share)
            sets = [*sets, between]
        pair_count = sum(len(pairs.vertices) ** 2 for pairs in sets)
        inverse = WeightInverse(len(points), sets, monitor)
    with monitor.stage("Embedding", 0.9):
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
        if not keeps_outside_out(body, form):
            form = form * [1.0, 1.0, -1.0]
    if settings.unbending > 0 and settings.start == "intrinsic" and not settings.as_published:
        with monitor.stage("Unbending", 0.93):
            pushing = Pushing(points, triangles, landmarks, settings.unbending, depth)
            form = pushing.lowered(form, settings, monitor)[0]
    if settings.preserve_detail > 0 and not settings.as_published:
        with monitor.stage("Detail", 0.97):
            form = detailed(body, form, settings.preserve_detail, monitor)
    if found.coarse is not None:
        with monitor.stage("Alignment", 0.99):
            form = carried_by_frames(found.coarse, body, form, found.whole_points)
            monitor.check()
    return Embedding(form, history, pair_count)


def _landmarks(
    surface: Triangulation, features: IntArray, settings: Settings, monitor: Monitor
) -> tuple[IntArray, FloatArray]:
    """Spread landmarks over the surface, the feature points first, and measure smoothed geodesics from them."""
    time = _LAYOUT_SMOOTHING * settings.smoothing
    heat = HeatMethod(surface, time or None, refine=False, monitor=monitor)
    return farthest_points(heat, features, heat.distances(features), settings.landmarks, monitor)


def _feature_pairs(
    features: IntArray, to_features: FloatArray, green: GreensFunction, adf: FloatArray, settings: Settings
) -> PairSet:
    """Ask for biharmonic distances between the feature points, in the measure of geodesic ones unless as published."""
    biharmonic = green.biharmonic_distances(features)
    scale = 1.0  # s, by least squares
    if not settings.as_published:
        scale = float(np.vdot(biharmonic, to_features[features]) / np.vdot(biharmonic, biharmonic))
    return feature_pairs(features, scale * biharmonic, adf)


def _still_falls(history: FloatArray, settings: Settings) -> bool:
    """Tell whether the minimisation ran out of steps before it met the tolerance, where there is one."""
    steps = len(history) - 1
    if settings.tolerance == 0 or not 0 < steps == settings.iterations:
        return False
    return bool(history[-2] - history[-1] >= settings.tolerance * history[-2])
