"""Entry point for a rig: a skeleton with weights for a body in any pose, from a mannequin or a rigged mesh."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .assembly.gathering import gathered, shaped
from .contacts import computed_open
from .fused.on_given import rig_on_given
from .matches import UNFOLDED, UnfoldedPair, on_meshes, unfolded_pair
from .matching.point_map import PointMap
from .matching.sides import index_of_side, require_side
from .matching.unfolded import Unfolded
from .measures.form_measures import median_distortion
from .mesh.closest_points import SurfacePoints
from .mesh.geometry import surface_area, vertex_normals
from .method_api.settings import AnySettings, Settings, settings_from
from .modelling.mannequins import mannequin
from .numerics.arrays import FloatArray
from .results import Match, Rigged
from .rigging.articulated_fit import explained_whole
from .rigging.bridge import Alike, over_mannequin
from .rigging.candidates import GOOD, Candidate, candidates, candidates_of
from .rigging.fitted_rig import bend_axes, filled_in, moved_bend_axes, settled_turns, with_equal_sides
from .rigging.reference_rig import ReferenceRig, checked_rig, mannequin_rig
from .rigging.references import Reference, adult, other_builds, unfolded_reference
from .rigging.skeleton import BoneMotions, Skeleton, inverted, moved_skeleton
from .rigging.stance_gate import pass_gate, refusal
from .rigging.standing import stood
from .run.errors import InvalidMeshError, InvalidSettingsError
from .run.kept_stages import KeptStages
from .run.monitor import Cancelled, Monitor, Progress

_FACING = {"Ways to face": 1}  # stages
_MATCHED = 0.2  # of the work of a skeleton, if the mannequin has to bring two bodies together
_LEAST = 0.1  # least belief in a point
_POSES = ("T", "A", "rest")
_FITTED, _UNFOLDED = 0.88, 0.4  # of the work; of that, the forms of the body and of the reference
UNFOLDED_BODY = _UNFOLDED / 2  # of the work of a skeleton
_ROWS = 1 << 16  # vertices whose weights are found at once: a tenth of a second
_FORGOTTEN, _MOST_BONES = 0.01, 4  # weights below which a bone does not hold a vertex; most that hold one
_UNLIKE = ("stance_unlike", "stance_unlikely")  # which speak of the mannequin


class Fitted(NamedTuple):
    """A body with the skeleton of a reference in every way in which it may face.

    Attributes
    ----------
    pair : UnfoldedPair
        The mesh and the reference.
    rig : ReferenceRig
        That of the whole reference.
    found : list of Candidate
        The skeletons of the largest body, the likeliest first.
    alike : Alike
        Whether the mesh and the reference are bodies of one kind.
    """

    pair: UnfoldedPair
    rig: ReferenceRig
    found: list[Candidate]
    alike: Alike

    @property
    def body(self) -> Unfolded:
        """The largest body of the mesh."""
        return self.pair.surfaces[self.pair.pairs[0][0]]

    @property
    def share(self) -> float:
        """Share of the mesh's area that this body has."""
        areas = [surface_area(body.points, body.faces) for body in self.pair.bodies.bodies]
        return areas[self.pair.pairs[0][0]] / sum(areas)

    def match(self, chosen: Candidate, points: SurfacePoints, belief: FloatArray, monitor: Monitor) -> Match:
        """Express a candidate as a match with the whole reference, whichever build of it has lent the skeleton.

        Parameters
        ----------
        chosen : Candidate
            One of those found.
        points, belief
            As `points` gives them.
        monitor : Monitor
            Of the whole run.

        Returns
        -------
        Match
            The match; its `sides` are the costs of all candidates.
        """
        sure = self.body.found.surface.prolong(chosen.fit.sure) * np.maximum(belief, _LEAST)
        whole = PointMap(points, np.clip(sure, 0.0, 1.0), chosen.cost)
        pair, costs = self.pair, [each.cost for each in self.found]
        return on_meshes(pair.bodies, pair.others, pair.pairs[:1], [whole], costs, monitor, pair.other_warnings)

    def points(self, chosen: Candidate, monitor: Monitor) -> tuple[SurfacePoints, FloatArray]:
        """Find the points of the reference's body for all vertices of the body, and how far each is believed.

        Parameters
        ----------
        chosen : Candidate
            One of those found.
        monitor : Monitor
            Of the whole run.

        Returns
        -------
        points : SurfacePoints
            On the triangles of that body, which are the same in every build.
        belief : (n,) ndarray of float
            0 to 1.
        """
        own, fit, bones = self.body.found, chosen.fit, chosen.fit.bones
        normals = vertex_normals(own.whole_points, own.whole_faces)
        at = own.surface.prolong(fit.at)
        return explained_whole(chosen.reference.whole, bones, own.whole_points, normals, at, monitor)


