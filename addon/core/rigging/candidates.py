"""The ways in which a body may face, each with a skeleton, the likeliest first: one decision of up, front and left."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..matching.point_map import PointMap, point_map
from ..matching.sides import Side, sides
from ..matching.unfolded import Unfolded
from ..mesh.geometry import vertex_areas
from ..numerics.arrays import FloatArray
from ..run.monitor import Monitor
from .articulated_fit import Explained, explained, turned_round
from .evidence import beyond_limits, skin_alike, toes_forward, trunk_axes, unlike_sides
from .reference_rig import ReferenceRig

_STANDING = 0.3  # correlation of heights above which a match leaves the body as it stands
_SAME = 0.5  # cosine between axes of two skeletons below which they face different ways
_MAPS = 4  # matches that are completed, at most
_RESIDUAL, _DEGREES, _UNLIKE, _TOES = 0.01, 100.0, 0.1, 0.1  # what weighs as much as each other
_MOST_DEGREES, _MOST_TOES = 400.0, 0.2  # beyond which more tells nothing
_SPREAD = 0.2  # residual of a vertex beyond which more tells nothing


class Candidate(NamedTuple):
    """A body that faces one way.

    Attributes
    ----------
    turned : bool
        Whether the match was turned back to front.
    found : PointMap
        The match, of all vertices.
    fit : Explained
        The skeleton, on the working vertices.
    residual : float
        Mean distance of the skin from where the skeleton puts it, in sizes of the body.
    degrees : dict of str to float
        By how much each joint is bent beyond what bodies can.
    unlike : float
        How different left and right limbs are.
    skin : float
        Least ratio of the skin of a limb's bone to that of its partner.
    confidence : float
        Mean confidence of the match.
    cost : float
        All that together; lower is likelier.
    """

    turned: bool
    found: PointMap
    fit: Explained
    residual: float
    degrees: dict[str, float]
    unlike: float
    skin: float
    confidence: float
    cost: float


def candidates(one: Unfolded, other: Unfolded, rig: ReferenceRig, monitor: Monitor) -> list[Candidate]:
    """Fit the skeleton of a reference to a body in every way in which it may face, the likeliest first.

    Every match is fitted as it is and turned back to front. What decides is how well the skeleton explains the skin,
    joints that bend the wrong way, sides of different lengths, and toes, measured on the skin: none of them alone tells
    all bodies.

    `one`: the body; `other`: the reference; `rig`: its skeleton, on all its vertices.
    """
    own = one.found
    surface, kept = own.surface, own.surface.kept
    coarse = rig.at(other.found.surface.kept, other.found.surface.faces)
    areas = vertex_areas(surface.points, surface.faces)
    share = areas / areas.sum()
    samples = surface.points[_spread(share)]
    ways = sides(one, other, monitor)
    upright = [way for way in ways if _standing(one, other, rig, way) > _STANDING]
    found: list[Candidate] = []
    for number, way in enumerate((upright or ways)[:_MAPS]):
        each = point_map(one, other, way, monitor)
        at, weights = (each.points.on(values, other.found.whole_faces)[kept] for values in (rig.vertices, rig.weights))
        sure = each.confidence[kept]
        for turned in (False, True):
            match = turned_round(coarse, at, weights) if turned else (at, weights)
            fit = explained(coarse, surface.points, surface.faces, areas, *match, sure, monitor)
            residual = float(share @ np.minimum(fit.residual, _SPREAD))
            degrees = beyond_limits(coarse, fit.bones)
            unlike = unlike_sides(coarse, fit.bones)
            toes = toes_forward(coarse, fit.bones, samples)
            cost = (
                residual / _RESIDUAL
                + min(sum(degrees.values()), _MOST_DEGREES) / _DEGREES
                + unlike / _UNLIKE
                - float(np.clip(toes, -_MOST_TOES, _MOST_TOES)) / _TOES
            )
            skin = skin_alike(coarse, areas, fit.weights)
            found.append(Candidate(turned, each, fit, residual, degrees, unlike, skin, float(share @ sure), cost))
        monitor.tick((number + 1) / _MAPS)
    return _facing_apart(coarse, sorted(found, key=lambda each: each.cost), bool(upright))


def _facing_apart(rig: ReferenceRig, found: list[Candidate], upright: bool) -> list[Candidate]:
    """Keep the likeliest of those that face one way, and of a body that stands, what does not fall."""
    axes = [np.array(trunk_axes(rig, each.fit.bones)) for each in found]  # (2, 3) each
    chosen: list[int] = []
    for number, own in enumerate(axes):
        falls = upright and own[1, 2] <= 0
        if not falls and all(((own * axes[other]).sum(axis=1) < _SAME).any() for other in chosen):
            chosen.append(number)
    return [found[number] for number in chosen or range(len(found))]


def _standing(one: Unfolded, other: Unfolded, rig: ReferenceRig, way: Side) -> float:
    """Correlate the heights of a body in its file with those of the reference where its form lies on that one's."""
    from scipy.spatial import cKDTree

    place = one.form @ way.start.rotation + way.start.shift
    there = cKDTree(other.form).query(place)[1]
    heights = one.found.surface.points[:, 2], rig.vertices[other.found.surface.kept[there], 2]
    return float(np.corrcoef(*heights)[0, 1])


def _spread(share: FloatArray, count: int = 6000) -> np.ndarray:
    """Choose vertices as often as their area asks for."""
    steps = (np.arange(count) + 0.5) / count
    return np.minimum(np.searchsorted(np.cumsum(share), steps), len(share) - 1)
