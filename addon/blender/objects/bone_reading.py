"""Reads the bones of a rig and how far each vertex follows them, so that a pose can be made of them without Blender."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ...core import Skeleton
from ..mesh_items.weight_reading import weights_of
from ..words.wording import listed, told
from .mesh_reading import Bones, Reading
from .rest_reading import chain_of, rigs_of, with_rests

if TYPE_CHECKING:
    from ...core.numerics.arrays import FloatArray


def with_bones(objects: Sequence[bpy.types.Object], readings: Sequence[Reading]) -> list[Reading]:
    """Add the bones to readings, for each object that one armature moves.

    Each character has its own rest, whether `with_rests` knows one for all of them or not.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        The objects, in Object Mode.
    readings : sequence of Reading
        Their arrays.

    Returns
    -------
    list of Reading
        The same with `rig`, and with `bones` where they can be read.
    """
    found = list(readings)
    moving = [rigs_of(obj) for obj in objects]
    for rig in {next(iter(rigs)): None for rigs in moving if len(rigs) == 1}:
        own = [number for number, rigs in enumerate(moving) if rigs == {rig}]
        rested = with_rests([objects[number] for number in own], [readings[number] for number in own])
        mirrored = np.linalg.det(np.array(rig.matrix_world)[:3, :3]) <= 0  # its left bones are on the right
        skeleton = _skeleton_of(rig)
        for number, reading in zip(own, rested, strict=True):
            weights = None if mirrored or reading.rest is None else _weights_of(objects[number], rig, reading)
            bones = None
            if weights is not None and reading.rest is not None:
                bones = Bones(rig.name, skeleton, weights, reading.rest)
            found[number] = readings[number]._replace(bones=bones, rig=rig.name)
    return found


def without_bones(names: Sequence[str], source: str) -> list[str]:
    """Say which meshes of a character its bones do not move, so that they are left out.

    Parameters
    ----------
    names : sequence of str
        Names of the meshes.
    source : str
        Name of the character.

    Returns
    -------
    list of str
        One sentence for the user, or none.
    """
    if not names:
        return []
    told_so = told(
        "Left out of {source}, as its bones do not move them, or another armature does: {left}.",
        source=source,
        left=listed(names),
    )
    return [told_so]


def _skeleton_of(rig: bpy.types.Object) -> Skeleton:
    """Read the bones of an armature at rest, in world space."""
    bones = list(rig.data.bones)
    number = {bone.name: index for index, bone in enumerate(bones)}
    place = np.array(rig.matrix_world)
    heads, tails = (np.array([getattr(bone, end)[:] for bone in bones]) for end in ("head_local", "tail_local"))
    return Skeleton(
        [bone.name for bone in bones],
        np.array([-1 if bone.parent is None else number[bone.parent.name] for bone in bones]),
        *(ends @ place[:3, :3].T + place[:3, 3] for ends in (heads, tails)),
    )


def _weights_of(obj: bpy.types.Object, rig: bpy.types.Object, reading: Reading) -> FloatArray | None:
    """Read how far each vertex of an object follows each bone; None if the groups do not tell."""
    names = [bone.name for bone in rig.data.bones]
    weights = np.zeros((len(reading.vertices), len(names)))
    if any(each.type == "ARMATURE" and each.show_viewport and each.object == rig for each in obj.modifiers):
        deforming = [bone.name for bone in rig.data.bones if bone.use_deform]
        for name, own in weights_of(obj, deforming, shown=reading.deformed).items():
            if len(own) != len(weights):
                return None
            weights[:, names.index(name)] = own
        return weights if weights.any() else None
    bone = next((each.parent_bone for each in chain_of(obj) if each.parent == rig and each.parent_type == "BONE"), "")
    if bone in names:
        weights[:, names.index(bone)] = 1.0
    return weights  # without any, it moves with the armature as a whole
