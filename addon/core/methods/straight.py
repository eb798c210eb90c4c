"""The default: the pose taken out of a surface in five steps.

    1 surface   coarse mesh, feature points, landmarks, distances between them; near pairs share an edge, lie across
                one, or face each other through the body
    2 layout    the landmarks scaled to three dimensions, or to two where the third would be a tie
    3 push      far pairs, the landmarks, want a distance that no body reaches: every limb is pulled straight, and long
    4 lengths   the stretch, averaged over a limb, is undone, limbs made round, and what stretched again undone
    5 detail    the input deformed towards that; hands and feet rolled alike, left made like right, edges mended; then
                carried to all vertices by local rigid motions

The steps pull at one kind of stress, ``Σ w |d - t|² + p Σ m |x - y|²``, over pairs of vertices (d = x_i - x_j),
where t is the vector that a pair wants: its direction with a given length, or its vector in the input, turned with its
surroundings. Lengths are in sqrt(area), times in shares of the area. What each step buys: docs/appendix.md.
"""

from __future__ import annotations

import numpy as np

from ..deformation.elastic_body import ElasticBody
from ..deformation.struts import struts_through
from ..distances.farthest_points import farthest_points
from ..distances.heat import HeatMethod
from ..embedding.layout import Layout, laid_out
from ..embedding.push import far_pairs, wanting_far
from ..mesh.edges import pairs_across_edges
from ..mesh.geometry import moved_by_frames
from ..method_api.catalogue import Method
from ..method_api.method_result import MethodResult
from ..method_api.settings import Settings
from ..method_api.surface_features import SurfaceFeatures
from ..numerics.arrays import FloatArray, IntArray
from ..run.monitor import Monitor
from ..stress.majorisation import Majorisation
from ..stress.pairs import Pairs, length
from ..symmetry.limb_rolls import limbs_rolled
from ..symmetry.limbs import Limbs
from ..symmetry.mirror import asymmetry, held_symmetric
from ..symmetry.partners import mirror_partners

_HEAT = 0.002  # time of the heat that measures distances between landmarks: a bent joint hardly shortens them
_ROUND, _ROUND_STEPS = 40.0, 6  # pull of a shape on the input: limbs become round again, heads wide
_PUSH, _PUSH_STEPS = 40.0, 75  # force of all far pairs together
_ACROSS = 4.0  # stiffness of a pair across an edge: a limb that is pushed does not crumple
_EVEN_EDGE = np.sqrt(3)  # one over the stiffness of an edge between equilateral triangles
_END, _ENDS_SHARE = 0.035, 0.6  # of the way to the next feature point: the end of a limb; and share of the force there
_LIMB = 0.15  # time over which a stretch is averaged: the skin at one joint is stretched in every pose
_PULL, _DETAIL_STEPS = 60.0, 8  # of the detail at preserve 1/2: the one trade between pose and edges
_LEAST_PULL = 0.3  # at any wish for detail
_MEND, _MEND_STEPS = 200.0, 4  # pull of the last steps, which mend edges and move no limb
_BENDING = 0.6  # share of their turned vector in what edges want; the rest wants lengths
_LAYOUT_BENDING = 0.1  # the same in a layout, where a rolled sheet is to unroll
_DETAIL_BENDING = 0.8  # the same in the detail, times preserve²


def straight_form(found: SurfaceFeatures, settings: Settings, monitor: Monitor) -> MethodResult:
    """Unfold a surface: layout by distances alone, push, lengths, detail, left like right."""
    body = monitor.kept("body", [found], lambda: body_of(found, monitor))
    landmarks, distances = monitor.kept(
        "landmarks", [found, settings.landmark_count], lambda: landmarks_of(found, settings.landmark_count, monitor)
    )

    def straightened() -> Layout:
        with monitor.stage("Layout"):
            layout = laid_out(distances, landmarks, body.points, body.faces, found.limbs)
            layout = layout._replace(points=rounded(body, layout.points, monitor))
        with monitor.stage("Push"):
            shape = pushed(body, layout, landmarks, found.limbs, monitor)
        with monitor.stage("Lengths"):
            return layout._replace(points=with_lengths(body, shape, monitor))

    shape, depth = monitor.kept("straightened", [body, landmarks], straightened)
    preserve, mirror = settings.preserve_detail, None
    if preserve > 0:
        with monitor.stage("Detail"):
            shape = limbs_rolled(body, detailed(body, shape, preserve, _PULL, monitor), found.limbs, depth)
        if settings.symmetry == "hold":
            with monitor.stage("Symmetry"):
                mirror = mirror_partners(body, shape, found.spectrum.eigenvectors, found.limbs, landmarks, monitor)
            if mirror is not None:
                shape = held_symmetric(body, shape, mirror._replace(sure=mirror.sure * firmness(preserve)))
        with monitor.stage("Detail"):
            shape = mended(body, shape, monitor)
    partner = None if mirror is None else mirror.partner
    apart = float("nan") if partner is None else asymmetry(shape, partner, body.mass)
    return MethodResult(carried(found, body, shape, monitor), asymmetry=apart, partner=partner)


