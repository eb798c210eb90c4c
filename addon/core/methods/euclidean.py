"""Unbending without geodesics: some vertices push each other apart while edges keep their lengths.

Pickup, Sun, Rosin and Martin, "Euclidean-distance-based canonical forms for non-rigid 3D shape retrieval", 2015.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from ..embedding.push import far_pairs, wanting_far
from ..mesh.edges import vertex_pairs
from ..method_api.catalogue import PATIENT, Method
from ..method_api.method_result import MethodResult
from ..method_api.settings import Settings
from ..method_api.surface_features import SurfaceFeatures
from ..run.monitor import Monitor
from ..stress.majorisation import Majorisation
from ..stress.pairs import Pairs, length

_PUSH = 1.0  # strength; edges are then stretched by 5 to 10 %
_HARDLY_FALLS = 1e-3  # times the tolerance: most of this stress is what no body can reach, and never falls


def _form(found: SurfaceFeatures, settings: Settings, monitor: Monitor, *, normalised: bool) -> MethodResult:
    """Unfold a surface by pushing random vertices apart: every pair alike, or near pairs as much as far ones."""
    points = found.whole_points
    count = min(settings.landmark_count, len(points))
    samples = np.sort(np.random.default_rng(0).choice(len(points), count, replace=False))
    with monitor.stage("Embedding"):
        ends = vertex_pairs(found.whole_faces)
        edges = Pairs(ends, np.ones(len(ends)), len(points))
        far = far_pairs(samples, [], 0.0, _PUSH, len(points))
        if normalised:
            weight = 1 / length(far.apart(points))
            far = Pairs(far.ends, weight * far.weight.sum() / weight.sum(), len(points))
        stress = Majorisation([edges.wanting_lengths(length(edges.apart(points))), wanting_far(far)])
        form, history = stress.lowered(
            points, settings.max_iterations, tolerance=_HARDLY_FALLS * PATIENT, monitor=monitor
        )
        return MethodResult(form, history, count**2)


METHODS = (
    Method(
        name="euclidean_random",
        label="Euclidean, Random",
        help="Vertices push each other apart (Pickup and others 2015)",
        source="Pickup, Sun, Rosin and Martin 2015, random pairs",
        unfold=partial(_form, normalised=False),
        stages={"Embedding": 59},
        uses=("landmark_count", "max_iterations"),
        rank=5,
    ),
    Method(
        name="euclidean_normalised",
        label="Euclidean, Normalised",
        help="Vertices push each other apart, near ones as much as far ones (Pickup and others 2015)",
        source="Pickup, Sun, Rosin and Martin 2015, normalised pairs",
        unfold=partial(_form, normalised=True),
        stages={"Embedding": 59},
        uses=("landmark_count", "max_iterations"),
        rank=6,
    ),
)
