"""Entry point for the stance of a rigged mesh: a T-pose or an A-pose from its own bones."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .measures.form_measures import edge_stretch
from .mesh.geometry import vertex_areas
from .numerics.arrays import FloatArray, IntArray
from .results import Stance
from .rigging.limb_bones import LimbBones, limb_bones
from .rigging.skeleton import Skeleton, skinned
from .rigging.stance import ARMS_LOWERED, facing_of, stance
from .run.errors import InvalidMeshError, InvalidSettingsError
from .run.monitor import Monitor

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
    points, triangles = np.asarray(vertices, dtype=np.float64), np.asarray(faces, dtype=np.int64)
    held = np.asarray(weights, dtype=np.float64)
    count = len(skeleton.names)
    shapes = (np.shape(skeleton.parents), np.shape(skeleton.heads), np.shape(skeleton.tails), held.shape)
    if shapes != ((count,), (count, 3), (count, 3), (len(points), count)):
        raise InvalidMeshError("stance_arrays", bones=count, vertices=len(points))
    monitor = Monitor()
    with monitor.stage("Pose"):
        limbs = limb_bones(skeleton, held)
        if not limbs:
            raise InvalidMeshError("stance_limbs")
        root = skeleton.downwards()[0]
        total = held.sum(axis=1, keepdims=True)
        held = np.where(total > 0, held / np.maximum(total, np.finfo(float).tiny), np.eye(count)[root])
        across = points @ facing_of(skeleton, limbs)[0]
        motions = stance(skeleton, limbs, pose, _foot_width(across, held, limbs))
        posed = skinned(points, held, motions)
        areas = vertex_areas(points, triangles)
        posed += areas / areas.sum() @ (points - posed)
        distortion = float(np.median(np.abs(edge_stretch(points, posed, triangles) - 1)))
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
