"""The paper to the letter, and a second reading of it with closed patches. Nothing here follows our own method.

Start at the input, t = 0.1, sums over the K eigenpairs computed, biharmonic distances as they are, unscaled terms and
plain SMACOF steps, on all vertices. With open cells, as printed, the stress separates into one independent problem per
patch; the paper's figures show connected forms, which closed cells give.
"""

from __future__ import annotations

from functools import partial

from ..distances.spectral import biharmonic_squared, commute_time_squared
from ..embedding.patch_pairs import feature_pairs, patch_pairs
from ..method_api.catalogue import PATIENT, Method
from ..method_api.method_result import MethodResult, warn_if_still_falling
from ..method_api.settings import Settings
from ..method_api.surface_features import SurfaceFeatures
from ..patching.cells import patches_of
from ..run.memory import require_pair_memory
from ..run.monitor import Monitor
from ..stress.majorisation import Majorisation

_LETTER = {"quality": "full", "diffusion_time": 0.1, "contacts": "keep"}


def _form(found: SurfaceFeatures, settings: Settings, monitor: Monitor, *, closed: bool) -> MethodResult:
    """Unfold a surface as in the paper, section 4; the start is the input, so no mirror image is chosen."""
    surface, features, spectrum = found.surface, found.features, found.spectrum
    count = len(surface.points)
    patches = patches_of(found.cells, surface.faces, len(features), closed=closed)
    require_pair_memory(count, [len(patch.vertices) for patch in patches], limit=settings.memory_limit, whole=True)
    with monitor.stage("Distances"):
        sets = patch_pairs(
            surface.points,
            patches,
            lambda vertices: commute_time_squared(spectrum, vertices, vertices),  # c_ij², [8]
            None,
            monitor,
        )
        if len(features) > 1:
            biharmonic = biharmonic_squared(spectrum, features, features) ** 0.5  # dB_ij, [9]
            sets.append(feature_pairs(features, biharmonic, found.adf))
    with monitor.stage("Factorisation"):
        stress = Majorisation(sets)  # [10]
    with monitor.stage("Embedding"):
        most = settings.max_iterations
        form, history = stress.lowered(surface.points, most, tolerance=PATIENT, momentum=False, monitor=monitor)
        warn_if_still_falling(history, PATIENT, most, monitor)
    return MethodResult(form, history, sum(len(pairs.chosen) ** 2 for pairs in sets))


def _method(name: str, label: str, help: str, source: str, closed: bool, rank: int) -> Method:  # noqa: A002
    return Method(
        name,
        label,
        help,
        source,
        partial(_form, closed=closed),
        stages={"Distances": 25, "Factorisation": 4, "Embedding": 30},
        uses=("max_iterations",),
        pairs="patches",
        rank=rank,
        fixed=_LETTER,
    )


METHODS = (
    _method(
        "as_published",
        "As Published",
        "The paper to the letter, on all vertices; the patches are not connected",
        "the paper to the letter, open cells",
        False,
        9,
    ),
    _method(
        "as_published_closed",
        "As Published, Closed",
        "The paper to the letter but with closed patches; the surface stays connected",
        "the paper with closed cells",
        True,
        10,
    ),
)
