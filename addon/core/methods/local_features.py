"""The method of this project: patch by patch, the patches held together by an arrangement of the surface's own."""

from __future__ import annotations

from typing import NamedTuple

from ..deformation.detail import detailed, relaxed
from ..deformation.elastic_body import ElasticBody
from ..deformation.struts import struts_through
from ..distances.spectral import GreensFunction
from ..embedding.pairs import balanced, braced, patch_pairs
from ..embedding.smacof import minimise_stress
from ..embedding.start import Start, input_start, intrinsic_start
from ..embedding.straightening import straightened
from ..embedding.stress import PairSet, Stress
from ..embedding.weight_inverse import WeightInverse
from ..measures.alignment import outside_out
from ..measures.form_measures import worst_part_distortion
from ..mesh.geometry import moved_by_frames
from ..method_api.catalogue import MINIMISATION_OPTIONS, Method
from ..method_api.method_result import MethodResult, warn_if_still_falling
from ..method_api.settings import Settings
from ..method_api.surface_features import SurfaceFeatures
from ..numerics.arrays import FloatArray, IntArray
from ..patching.cells import patches_of
from ..run.memory import require_pair_memory
from ..run.monitor import Monitor
from ..symmetry.limb_rolls import limbs_rolled
from ..symmetry.mirror import MirrorMap, asymmetry, held_symmetric
from ..symmetry.partners import mirror_partners

_SOURCE_SHARE = 0.25  # of the working vertices of a patch, from which distances are measured: all give the same form
_STEPS, _FEW_STEPS = 18, 6  # that make the start round: a straight arrangement hardly depends on it
_RELAXING_STEPS = 2  # after the detail pass
_MOST_DISTORTED = 0.195  # edge distortion, 95th percentile in any part, at preserve 1/2
_TRIES, _EXPONENT, _LEAST_SHARE = 3, 3.5, 0.2  # of weaker pulls in the detail pass: distortion goes with pull^(1/3.5)
_WORTHWHILE = 0.25  # of the gain hoped for: with less, edges of a sharp fold are distorted however limbs lie


def local_feature_form(found: SurfaceFeatures, settings: Settings, monitor: Monitor) -> MethodResult:
    """Unfold a surface: pairs inside the patches, a start, SMACOF, straight limbs, left like right, the input's detail.

    Parameters
    ----------
    found : SurfaceFeatures
        The surface, its spectrum, feature points and patches.
    settings : Settings
        Options.
    monitor : Monitor
        Receives progress and warnings; polled for cancellation.

    Returns
    -------
    MethodResult
        The form, not yet aligned to the input.

    Raises
    ------
    TooLargeError
        If all pairs inside the patches do not fit into the memory limit.
    CancelledError
        If the run is cancelled.

    Examples
    --------
    >>> import numpy as np
    >>> from addon.core.method_api.surface_features import detected
    >>> points = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    >>> faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
    >>> settings = Settings(max_iterations=5, preserve_detail=0)
    >>> found = detected(points, faces, None, settings, Monitor())
    >>> local_feature_form(found, settings, Monitor()).points.shape
    (4, 3)

    References
    ----------
    The paper, section 3.4 and equation 10; docs/method.md says where this departs from it.
    """
    inside = monitor.kept(
        "inside", [found, settings.heat_time, settings.memory_limit], lambda: _inside(found, settings, monitor)
    )
    body, green, _ = inside
    start = monitor.kept(
        "start",
        [
            inside,
            settings.start,
            settings.landmark_count,
            settings.smoothing,
            settings.arrangement_share,
            settings.straight,
        ],
        lambda: _start(found, body, green, settings, monitor),
    )
    embedded = monitor.kept(
        "embedded",
        [inside, start, *settings.minimisation.values()],
        lambda: _embedded(found, inside, start, settings, monitor),
    )
    form, mirror = monitor.kept(
        "arranged",
        [embedded, settings.straight, settings.symmetry],
        lambda: _arranged(found, body, embedded.form, start, settings, monitor),
    )
    if settings.preserve_detail > 0:
        with monitor.stage("Detail"):
            form = _with_detail(found, body, form, mirror, settings.preserve_detail, monitor)
    partner = None if mirror is None else mirror.partner
    apart = float("nan") if partner is None else asymmetry(form, partner, body.mass)
    with monitor.stage("Prolongation"):
        form = _prolonged(found, body, form)
        monitor.check()
    return MethodResult(form, embedded.history, embedded.pair_count, apart, partner)