# 1 surface ----------------------------------------------------------------------------------------------------------


def body_of(found: SurfaceFeatures, monitor: Monitor) -> ElasticBody:
    """Make an elastic body of the surface, with struts through its interior."""
    surface = found.surface
    with monitor.stage("Struts"):
        struts = struts_through(surface.points, surface.faces, found.limbs.to_features, monitor)
        return ElasticBody(found.stiffness, found.mass, surface.points, surface.faces, struts)


def landmarks_of(found: SurfaceFeatures, count: int, monitor: Monitor) -> tuple[IntArray, FloatArray]:
    """Measure smooth distances (n, l) from landmarks (l,), the feature points first."""
    with monitor.stage("Landmarks"):
        heat = HeatMethod(found.surface.triangulation, _HEAT, monitor=monitor)
        return farthest_points(heat, found.features, count, monitor=monitor)


# 2 layout -----------------------------------------------------------------------------------------------------------


def rounded(body: ElasticBody, shape: FloatArray, monitor: Monitor, bending: float = _LAYOUT_BENDING) -> FloatArray:
    """Make limbs round, which scaling flattens and the push makes thin."""
    return body.towards(shape, _ROUND, _ROUND_STEPS, bending=bending, monitor=monitor)


# 3 push -------------------------------------------------------------------------------------------------------------


def pushed(body: ElasticBody, layout: Layout, landmarks: IntArray, limbs: Limbs, monitor: Monitor) -> FloatArray:
    """Pull the limbs straight: far pairs want to be far apart, edges and pairs across them their lengths."""
    count, edge = len(body.points), body.is_edge
    edges = Pairs(body.near.ends[edge], _EVEN_EDGE * body.near.weight[edge], count)
    beside = pairs_across_edges(body.faces)
    across = Pairs(beside, np.full(len(beside), _ACROSS), count)
    far = far_pairs(landmarks, limbs.ends(_END), _ENDS_SHARE, _PUSH, count)
    terms = [
        edges.wanting_lengths(body.length[edge]),
        across.wanting_lengths(length(across.apart(body.points))),
        wanting_far(far, layout.depth),
    ]
    return Majorisation(terms).lowered(layout.points, _PUSH_STEPS, monitor=monitor)[0]


# 4 and 5 lengths and detail ------------------------------------------------------------------------------------------


def with_lengths(body: ElasticBody, shape: FloatArray, monitor: Monitor) -> FloatArray:
    """Give limbs their lengths and girths back: one pulled to a thread has skin of the right lengths, but crumpled."""
    return body.without_stretch(rounded(body, body.without_stretch(shape, _LIMB), monitor, _BENDING), _LIMB)


def detailed(body: ElasticBody, shape: FloatArray, preserve: float, pull: float, monitor: Monitor) -> FloatArray:
    """Deform the input towards a shape, the less the more of its detail is to be preserved (above 0 to 1)."""
    pull = max(pull * ((1 - preserve) / preserve) ** 2, _LEAST_PULL)
    bending = _DETAIL_BENDING * preserve**2
    return body.towards(shape, pull, _DETAIL_STEPS, bending=bending, pressed=True, monitor=monitor)


def firmness(preserve: float) -> float:
    """Tell how far what follows the detail may go: the whole way up to preserve 1/2, nowhere at 1, all rigid."""
    return min(1.0, 2 * (1 - preserve))


def mended(body: ElasticBody, shape: FloatArray, monitor: Monitor) -> FloatArray:
    """Mend the edges of a shape whose limbs are where they belong."""
    return body.towards(shape, _MEND, _MEND_STEPS, bending=_BENDING, pressed=True, monitor=monitor)


def carried(found: SurfaceFeatures, body: ElasticBody, shape: FloatArray, monitor: Monitor) -> FloatArray:
    """Carry a shape of the working vertices to all vertices by the rigid motions of their surroundings."""
    with monitor.stage("Prolongation"):
        monitor.check()
        if not found.surface.coarse:
            return shape
        return moved_by_frames(found.whole_points, *found.surface.prolong_frames(*body.frames(shape)))


METHODS = (
    Method(
        name="straight",
        label="Straight Limbs",
        help="Limbs straight and as far apart as their lengths allow; left like right",
        source="this project",
        unfold=straight_form,
        stages={
            "Struts": 2,
            "Landmarks": 5,
            "Layout": 4,
            "Push": 12,
            "Lengths": 4,
            "Detail": 8,
            "Symmetry": 5,
            "Prolongation": 2,
        },
        uses=("landmark_count", "symmetry", "preserve_detail"),
        pairs="none",
        rank=0,
        area_kept=True,
    ),
)
