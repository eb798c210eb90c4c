"""The ways in which a body may face, each with a skeleton, the likeliest first: one decision of up, front and left."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from ..matching.point_map import working_map
from ..matching.sides import Side, scored_sides, sides
from ..matching.unfolded import Unfolded
from ..mesh.closest_points import SurfacePoints
from ..mesh.geometry import vertex_areas, vertex_normals
from ..numerics.arrays import FloatArray, IntArray
from ..numerics.shares import spread
from ..run.monitor import Monitor
from ..symmetry.limb_names import side_of
from .articulated_fit import ALIKE, UNLIKE, Explained, explained, turned_round
from .evidence import beyond_limits, skin_alike, toes_forward, trunk_axes, unlike_sides
from .references import Reference

_STANDING = 0.3  # correlation of heights above which a match leaves the body as it stands
_SAME = 0.5  # cosine between axes of two skeletons below which they face different ways
_MAPS = 2  # matches with a reference that are completed: the second rescues what the score misjudged
_ROWS = 700  # vertices on which fits are compared
_SAMPLES = 6000  # by which toes are measured
GOOD = 2.0  # cost up to which no other build is tried
_ALONE, _AGAIN = 0.55, 0.85  # of the work, after the adult, and before the likeliest are fitted in full
_RESIDUAL, _DEGREES, _TOES = 0.005, 200.0, 0.1  # what weighs as much as each other
_MOST_DEGREES, _MOST_TOES = 400.0, 0.2  # beyond which more tells nothing
_SPREAD = 0.2  # residual of a vertex beyond which more tells nothing


class Points(NamedTuple):
    """The points of a reference that the working vertices of a body are.

    Attributes
    ----------
    there : SurfacePoints
        Points on the triangles of its working surface.
    sure : (c,) ndarray of float
        Confidence of each, 0 to 1.
    """

    there: SurfacePoints
    sure: FloatArray


class Candidate(NamedTuple):
    """A body that faces one way.

    Attributes
    ----------
    reference : Reference
        Whose skeleton it is.
    found : Points
        Its points, by a match.
    turned : bool
        Whether they were turned back to front.
    stands : bool
        Whether the body stays as it stands in its file.
    fit : Explained
        The skeleton.
    residual : float
        Mean distance of the skin from where the skeleton puts it, in sizes of the body.
    degrees : dict of str to float
        By how much each joint is bent beyond what bodies can.
    unlike : float
        How different left and right limbs are.
    skin : float
        Least ratio of the skin of a limb's bone to that of its partner.
    confidence : float
        Mean confidence of the points.
    cost : float
        Residual, degrees and toes together; lower is likelier.
    trust : float
        Mean confidence of the points that the skeleton explains.
    """

    reference: Reference
    found: Points
    turned: bool
    stands: bool
    fit: Explained
    residual: float
    degrees: dict[str, float]
    unlike: float
    skin: float
    confidence: float
    cost: float
    trust: float


class _Skin(NamedTuple):
    """The skin of a body, or samples of it."""

    rows: IntArray  # (r,) of its working vertices
    points: FloatArray  # (r, 3)
    normals: FloatArray  # (r, 3)
    areas: FloatArray  # (r,) of all vertices, by their nearest row
    samples: FloatArray  # (s, 3) spread evenly


def candidates(
    one: Unfolded,
    adult: Reference,
    builds: Callable[[], Sequence[Reference]],
    monitor: Monitor,
    *,
    fused: bool = False,
) -> list[Candidate]:
    """Fit the skeleton of a reference to a body in every way in which it may face, the likeliest first.

    The likeliest matches are fitted as they are and turned back to front. What decides is how well the skeleton
    explains the skin, joints that bend the wrong way, and toes, measured on the skin: none of them alone tells all
    bodies. Where no fit of the adult is good, other builds are tried.

    `one`: the body; `builds`: gives the reference in other proportions; `fused`: whether its skin may have grown
    together: only the likeliest way is fitted in full; where no match that leaves it as it stands is good, others are
    tried, as its file may lie.
    """
    some, whole = _skin(one, _ROWS), _skin(one, None)
    ways, upright = _likeliest(one, adult, monitor)
    enough = GOOD if fused else None
    found = _fits(one, some, adult, upright or ways, bool(upright), monitor, (0.0, _ALONE), enough=enough)
    if fused and min(each.cost for each in found) > GOOD:
        if upright:
            left = [way for way in ways if all(way is not each for each in upright)]
            found += _fits(one, some, adult, left, False, monitor, (_ALONE, _ALONE))
        found = [each._replace(stands=False) for each in found]
    if min(each.cost for each in found) > GOOD:
        shapes = builds()
        for number, build in enumerate(shapes):
            ways, upright = _likeliest(one, build, monitor)
            span = [_ALONE + (_AGAIN - _ALONE) * part / len(shapes) for part in (number, number + 1)]
            found += _fits(one, some, build, upright or ways, bool(upright), monitor, (span[0], span[1]))
    monitor.tick(_AGAIN)
    apart = _facing_apart(sorted(found, key=lambda each: each.cost))[: 1 if fused else None]
    again = [_fit(whole, each.reference, each.found, each.turned, each.stands, monitor) for each in apart]
    return sorted(again, key=lambda each: each.cost)


def candidates_of(one: Unfolded, reference: Reference, monitor: Monitor) -> list[Candidate]:
    """Fit the skeleton of any rigged body by its likeliest matches; first comes what explains the skin best.

    `one`: the body.
    """
    skin = _skin(one, None)
    ways = sides(one, reference.body, monitor)[:_MAPS]
    maps = [_matched(one, reference, way, monitor) for way in ways]
    found = [_fit(skin, reference, each, False, False, monitor, ALIKE) for each in maps]
    return sorted(found, key=lambda each: each.cost)


def candidate_by(one: Unfolded, reference: Reference, found: Points, monitor: Monitor) -> Candidate:
    """Fit the skeleton of a reference to a body by corresponding points, wherever they are from."""
    return _fit(_skin(one, None), reference, found, False, False, monitor)


def _matched(one: Unfolded, reference: Reference, way: Side, monitor: Monitor) -> Points:
    """Match a body with a reference."""
    found = working_map(one, reference.body, way, monitor)
    return Points(found.points, found.confidence)


def _skin(one: Unfolded, count: int | None) -> _Skin:
    """Gather the skin of a body. `count`: how many samples of it; None for all working vertices."""
    from scipy.spatial import cKDTree

    surface = one.found.surface
    areas = vertex_areas(surface.points, surface.faces)
    share = areas / areas.sum()
    rows = np.arange(len(areas)) if count is None else np.unique(spread(share, count))
    nearest = cKDTree(surface.points[rows]).query(surface.points)[1]
    lumped = np.bincount(nearest, areas, len(rows)).astype(np.float64)
    return _Skin(
        rows,
        surface.points[rows],
        vertex_normals(surface.points, surface.faces)[rows],
        lumped,
        surface.points[spread(share, _SAMPLES)],
    )


def _likeliest(one: Unfolded, reference: Reference, monitor: Monitor) -> tuple[list[Side], list[Side]]:
    """List the likeliest matches with a reference, and the likeliest of those that leave the body as it stands."""
    ways = scored_sides(one, reference.body, Monitor(cancelled=monitor.is_cancelled))  # what is counted is references
    upright = [way for way in ways if _standing(one, way, reference) > _STANDING]
    return ways[:_MAPS], upright[:_MAPS]


def _fits(
    one: Unfolded,
    skin: _Skin,
    reference: Reference,
    ways: Sequence[Side],
    stands: bool,
    monitor: Monitor,
    span: tuple[float, float],
    *,
    enough: float | None = None,
) -> list[Candidate]:
    """Fit the skeleton of one reference by some matches, both ways round.

    `stands`: whether they leave the body as it stands; `span`: shares of the work that are done before and after;
    `enough`: cost up to which no other match is tried.
    """
    quiet = Monitor(cancelled=monitor.is_cancelled)
    fits: list[Candidate] = []
    rounds = (False,) if any(map(side_of, one.limbs.named)) else (False, True)  # names tell left from right
    for number, way in enumerate(ways, start=1):
        if enough is None or not fits or min(each.cost for each in fits) > enough:
            found = _matched(one, reference, way, quiet)
            fits += [_fit(skin, reference, found, turned, stands, quiet) for turned in rounds]
        monitor.tick(span[0] + (span[1] - span[0]) * number / len(ways))
    return fits


def _fit(
    skin: _Skin,
    reference: Reference,
    found: Points,
    turned: bool,
    stands: bool,
    monitor: Monitor,
    rounds: int = UNLIKE,
) -> Candidate:
    """Fit the skeleton of a reference by its points, and weigh what speaks against it."""
    rig, rows, share = reference.rig, skin.rows, skin.areas / skin.areas.sum()
    at, weights = (found.there.on(values, rig.faces)[rows] for values in (rig.vertices, rig.weights))
    if turned:
        at, weights = turned_round(rig, at, weights)
    sure = found.sure[rows]
    fit = explained(rig, skin.points, skin.normals, skin.areas, at, weights, sure, monitor, rounds)
    residual = float(share @ np.minimum(fit.residual, _SPREAD))
    degrees, unlike, toes, alike = {}, 0.0, 0.0, 1.0
    if rig.is_human:
        degrees = beyond_limits(rig, fit.bones)
        unlike = unlike_sides(rig, fit.bones)
        toes = toes_forward(rig, fit.bones, skin.samples)
        alike = skin_alike(rig, skin.areas, fit.weights)
    cost = (
        residual / _RESIDUAL
        + min(sum(degrees.values()), _MOST_DEGREES) / _DEGREES
        - float(np.clip(toes, -_MOST_TOES, _MOST_TOES)) / _TOES
    )
    return Candidate(
        reference,
        found,
        turned,
        stands,
        fit,
        residual,
        degrees,
        unlike,
        alike,
        float(share @ sure),
        cost,
        float(share @ fit.trust(0.0)),
    )


def _facing_apart(found: list[Candidate]) -> list[Candidate]:
    """Keep the likeliest of those that face one way, and of a body that stands, what does not fall."""
    axes = [np.array(trunk_axes(each.reference.rig, each.fit.bones)) for each in found]  # (2, 3) each: left, up
    standing = [number for number, own in enumerate(axes) if found[number].stands and own[1, 2] > 0]
    chosen: list[int] = []
    for number in standing or range(len(found)):
        if all(((axes[number] * axes[other]).sum(axis=1) < _SAME).any() for other in chosen):
            chosen.append(number)
    return [found[number] for number in chosen]


def _standing(one: Unfolded, way: Side, reference: Reference) -> float:
    """Correlate the heights of a body in its file with those of the reference where its form lies on that one's."""
    from scipy.spatial import cKDTree

    place = one.form @ way.start.rotation + way.start.shift
    there = cKDTree(reference.body.form).query(place)[1]
    heights = one.found.surface.points[:, 2], reference.rig.vertices[there, 2]
    return float(np.corrcoef(*heights)[0, 1]) if all(np.ptp(each) > 0 for each in heights) else 0.0
