"""Readings of the paper, with its patches as printed, and with closed ones. Nothing here follows our own method.

Of all readings: t = 0.1, sums over the K eigenpairs computed, unscaled terms, SMACOF steps with momentum until they
hardly lower the stress, on all vertices. What the paper leaves open is an option: the start, c² or c in the weights,
biharmonic distances as they are or as long as geodesics. With open cells, as printed, the stress separates into one
independent problem per patch; the paper's figures show connected forms, which closed cells give.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from ..distances.spectral import biharmonic_squared, commute_time_squared
from ..embedding.patch_pairs import feature_pairs, patch_pairs
from ..method_api.catalogue import PATIENT, Method
from ..method_api.method_result import MethodResult, warn_if_still_falling
from ..method_api.settings import Settings
from ..method_api.surface_features import SurfaceFeatures
from ..method_api.whole_surface import WholeSurface
from ..numerics.arrays import FloatArray, IntArray
from ..patching.cells import patches_of
from ..run.memory import require_pair_memory
from ..run.monitor import Monitor
from ..stress.majorisation import Majorisation

_FIXED = {"quality": "full", "diffusion_time": 0.1, "contacts": "keep"}
_CONSTANT = 1.0  # exp(0) h_0² on a surface of unit area: [7] is printed with a sum from 0


def _form(found: SurfaceFeatures, settings: Settings, monitor: Monitor, *, closed: bool) -> MethodResult:
    """Unfold a surface as in the paper, section 4."""
    surface, features = found.surface, found.features
    count = len(surface.points)
    patches = patches_of(found.cells, surface.faces, len(features), closed=closed)
    require_pair_memory(count, [len(patch.vertices) for patch in patches], limit=settings.memory_limit, whole=True)
    with monitor.stage("Distances"):
        power = 1.0 if settings.pair_weight == "squared" else 0.5

        def commute_times(vertices: IntArray) -> FloatArray:
            return commute_time_squared(found.spectrum, vertices, vertices) ** power  # c_ij² or c_ij, [8]

        sets = patch_pairs(surface.points, patches, commute_times, None, monitor)
        if len(features) > 1:
            sets.append(feature_pairs(features, _between_features(found, settings), found.adf + _CONSTANT))
    with monitor.stage("Factorisation"):
        stress = Majorisation(sets)  # [10]
    with monitor.stage("Embedding"):
        most = settings.max_iterations
        form, history = stress.lowered(_start(found, settings, monitor), most, tolerance=PATIENT, monitor=monitor)
        warn_if_still_falling(history, PATIENT, most, monitor)
    return MethodResult(form, history, sum(len(pairs.chosen) ** 2 for pairs in sets))


def _between_features(found: SurfaceFeatures, settings: Settings) -> FloatArray:
    """Compute biharmonic distances between the feature points, as they are or as long as geodesics in the mean."""
    features = found.features
    biharmonic = biharmonic_squared(found.spectrum, features, features) ** 0.5  # dB_ij, [9]
    if settings.biharmonic_scale == "geodesic":
        geodesic = found.limbs.to_features[features]
        biharmonic *= (biharmonic * geodesic).sum() / (biharmonic**2).sum()  # least squares
    return biharmonic


def _start(found: SurfaceFeatures, settings: Settings, monitor: Monitor) -> FloatArray:
    """Return the input, or its classical embedding with the outside facing out."""
    if settings.start == "input":
        return found.surface.points
    whole = WholeSurface(found, replace(settings, quality="normal"), monitor)  # all pairs would buy nothing but memory
    return whole.outside_out(whole.samples().classical_embedding())


def _method(name: str, label: str, help: str, source: str, closed: bool, rank: int) -> Method:  # noqa: A002
    return Method(
        name,
        label,
        help,
        source,
        partial(_form, closed=closed),
        stages={"Distances": 25, "Factorisation": 4, "Embedding": 30},
        uses=("start", "pair_weight", "biharmonic_scale", "landmark_count", "max_iterations"),
        pairs="patches",
        rank=rank,
        fixed=_FIXED,
    )


METHODS = (
    _method(
        "as_published",
        "As Published",
        "The paper's stress as printed, on all vertices; the patches are not connected",
        "the paper's equation 10, open cells",
        False,
        9,
    ),
    _method(
        "as_published_closed",
        "As Published, Closed",
        "The paper's stress as printed but with closed patches; the surface stays connected",
        "the paper's equation 10, closed cells",
        True,
        10,
    ),
)