def fitted_skeleton(
    vertices: ArrayLike,
    faces: ArrayLike,
    reference: ReferenceRig | None,
    settings: Settings,
    kept: KeptStages,
    monitor: Monitor,
    share: float,
    *,
    rest: ArrayLike | None = None,
) -> Fitted:
    """Fit the skeleton of a reference to the largest body of a mesh.

    Parameters
    ----------
    vertices, faces, reference, settings, rest
        As in `rig`.
    kept : KeptStages
        Results of earlier runs.
    monitor : Monitor
        Of the whole run.
    share : float
        Share of the whole run that this takes.

    Returns
    -------
    Fitted
        The skeletons.

    Raises
    ------
    CanonicalFormError
        As in `match`.
    """

    def figure() -> ReferenceRig:
        return kept.take("Mannequin", [], lambda: mannequin_rig(*mannequin()), monitor.warnings)

    whole = figure() if reference is None else checked_rig(reference)

    def unfold() -> UnfoldedPair:
        own = _own(vertices), _own(faces)  # they are kept
        forms = share * _UNFOLDED / UNFOLDED
        return unfolded_pair(*own, whole.vertices, whole.faces, settings, monitor, forms, rest=rest, keep=kept)

    pair = kept.take("Forms", [vertices, faces, repr(settings), rest, *whole[:2]], unfold, monitor.warnings)
    here, there = pair.pairs[0]

    def look() -> tuple[list[Candidate], Alike]:
        one = pair.surfaces[here]
        lender = adult(whole, pair.other_surfaces[there], pair.others.bodies[there].vertices)

        def piece(begin: float, end: float) -> Monitor:
            start, left = _UNFOLDED * share, (1 - _UNFOLDED) * share
            return monitor.piece(start + left * begin, start + left * end, _FACING)

        if reference is not None:
            return _facing_like(one, lender, figure, settings, piece)
        own = piece(0.0, 1.0)
        with own.stage("Ways to face"):
            return candidates(one, lender, lambda: other_builds(lender, settings, own), own), Alike.YES

    kinds = [pair, reference is None, *whole.skeleton, whole.weights]
    return Fitted(pair, whole, *kept.take("Ways to face", kinds, look, monitor.warnings))


def _facing_like(
    one: Unfolded,
    lender: Reference,
    figure: Callable[[], ReferenceRig],
    settings: Settings,
    piece: Callable[[float, float], Monitor],
) -> tuple[list[Candidate], Alike]:
    """Fit the skeleton of a rigged body by a match, and where that fits badly, by what the mannequin knows of both."""
    first = piece(0.0, _MATCHED)
    with first.stage("Ways to face"):
        found = candidates_of(one, lender, first)
    if found[0].cost <= GOOD:
        return found, Alike.YES
    human = unfolded_reference(figure(), settings, first)
    builds, half = cache(lambda: other_builds(human, settings, first)), (1 + _MATCHED) / 2
    bridge = over_mannequin(one, lender, human, builds, (piece(_MATCHED, half), piece(half, 1.0)))
    if bridge.candidates and bridge.candidates[0].cost < found[0].cost:
        found = bridge.candidates
    return found, bridge.alike(found[0])


def _own(values: ArrayLike) -> ArrayLike:
    """Copy an array that may be changed in place later."""
    return values.copy() if isinstance(values, np.ndarray) else values


