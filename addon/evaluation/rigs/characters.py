"""Rigged characters as arrays: skin and bones at rest, and poses of their own clips or of random bones."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

from ...core import InvalidMeshError
from ...core.numerics.arrays import FloatArray
from ...core.rigging.reference_rig import ReferenceRig, checked_rig
from ...core.rigging.skeleton import BoneMotions, Skeleton
from ..reading import load_blender

_LIMB, _TRUNK = 35.0, 10.0  # degrees that a random bone turns at most: one that carries little skin, or much
_MUCH = 0.5  # share of the skin that a bone carries with all that hangs on it
_LEAST = 0.004  # share of the skin below which a bone holds none


class Character(NamedTuple):
    """A rigged character.

    Attributes
    ----------
    name : str
        Name of its file.
    rig : ReferenceRig
        Its skin and bones at rest, in world space; weights of a vertex sum to 1.
    poses : dict of str to BoneMotions
        How the bones move from rest, by the name of the pose.
    """

    name: str
    rig: ReferenceRig
    poses: dict[str, BoneMotions]


def read_character(path: Path, frames: int, randoms: int) -> Character:
    """Read a character with Blender, in this process.

    Parameters
    ----------
    path : Path
        A .glb, .fbx or .blend file.
    frames : int
        Number of poses of its clips: of the one that walks, if there is one.
    randoms : int
        Number of poses of random bones.

    Returns
    -------
    Character
        Its arrays.

    Raises
    ------
    InvalidMeshError
        If it cannot be read.
    """
    try:
        load_blender()
    except ImportError as error:
        raise InvalidMeshError(f"{path.name} can only be read by Blender as a module: pip install bpy.") from error
    import bpy

    from ...blender.files.reading_files import open_meshes
    from ...blender.objects.rest_reading import rigs_of
    from ...blender.rigging.rig_reading import read_rig_source

    objects = open_meshes(path)
    largest = max(objects, key=lambda each: len(each.data.vertices))
    bpy.context.view_layer.update()
    whole = checked_rig(read_rig_source(largest).rig)
    poses = _of_clips(next(iter(rigs_of(largest))), whole.skeleton, frames) if frames else {}
    poses |= {f"random {seed + 1}": random_pose(whole, seed) for seed in range(randoms)}
    return Character(path.stem, whole, poses)


def _of_clips(armature: object, skeleton: Skeleton, count: int) -> dict[str, BoneMotions]:
    """Read frames of a clip, evenly spaced: how each bone has moved from rest."""
    import bpy

    clips = sorted(bpy.data.actions, key=lambda each: ("walk" not in each.name.lower(), each.name))
    clips = [each for each in clips if each.frame_range[1] > each.frame_range[0]]
    if not clips:
        return {}
    data = armature.animation_data_create()  # type: ignore[attr-defined]
    for track in list(data.nla_tracks):
        data.nla_tracks.remove(track)
    data.action = clips[0]
    if hasattr(data, "action_slot") and data.action_slot is None and len(clips[0].slots):
        data.action_slot = clips[0].slots[0]
    begin, end = clips[0].frame_range
    poses = {}
    for number in range(count):
        bpy.context.scene.frame_set(round(begin + (end - begin) * number / count))
        bpy.context.view_layer.update()
        place = np.array(armature.matrix_world)  # type: ignore[attr-defined]
        moved = []
        for bone in (armature.pose.bones[name] for name in skeleton.names):  # type: ignore[attr-defined]
            now, rest = np.array(bone.matrix), np.array(bone.bone.matrix_local)
            moved.append(place @ now @ np.linalg.inv(rest) @ np.linalg.inv(place))
        maps = np.array(moved)
        heads = np.einsum("bij,bj->bi", maps[:, :3, :3], skeleton.heads) + maps[:, :3, 3]
        poses[f"{clips[0].name} {number + 1}"] = BoneMotions(skeleton.heads, heads, maps[:, :3, :3])
    return poses


def random_pose(rig: ReferenceRig, seed: int) -> BoneMotions:
    """Turn all bones that hold skin about random axes, those of the trunk less.

    Parameters
    ----------
    rig : ReferenceRig
        The character.
    seed : int
        Of the random numbers.

    Returns
    -------
    BoneMotions
        The pose.
    """
    from scipy.spatial.transform import Rotation

    bones, rng = rig.skeleton, np.random.default_rng(seed)
    carried = rig.weights.sum(axis=0) / len(rig.vertices)
    own = carried.copy()
    for bone in reversed(bones.downwards()):
        if bones.parents[bone] >= 0:
            carried[bones.parents[bone]] += carried[bone]
    turns, heads = np.broadcast_to(np.eye(3), (len(own), 3, 3)).copy(), bones.heads.copy()
    for bone in bones.downwards():
        axis = rng.normal(size=3)
        most = _TRUNK if carried[bone] > _MUCH else _LIMB
        angle = np.radians(rng.uniform(0, most)) * (own[bone] > _LEAST)
        above = bones.parents[bone]
        turn = Rotation.from_rotvec(angle * axis / np.linalg.norm(axis)).as_matrix()
        turns[bone] = turn if above < 0 else turns[above] @ turn
        if above >= 0:
            heads[bone] = heads[above] + turns[above] @ (bones.heads[bone] - bones.heads[above])
    return BoneMotions(bones.heads, heads, turns)


def rotations(motions: BoneMotions) -> FloatArray:
    """Return the rotations of bones that may stretch, too, (b, 3, 3).

    Parameters
    ----------
    motions : BoneMotions
        Their motions.

    Returns
    -------
    (b, 3, 3) ndarray of float
        The nearest rotations.
    """
    left, _, right = np.linalg.svd(motions.turns)
    return np.asarray(left @ right)
