"""Entry points for a T-pose or an A-pose: by the bones of a rig, or by a skeleton fitted to a body that has none."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .assembly.gathering import GatheredFeatures, gathered_features, shaped
from .contacts import computed_open
from .fused.on_given import pose_on_given
from .matching.sides import index_of_side, require_side
from .measures.form_measures import median_distortion
from .mesh.geometry import checked_arrays, surface_area, vertex_areas
from .method_api.settings import AnySettings, Settings, settings_from
from .numerics.arrays import FloatArray, IntArray
from .results import PosedLike, Stance
from .rigging.bone_fit import known_bones
from .rigging.candidates import Candidate
from .rigging.limb_bones import LimbBones, limb_bones
from .rigging.skeleton import Skeleton, skinned
from .rigging.stance import ARMS_LOWERED, facing_of, stance
from .rigging.stance_gate import pass_gate, refusal
from .rigging.standing import stood
from .rigs import UNFOLDED_BODY, Fitted, fitted_skeleton
from .run.errors import InvalidMeshError, InvalidSettingsError
from .run.kept_stages import KeptStages
from .run.monitor import Cancelled, Monitor, Progress
from .symmetry.limb_names import names_by_bones

_MATCHED = 0.9  # of the work
_FEW = 3  # vertices of a foot, below which its width is not known


def stance_by_bones(
    vertices: ArrayLike, faces: ArrayLike, skeleton: Skeleton, weights: ArrayLike, pose: str = "T"
) -> Stance:
    """Put a rigged mesh into a T-pose or an A-pose, by its own bones.

    Which bones are arms and legs is read off their names, in the spelling of Rigify, Mixamo, Unreal, VRM, Biped and the
    like, else off the shape of the skeleton. Arms and legs become straight; what stands so already keeps its shape, and
    so do trunk, head, hands and feet.

    Parameters
    ----------
    vertices : (n, 3) array_like of float
        Positions at rest, Z up, any unit of length.
    faces : (m, 3) array_like of int
        Triangles.
    skeleton : Skeleton
        The b bones at rest; bones that only move others may be among them.
    weights : (n, b) array_like of float
        How far each vertex follows each bone; rows are scaled to a sum of 1, and without any, a vertex stays where it
        is in the body.
    pose : {'T', 'A'}
        Arms held out sideways, or lowered by 45 degrees.

    Returns
    -------
    Stance
        The mesh in that pose.

    Raises
    ------
    InvalidMeshError
        If arrays do not belong together, or the bones do not tell two arms and two legs.
    InvalidSettingsError
        If there is no such pose.

    Examples
    --------
    >>> heads = np.array([[0, 0, 1.0], [0.2, 0, 2], [-0.2, 0, 2], [0.2, 0, 1], [-0.2, 0, 1]])
    >>> tails = heads + [[0, 0, 1.0], [1, 0, -1], [-1, 0, -1], [0, 0, -1], [0, 0, -1]]
    >>> names = ["hips", "Left Arm", "Right Arm", "Left Leg", "Right Leg"]
    >>> bones = Skeleton(names, np.array([-1, 0, 0, 0, 0]), heads, tails)
    >>> posed = stance_by_bones(tails, [[0, 1, 2], [0, 3, 4]], bones, np.eye(5))
    >>> (posed.vertices[1] - posed.vertices[2]).round(2).tolist()
    [3.23, 0.0, 0.0]

    References
    ----------
    Magnenat-Thalmann, Laperrière and Thalmann, "Joint-Dependent Local Deformations for Hand Animation and Object
    Grasping", 1988 (linear blend skinning).
    """
    if pose not in ARMS_LOWERED:
        raise InvalidSettingsError("stance_pose", value=pose)
    points, triangles = checked_arrays(vertices, faces)
    if not surface_area(points, triangles) > 0:
        raise InvalidMeshError("no_area")
    held = np.asarray(weights, dtype=np.float64)
    count = len(skeleton.names)
    shapes = (np.shape(skeleton.parents), np.shape(skeleton.heads), np.shape(skeleton.tails), held.shape)
    if shapes != ((count,), (count, 3), (count, 3), (len(points), count)) or not (held >= 0).all():
        raise InvalidMeshError("stance_arrays", bones=count, vertices=len(points))
    monitor = Monitor()
    with monitor.stage("Pose"):
        limbs = limb_bones(skeleton, held)
        if not limbs:
            raise InvalidMeshError("stance_limbs")
        total = held.sum(axis=1, keepdims=True)
        held = held / np.maximum(total, np.finfo(float).tiny)
        facing = facing_of(skeleton, limbs)
        motions = stance(skeleton, limbs, pose, _foot_width(points @ facing[0], held, limbs))
        posed = np.where(total > 0, skinned(points, held, motions), points @ facing.T)
        areas = vertex_areas(points, triangles)
        posed += areas / areas.sum() @ (points - posed)
        distortion = median_distortion(points, posed, triangles)
    return Stance(
        posed,
        triangles,
        np.empty(0, dtype=np.int64),
        np.full(len(points), -1),
        np.zeros(len(points)),
        [skeleton.names[bone] for limb in limbs for bone in (*limb.bones, limb.end) if bone >= 0],
        distortion,
        monitor.timings,
        monitor.warnings,
    )


def _foot_width(across: FloatArray, weights: FloatArray, limbs: list[LimbBones]) -> float:
    """Measure the narrower foot, 0 if there is none. `across` (n,): how far left each vertex lies."""
    most: IntArray = weights.argmax(axis=1)
    feet = [across[most == limb.end] for limb in limbs if limb.kind == "leg" and limb.end >= 0]
    return min((float(np.ptp(foot)) for foot in feet if len(foot) > _FEW), default=0.0)


def stance_by_match(
    vertices: ArrayLike,
    faces: ArrayLike,
    settings: AnySettings = None,
    *,
    pose: str = "T",
    side: str | int = "auto",
    anyway: bool = False,
    rest: ArrayLike | None = None,
    keep: KeptStages | None = None,
    progress: Progress | None = None,
    cancelled: Cancelled | None = None,
    **options: Any,
) -> PosedLike:
    """Put a human body without a rig into a T-pose or an A-pose.

    A mannequin is matched to the body in every way in which the body may face: an adult, and if that fits badly, one
    with a larger head, a stocky one, and one that is half head. Their skeletons are fitted by these matches, as they
    are and turned back to front, and the likeliest skeleton stands up: bones exactly in place, left and right as long
    as each other, the skin pulled along as an elastic body.

    Parameters
    ----------
    vertices : (n, 3) array_like of float
        Vertex positions, any unit of length.
    faces : (m, 3) array_like of int
        Triangles, in any state that docs/any-mesh.md lists.
    settings : Settings or mapping, optional
        Options of the forms; chosen feature points refer to this mesh.
    pose : {'T', 'A'}
        Arms held out sideways, or lowered by 45 degrees.
    side : str or int
        "auto", or the index of one of the ways to face, `match.sides`, 0 for the likeliest.
    anyway : bool
        Return a stance although it is unlikely to be right.
    rest : (n, 3) array_like of float, optional
        Positions in the rest pose of a rig, as in `canonical_form`.
    keep : KeptStages, optional
        Results of earlier runs on this mesh: another side, or `anyway`, takes but the time to stand up.
    progress : callable, optional
        Called with the fraction done (0 to 1) and the name of the stage.
    cancelled : callable, optional
        Polled at least twice a second; the computation stops when it returns True.
    **options
        Options by name, over those of `settings`: ``quality="draft"``.

    Returns
    -------
    PosedLike
        The mesh in that pose, facing -Y, Z up. `match` is that with the mannequin, and its `sides` are the costs of
        the ways to face, the likeliest first; lower is better.

    Raises
    ------
    CanonicalFormError
        As in `match`; an InvalidMeshError, too, where the skeleton is unlikely to be right and `anyway` is not set.

    Examples
    --------
    >>> from addon.core import mannequin
    >>> vertices, faces = mannequin(A_POSE)  # doctest: +SKIP
    >>> stance_by_match(vertices, faces).vertices.shape  # doctest: +SKIP
    (30346, 3)

    References
    ----------
    Pellegrini, Schindler and Nardi, "A Generalization of the ICP Algorithm for Articulated Bodies", 2008; Sorkine and
    Alexa, "As-Rigid-As-Possible Surface Modeling", 2007, doi:10.2312/SGP/SGP07/109-116; docs/method.md lists what is
    original to this project.
    """
    if pose not in ARMS_LOWERED:
        raise InvalidSettingsError("stance_pose", value=pose)
    require_side(side)
    settings, kept = settings_from(settings, options), keep or KeptStages()
    if settings.parts:

        def compute(points: FloatArray, corners: IntArray, own: Settings, *_: object, **how: Any) -> PosedLike:
            return stance_by_match(points, corners, own, pose=pose, side=side, anyway=anyway, **how)

        formed = _MATCHED * UNFOLDED_BODY
        return computed_open(
            compute, pose_on_given, vertices, faces, settings, keep, progress, cancelled, rest, formed=formed
        )
    monitor = Monitor(progress, cancelled)
    fitted = fitted_skeleton(vertices, faces, None, settings, kept, monitor, _MATCHED, rest=rest)
    pair, found, here = fitted.pair, fitted.found, fitted.pair.pairs[0][0]
    number = index_of_side(side, len(found))
    chosen = found[number]

    def stand() -> tuple[FloatArray, float]:
        piece = monitor.piece(_MATCHED, 1.0, {"Pose": 1})
        with piece.stage("Pose"):
            shapes = [body.points for body in pair.bodies.bodies]
            there = stood(fitted.body, chosen.reference.rig, chosen.fit, chosen.fit.bones, pose, piece)
            shapes[here] = there.vertices
            return shaped(pair.bodies, shapes, monitor), there.off

    posed, off = kept.take("Pose", [pair, number, pose], stand, monitor.warnings)
    distortion = median_distortion(pair.bodies.vertices, posed, pair.bodies.faces)
    pass_gate(refusal(chosen, fitted.share, distortion, off), found, side, anyway, monitor)
    return _as_posed_like(fitted, posed, distortion, chosen, monitor)


def _names(fitted: Fitted, chosen: Candidate, features: GatheredFeatures) -> list[str]:
    """Name the feature points of the body that stands, by hand or by the bones that move them; others have no name."""
    names = chosen.reference.rig.skeleton.names
    moved_by = chosen.fit.weights[fitted.body.features].argmax(axis=1)
    own = fitted.body.limbs.named or names_by_bones([names[bone] for bone in moved_by])
    here = fitted.pair.pairs[0][0]
    return features.numbered(
        [own if number == here else [""] * len(body.tips) for number, body in enumerate(features.bodies)]
    )


def _as_posed_like(
    fitted: Fitted, posed: FloatArray, distortion: float, chosen: Candidate, monitor: Monitor
) -> PosedLike:
    """Gather what a pose comes with."""
    pair = fitted.pair
    match = fitted.match(chosen, *fitted.points(chosen, monitor), monitor)
    features = gathered_features(pair.bodies, [each.found.prolonged(monitor) for each in pair.surfaces])
    fit, mass = chosen.fit, fitted.body.found.mass
    known, confidence = known_bones(mass[:, None] * fit.weights), fit.bone_confidence(mass)
    names = chosen.reference.rig.skeleton.names
    bones = {names[bone]: float(confidence[bone]) for bone in np.flatnonzero(known)}
    return PosedLike(
        posed.copy(),  # the other is kept
        pair.bodies.faces.copy(),
        features.points,
        features.patches,
        features.adf,
        match,
        distortion,
        monitor.timings,
        monitor.warnings,
        bones,
        feature_names=_names(fitted, chosen, features),
    )