def rig(
    vertices: ArrayLike,
    faces: ArrayLike,
    reference: ReferenceRig | None = None,
    settings: AnySettings = None,
    *,
    pose: str | None = None,
    side: str | int = "auto",
    equal: bool = True,
    anyway: bool = False,
    rest: ArrayLike | None = None,
    keep: KeptStages | None = None,
    progress: Progress | None = None,
    cancelled: Cancelled | None = None,
    **options: Any,
) -> Rigged:
    """Give a body in any pose a skeleton, with weights for its skin.

    The skeleton is that of a rigged body, or else the mannequin's, in Rigify's names, as `stance_by_match` fits it.
    Weights are those of the matching points, and flow over the skin to where the match is not trusted.

    Parameters
    ----------
    vertices : (n, 3) array_like of float
        Vertex positions, any unit of length.
    faces : (m, 3) array_like of int
        Triangles, in any state that docs/any-mesh.md lists.
    reference : ReferenceRig, optional
        A rigged body at rest, of a similar shape, in any unit; without one, a mannequin, which is human.
    settings : Settings or mapping, optional
        Options of the forms; chosen feature points refer to this mesh.
    pose : {'T', 'A', 'rest'}, optional
        The pose of the mesh and its skeleton at rest: a T-pose, an A-pose, or as the reference rests; without one, that
        of the mesh.
    side : str or int
        "auto", or the index of one of the ways to face, 0 for the likeliest.
    equal : bool
        Make bones of the left and the right side equally long.
    anyway : bool
        Return a rig although it is unlikely to be right.
    rest : (n, 3) array_like of float, optional
        Positions in the rest pose of another rig, as in `canonical_form`.
    keep : KeptStages, optional
        Results of earlier runs on this mesh, also of `stance_by_match`.
    progress, cancelled, **options
        As in `canonical_form`.

    Returns
    -------
    Rigged
        The skeleton and its weights.

    Raises
    ------
    CanonicalFormError
        As in `match`; an InvalidMeshError, too, where the skeleton is unlikely to be right and `anyway` is not set, or
        the bones of the reference do not tell the arms and legs of the pose.

    Examples
    --------
    >>> from addon.core import mannequin
    >>> vertices, faces = mannequin()
    >>> rig(vertices, faces).weights.shape  # doctest: +SKIP
    (30346, 22)

    References
    ----------
    Pellegrini, Schindler and Nardi, "A Generalization of the ICP Algorithm for Articulated Bodies", 2008; Abdrashitov
    and others, "Robust Skin Weights Transfer via Weight Inpainting", 2023, doi:10.1145/3610543.3626180;
    docs/method.md lists what is original to this project.
    """
    require_side(side)
    if pose is not None and pose not in _POSES:
        raise InvalidSettingsError("rig_pose", value=pose)
    settings, monitor, kept = settings_from(settings, options), Monitor(progress, cancelled), keep or KeptStages()
    if settings.parts:

        def compute(points: ArrayLike, corners: ArrayLike, own: Settings, *_: object, **how: Any) -> Rigged:
            return rig(points, corners, reference, own, pose=pose, side=side, equal=equal, anyway=anyway, **how)

        opened = settings, keep, progress, cancelled, rest
        return computed_open(compute, rig_on_given, vertices, faces, *opened, formed=_FITTED * UNFOLDED_BODY)
    fitted = fitted_skeleton(vertices, faces, reference, settings, kept, monitor, _FITTED, rest=rest)
    chosen = fitted.found[index_of_side(side, len(fitted.found))]
    error = refusal(chosen, fitted.share)
    if reference is not None and (fitted.alike is Alike.NO or (error is not None and error.kind in _UNLIKE)):
        error = InvalidMeshError("rig_unlike")
    pass_gate(error, fitted.found, side, anyway, monitor)
    if error is None and fitted.alike is Alike.PERHAPS:
        monitor.warn("match_unlike")
    piece = monitor.piece(_FITTED, 1.0, {"Weights": 2, "Pose": 1})
    with piece.stage("Weights"):
        found = _rigged(fitted, chosen, equal, monitor)
    with piece.stage("Pose"):
        if pose is None:
            return found
        found, error = _at_rest(found, fitted, chosen, pose, piece)
        if error is not None:
            pass_gate(error, fitted.found, side, anyway, monitor)
        return found