class _Inside(NamedTuple):
    """The surface as an elastic body, and the pairs inside its patches."""

    body: ElasticBody
    green: GreensFunction
    sets: list[PairSet]


class _Embedded(NamedTuple):
    """Where SMACOF ends."""

    form: FloatArray
    history: FloatArray
    pair_count: int


def _inside(found: SurfaceFeatures, settings: Settings, monitor: Monitor) -> _Inside:
    """Measure geodesics and commute times inside the patches, and struts through the interior."""
    surface = found.surface
    patches = patches_of(found.cells, surface.faces, len(found.features))
    sizes = [len(patch.vertices) for patch in patches]
    require_pair_memory(len(surface.points), sizes, limit=settings.memory_limit, whole=settings.whole)
    with monitor.stage("Struts"):
        struts = None
        if settings.heat_time is not None:
            struts = struts_through(surface.points, surface.faces, found.to_features, monitor)
        body = ElasticBody(surface.triangulation, surface.points, surface.faces, struts)
    with monitor.stage("Distances"):
        green = GreensFunction(found.stiffness, found.mass)
        sets = patch_pairs(
            surface.points,
            patches,
            lambda vertices: green.commute_time_squared(vertices, monitor),
            heat_time=settings.heat_time,
            source_share=_SOURCE_SHARE if surface.coarse else 1.0,
            monitor=monitor,
        )
        if struts is not None:
            sets = [braced(pairs, surface.points, struts) for pairs in sets]
    return _Inside(body, green, sets)


def _embedded(found: SurfaceFeatures, inside: _Inside, start: Start, settings: Settings, monitor: Monitor) -> _Embedded:
    """Minimise the stress of the pairs inside the patches and between them."""
    body, _, sets = inside
    count = len(found.surface.points)
    with monitor.stage("Factorisation"):
        if start.between is not None:
            sets = [*sets, balanced(start.between, sets, count, start.share)]
        inverse = WeightInverse(count, sets, monitor)
    with monitor.stage("Embedding"):
        stress = Stress(count, sets, monitor)
        form, history = minimise_stress(stress, inverse, start.points, **settings.minimisation, monitor=monitor)
        warn_if_still_falling(history, settings, monitor)
        return _Embedded(outside_out(body, form), history, sum(pairs.pair_count for pairs in sets))


def _arranged(
    found: SurfaceFeatures, body: ElasticBody, form: FloatArray, start: Start, settings: Settings, monitor: Monitor
) -> tuple[FloatArray, MirrorMap | None]:
    """Make limbs straight, and left like right."""
    if not settings.straight:
        return form, None
    with monitor.stage("Straightening"):
        form = straightened(
            body,
            found.surface.faces,
            form,
            start.landmarks,
            start.depth,
            found.features,
            found.to_features,
            **settings.minimisation,
            monitor=monitor,
        )
        form = limbs_rolled(body, form, found.features, found.to_features, found.limbs, start.depth)
    if settings.symmetry != "hold":
        return form, None
    with monitor.stage("Symmetry"):
        mirror = _mirror(found, body, form, start.landmarks, monitor)
        return (form if mirror is None else held_symmetric(body, form, mirror)), mirror


