"""Entry point for a match: for every vertex of a mesh, the corresponding point of another."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .assembly.bodies import Bodies
from .assembly.gathering import gathered
from .assembly.opening import OPENING
from .assembly.unfolded_bodies import unfolded_bodies
from .matching.point_map import PointMap, point_map
from .matching.seam_sides import CutSurface, seam_sides
from .matching.sides import Side, index_of_side, require_side, sides
from .matching.unfolded import Unfolded
from .mesh.geometry import surface_area
from .mesh.tables import rows_in
from .method_api.catalogue import method_named
from .method_api.costs import require_match_memory
from .method_api.settings import AnySettings, Settings, settings_from
from .numerics.arrays import FloatArray, IntArray
from .results import Match, MatchedSeams
from .run.errors import errors_about
from .run.kept_stages import KeptStages
from .run.messages import Message, message
from .run.monitor import Cancelled, Monitor, Progress

UNFOLDED = 0.6  # of the work of a match
_MATCHING = {"Ways to match": 55, "Match": 45}  # stages
_STRAINED = 0.12  # strain above which two bodies count as dissimilar: poses reach .05 to .09, people in clothes .11
_UNLIKE = -3.5  # the same for the score, where that alone has decided; poses of a body reach -3.9 to -6
_CLOSE = 0.06  # difference of the costs of two sides below which the other is about as likely
_TOLD = 1.0  # how surely both surfaces have to tell left from right where bodies are unlike
_UNSURE = 0.4  # mean confidence below which a match is doubtful


class MatchedBodies(NamedTuple):
    """The unfolded bodies of two meshes, with the maps from those of the first to those of the other.

    Attributes
    ----------
    bodies, others : Bodies
        The meshes.
    surfaces, other_surfaces : list of Unfolded
        Their bodies with their forms.
    pairs : list of (int, int)
        Indices of the matched bodies in the two meshes.
    maps : list of PointMap
        The map of each pair.
    match : Match
        The result on the vertices of the whole mesh.
    """

    bodies: Bodies
    others: Bodies
    surfaces: list[Unfolded]
    other_surfaces: list[Unfolded]
    pairs: list[tuple[int, int]]
    maps: list[PointMap]
    match: Match


class UnfoldedPair(NamedTuple):
    """Two meshes of which the bodies are unfolded, before they are matched.

    Attributes
    ----------
    bodies, others : Bodies
        The meshes.
    surfaces, other_surfaces : list of Unfolded
        Their bodies with their forms.
    pairs : list of (int, int)
        Indices of the bodies to be matched in the two meshes, the largest first.
    other_warnings : list of Message
        What was said about the other mesh.
    """

    bodies: Bodies
    others: Bodies
    surfaces: list[Unfolded]
    other_surfaces: list[Unfolded]
    pairs: list[tuple[int, int]]
    other_warnings: list[Message]


def match(
    vertices: ArrayLike,
    faces: ArrayLike,
    other_vertices: ArrayLike,
    other_faces: ArrayLike,
    settings: AnySettings = None,
    *,
    side: str | int = "auto",
    rest: ArrayLike | None = None,
    progress: Progress | None = None,
    cancelled: Cancelled | None = None,
    **options: Any,
) -> Match:
    """Match two meshes of similar bodies, whatever their poses and triangulations.

    Parameters
    ----------
    vertices : (n, 3) array_like of float
        Vertex positions, any unit of length.
    faces : (m, 3) array_like of int
        Triangles, in any state that docs/any-mesh.md lists.
    other_vertices : (n', 3) array_like of float
        Vertices of the other mesh, in any unit.
    other_faces : (m', 3) array_like of int
        Its triangles.
    settings : Settings or mapping, optional
        Options of both forms; chosen feature points refer to the first mesh.
    side : str or int
        "auto", or the index of one of the `Match.sides`, 0 for the likeliest, to use where left and right or front and
        back are swapped.
    rest : (n, 3) array_like of float, optional
        Positions of the first mesh in the rest pose of a rig, as in `canonical_form`.
    progress : callable, optional
        Called with the fraction done (0 to 1) and the name of the stage.
    cancelled : callable, optional
        Polled at least twice a second; the computation stops when it returns True.
    **options
        Options by name, over those of `settings`: ``quality="draft"``.

    Returns
    -------
    Match
        For every vertex, the corresponding point on the other mesh and its confidence.

    Raises
    ------
    InvalidMeshError
        If a mesh cannot be used; the message says what to do.
    InvalidSettingsError
        If there is no such side.
    TooLargeError
        If all pairs inside the patches of a mesh do not fit into the memory limit.
    SolverError
        If a spectrum cannot be computed accurately.
    CancelledError
        If `cancelled` returned True.

    Examples
    --------
    >>> corner = [[0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]]
    >>> faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
    >>> match(corner, faces, corner, faces).weights.shape
    (4, 3)

    References
    ----------
    Melzi and others, "ZoomOut", 2019, doi:10.1145/3355089.3356524; Eisenberger, Lähner and Cremers, "Smooth Shells",
    2020, doi:10.1109/CVPR42600.2020.01228; docs/method.md lists what is original to this project.
    """
    from .contacts import computed_open
    from .fused.on_given import match_on_given

    require_side(side)

    def compute(
        points: ArrayLike, corners: ArrayLike, own: Settings, *_: object, rest: ArrayLike | None = None, **how: Any
    ) -> Match:
        monitor = Monitor(how["progress"], how["cancelled"])
        others = (other_vertices, other_faces, own, side, monitor, 1.0)
        return matched_bodies(points, corners, *others, rest=rest, keep=how["keep"]).match

    wanted = settings_from(settings, options)
    formed = UNFOLDED / 2
    return computed_open(
        compute, match_on_given, vertices, faces, wanted, None, progress, cancelled, rest, formed=formed
    )


def matched_bodies(
    vertices: ArrayLike,
    faces: ArrayLike,
    other_vertices: ArrayLike,
    other_faces: ArrayLike,
    settings: Settings | None,
    side: str | int,
    monitor: Monitor,
    share: float,
    *,
    rest: ArrayLike | None = None,
    keep: KeptStages | None = None,
) -> MatchedBodies:
    """Unfold two meshes and match their bodies, the largest with the largest, and so on.

    Parameters
    ----------
    vertices, faces, other_vertices, other_faces, settings, side
        As in `match`.
    monitor : Monitor
        Of the whole run; receives warnings; polled for cancellation.
    share : float
        Share of the whole run that this takes.
    rest : (n, 3) array_like of float, optional
        Positions of the first mesh in the rest pose of a rig, as in `canonical_form`.
    keep : KeptStages, optional
        Results of earlier runs on the first mesh.

    Returns
    -------
    MatchedBodies
        The bodies and their maps.

    Raises
    ------
    CanonicalFormError
        As in `match`.

    Examples
    --------
    >>> corner = [[0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]]
    >>> faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
    >>> len(matched_bodies(corner, faces, corner, faces, None, "auto", Monitor(), 1.0).maps)
    1
    """
    settings = settings or Settings()
    require_side(side)
    pair = unfolded_pair(vertices, faces, other_vertices, other_faces, settings, monitor, share, rest=rest, keep=keep)
    bodies, others, surfaces, other_surfaces, pairs, other_warnings = pair
    maps: list[PointMap] = []
    ways: list[Side] = []
    used: list[Side] = []
    for number, (here, there) in enumerate(pairs):
        start = UNFOLDED * share
        begin, end = (start + (share - start) * part / len(pairs) for part in (number, number + 1))
        own = monitor.piece(begin, end, _MATCHING)
        with own.stage("Ways to match"):
            found = sides(surfaces[here], other_surfaces[there], own)
        chosen = index_of_side("auto" if number else side, len(found))
        with own.stage("Match"):
            maps.append(point_map(surfaces[here], other_surfaces[there], found[chosen], own))
        used.append(found[chosen])
        ways = ways or found
    result = on_meshes(bodies, others, pairs, maps, [each.score for each in ways], monitor, other_warnings)
    _warn([surfaces[here] for here, _ in pairs], maps, ways, used, monitor)
    return MatchedBodies(bodies, others, surfaces, other_surfaces, pairs, maps, result)


def unfolded_pair(
    vertices: ArrayLike,
    faces: ArrayLike,
    other_vertices: ArrayLike,
    other_faces: ArrayLike,
    settings: Settings,
    monitor: Monitor,
    share: float,
    *,
    rest: ArrayLike | None = None,
    keep: KeptStages | None = None,
) -> UnfoldedPair:
    """Find the bodies of two meshes and their forms, and pair them, the largest with the largest, and so on.

    Parameters
    ----------
    vertices, faces, other_vertices, other_faces, settings, monitor, share, rest
        As in `matched_bodies`.
    keep : KeptStages, optional
        Results of earlier runs on the first mesh.

    Returns
    -------
    UnfoldedPair
        The bodies, before they are matched.

    Raises
    ------
    CanonicalFormError
        As in `match`.
    """
    settings = method_named(settings.method).settings(settings)
    require_match_memory(_count(vertices), _count(other_vertices), settings)
    one = monitor.piece(0.0, UNFOLDED / 2 * share, OPENING, keep)
    two = monitor.piece(UNFOLDED / 2 * share, UNFOLDED * share, OPENING)
    bodies, surfaces = unfolded_bodies(vertices, faces, settings, one, rest)
    with errors_about(message("other_mesh")):
        others, other_surfaces = unfolded_bodies(other_vertices, other_faces, settings.detecting(), two)
    monitor.extend(one.warnings)
    order, other_order = (_by_area(each) for each in (bodies, others))
    if len(order) != len(other_order):
        monitor.warn("match_bodies", count=len(order), others=len(other_order))
    pairs = list(zip(order, other_order, strict=False))
    return UnfoldedPair(bodies, others, surfaces, other_surfaces, pairs, two.warnings)


def _count(vertices: ArrayLike) -> int:
    """Count vertices before they are checked; invalid arrays are rejected later."""
    try:
        return np.size(vertices) // 3
    except ValueError:  # rows of different lengths
        return 0


def _by_area(bodies: Bodies) -> list[int]:
    """Sort bodies by their area, largest first."""
    areas = [surface_area(body.points, body.faces) for body in bodies.bodies]
    return np.argsort(-np.array(areas), kind="stable").tolist()


def on_meshes(
    bodies: Bodies,
    others: Bodies,
    pairs: list[tuple[int, int]],
    maps: list[PointMap],
    scores: list[float],
    monitor: Monitor,
    other_warnings: list[Message],
) -> Match:
    """Express the matches of bodies in terms of the whole meshes.

    Parameters
    ----------
    bodies, others : Bodies
        The meshes.
    pairs : list of (int, int)
        Indices of the matched bodies.
    maps : list of PointMap
        The map of each pair.
    scores : list of float
        What is told of the ways to match, the likeliest first.
    monitor : Monitor
        What was said about the mesh, and how long it took.
    other_warnings : list of Message
        What was said about the other mesh.

    Returns
    -------
    Match
        The match on all vertices.
    """
    face = [np.full(len(body.vertices), -1) for body in bodies.bodies]
    weights = [np.zeros((len(body.vertices), 3)) for body in bodies.bodies]
    confidence = [np.zeros(len(body.vertices)) for body in bodies.bodies]
    for (here, there), found in zip(pairs, maps, strict=True):
        body = others.bodies[there]
        numbers = rows_in(body.vertices[body.faces], others.faces)
        face[here], weights[here] = numbers[found.points.faces], found.points.weights
        confidence[here] = found.confidence
    total = len(bodies.vertices)
    faces = gathered(bodies, face, np.full(total, -1))
    at = gathered(bodies, weights, np.zeros((total, 3)))
    nearest = others.unjoined[faces, np.argmax(at, axis=1)]
    return Match(
        np.where(faces < 0, -1, nearest),
        faces,
        at,
        gathered(bodies, confidence, np.zeros(total)),
        scores,
        others.unjoined,
        len(others.vertices),
        monitor.timings,
        monitor.warnings,
        list(other_warnings),
        _seams(bodies, others, faces, at),
    )


def _seams(bodies: Bodies, others: Bodies, faces: IntArray, weights: FloatArray) -> MatchedSeams | None:
    """Tell which vertices were treated as one, and on which side of a seam each lies; None if none were."""
    here, there = (
        CutSurface(each.vertices, each.pieces.representative, each.faces, each.unjoined) for each in (bodies, others)
    )
    if all((each.joined == np.arange(len(each.joined))).all() for each in (here, there)):
        return None
    return MatchedSeams(here.joined, there.joined, seam_sides(here, there, faces, weights))


def _warn(surfaces: list[Unfolded], maps: list[PointMap], ways: list[Side], used: list[Side], monitor: Monitor) -> None:
    """Warn if a match is doubtful."""
    if any(map(_is_unlike, used)):
        monitor.warn("match_unlike")
    elif min(_sure(*each) for each in zip(surfaces, maps, strict=True)) < _UNSURE:
        monitor.warn("match_unsure")
    if len(ways) > 1 and np.isfinite(ways[1].strain):  # a rival came close
        guessed = _is_unlike(ways[0]) and abs(ways[0].facing) < _TOLD
        if guessed or ways[1].cost < ways[0].cost + _CLOSE:
            monitor.warn("match_sides")


def _is_unlike(way: Side) -> bool:
    """Return whether two bodies differ too much: by how far the match strains the form, or its score alone."""
    return way.strain > _STRAINED if np.isfinite(way.strain) else way.score > _UNLIKE


def _sure(surface: Unfolded, found: PointMap) -> float:
    """Average the confidence over the working vertices, which are spread evenly."""
    return float(found.confidence[surface.found.surface.kept].mean())