def _at_rest(
    found: Rigged, fitted: Fitted, chosen: Candidate, pose: str, monitor: Monitor
) -> tuple[Rigged, InvalidMeshError | None]:
    """Let a rig rest in another pose than that of its mesh; also what says that the pose cannot be right."""
    fit, reference, own = chosen.fit, chosen.reference.rig, fitted.body.found
    heads, tails = ((each - own.centre) / own.unit for each in found.skeleton[2:])
    bones = fit.bones._replace(heads=heads, tails=tails)
    there = stood(fitted.body, reference, fit, bones, pose, monitor)
    shapes = [body.points for body in fitted.pair.bodies.bodies]
    shapes[fitted.pair.pairs[0][0]] = there.vertices
    at_rest = moved_skeleton(found.skeleton, there.motions)
    bodies, posed = fitted.pair.bodies, shaped(fitted.pair.bodies, shapes, monitor).copy()
    distortion = median_distortion(bodies.vertices, posed, bodies.faces)
    rested = replace(
        found,
        vertices=posed,
        skeleton=at_rest,
        to_given=inverted(there.motions),
        bends=moved_bend_axes(reference, found.bends, there.motions.turns, at_rest),
    )
    return rested, refusal(chosen, fitted.share, distortion, there.off)


def _rigged(fitted: Fitted, chosen: Candidate, equal: bool, monitor: Monitor) -> Rigged:
    """Gather the rig of a mesh in its own pose and unit."""
    own, fit, reference = fitted.body.found, chosen.fit, chosen.reference.rig
    trust = fit.closeness()  # the match may doubt what closest points have found
    bones = fit.bones._replace(turns=settled_turns(reference, fit.bones))
    if equal:
        bones = with_equal_sides(reference, bones)
    weights = own.surface.prolong(filled_in(fit.weights, trust, own.stiffness, own.mass))
    points, belief = fitted.points(chosen, monitor)
    share = (np.clip(own.surface.prolong(trust), 0.0, 1.0) * belief)[:, None]
    whole = chosen.reference.whole
    for start in range(0, len(weights), _ROWS):
        monitor.check()
        some = slice(start, start + _ROWS)
        there = SurfacePoints(points.faces[some], points.weights[some], points.distances[some])
        weights[some] += share[some] * (there.on(whole.weights, whole.faces) - weights[some])
    skeleton = Skeleton(
        list(reference.skeleton.names),
        reference.skeleton.parents.copy(),
        bones.heads * own.unit + own.centre,
        bones.tails * own.unit + own.centre,
    )
    still = BoneMotions(skeleton.heads, skeleton.heads, np.broadcast_to(np.eye(3), (len(bones.heads), 3, 3)).copy())
    return Rigged(
        fitted.pair.bodies.vertices.copy(),
        skeleton,
        still,
        bend_axes(reference, bones),
        _on_all(fitted, weights, monitor),
        fit.bone_confidence(own.mass),
        fitted.match(chosen, points, belief, monitor),
        monitor.timings,
        monitor.warnings,
    )


def _on_all(fitted: Fitted, weights: FloatArray, monitor: Monitor) -> FloatArray:
    """Carry weights of the body to all of the mesh; vertices of other bodies take those of the nearest."""
    from scipy.spatial import cKDTree

    bodies, here = fitted.pair.bodies, fitted.pair.pairs[0][0]
    values = [np.zeros((len(body.vertices), weights.shape[1])) for body in bodies.bodies]
    values[here] = weights
    whole = gathered(bodies, values, np.zeros((len(bodies.vertices), weights.shape[1])))
    held = whole.any(axis=1)
    others = np.flatnonzero(~held)
    near, source = cKDTree(bodies.vertices[held]), whole[held]
    for start in range(0, len(others), _ROWS):
        monitor.check()
        some = others[start : start + _ROWS]
        whole[some] = source[near.query(bodies.vertices[some])[1]]
    least = np.minimum(_FORGOTTEN, whole.max(axis=1))
    if whole.shape[1] > _MOST_BONES:  # what engines take
        least = np.maximum(least, np.partition(whole, -_MOST_BONES, axis=1)[:, -_MOST_BONES])
    whole[whole < least[:, None]] = 0.0
    return np.asarray(whole / whole.sum(axis=1, keepdims=True))