def _with_detail(
    found: SurfaceFeatures,
    body: ElasticBody,
    form: FloatArray,
    mirror: MirrorMap | None,
    preserve: float,
    monitor: Monitor,
) -> FloatArray:
    """Deform the input towards a form, less closely if that keeps the edges of every part within bounds."""

    def followed(share: float) -> FloatArray:
        shape = detailed(body, form, preserve, monitor, pull_share=share)
        if mirror is not None:
            shape = held_symmetric(body, shape, mirror._replace(sure=mirror.sure * min(1.0, 2 * (1 - preserve))))
        return relaxed(body, shape, _RELAXING_STEPS, monitor, pressure=True)

    most, share = _MOST_DISTORTED * (1 - preserve) / preserve, 1.0
    shape = followed(share)
    distorted = _distortion(found, body, shape, most)
    for _ in range(_TRIES):
        if distorted <= most or share <= _LEAST_SHARE:
            break
        hoped = most / distorted
        weaker = max(share * hoped**_EXPONENT, _LEAST_SHARE)
        tried = followed(weaker)
        reached = _distortion(found, body, tried, most)
        if reached > distorted * hoped**_WORTHWHILE:
            break
        shape, share, distorted = tried, weaker, reached
    return shape


def _distortion(found: SurfaceFeatures, body: ElasticBody, shape: FloatArray, most: float) -> float:
    """Compute how distorted the edges of the worst part are; on all vertices only if coarse edges are too much so."""
    surface = found.surface
    own = surface.faces[: len(surface.faces) - len(surface.bridges)]
    distorted = worst_part_distortion(surface.points, shape, own)
    if surface.coarse and distorted > most:
        distorted = worst_part_distortion(found.whole_points, _prolonged(found, body, shape), found.whole_faces)
    return distorted


def _prolonged(found: SurfaceFeatures, body: ElasticBody, shape: FloatArray) -> FloatArray:
    """Carry a shape of the working vertices over to all vertices."""
    if not found.surface.coarse:
        return shape
    return moved_by_frames(found.whole_points, *found.surface.prolong_frames(*body.frames(shape)))


def _start(
    found: SurfaceFeatures, body: ElasticBody, green: GreensFunction, settings: Settings, monitor: Monitor
) -> Start:
    """Find where the minimisation starts, as the settings say."""
    if settings.start == "input":
        return input_start(found.surface.points, found.features, found.to_features, green, found.adf)
    return intrinsic_start(
        found.surface.triangulation,
        found.spectrum,
        body,
        found.surface.faces,
        found.features,
        found.to_features,
        found.limbs.partner,
        found.limbs.lead,
        landmark_count=settings.landmark_count,
        smoothing=settings.smoothing,
        share=settings.arrangement_share,
        steps=_FEW_STEPS if settings.straight else _STEPS,
        monitor=monitor,
    )


def _mirror(
    found: SurfaceFeatures, body: ElasticBody, form: FloatArray, samples: IntArray, monitor: Monitor
) -> MirrorMap | None:
    """Find left and right on the straight form."""
    return mirror_partners(
        form,
        found.surface.faces,
        body.mass,
        found.spectrum.eigenvectors,
        found.features,
        found.to_features,
        found.limbs,
        samples,
        monitor,
    )


METHODS = (
    Method(
        name="local_features",
        label="Local Features",
        help="The method of this extension",
        source="this project",
        unfold=local_feature_form,
        stages={
            "Struts": 1,
            "Distances": 17,
            "Landmarks": 4,
            "Start": 3,
            "Factorisation": 2,
            "Embedding": 18,
            "Straightening": 5,
            "Symmetry": 5,
            "Detail": 4,
            "Prolongation": 2,
        },
        uses=(
            "start",
            "landmark_count",
            "smoothing",
            "arrangement_share",
            "arrangement",
            "symmetry",
            "preserve_detail",
            *MINIMISATION_OPTIONS,
        ),
        pairs="patches",
        rank=0,
    ),
)
