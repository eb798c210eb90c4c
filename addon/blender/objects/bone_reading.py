"""Reads the bones of a rig and how far each vertex follows them, so that a pose can be made of them without Blender."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ...core import Skeleton
from ..mesh_items.weight_reading import weights_of
from .mesh_reading import Bones, Reading
from .rest_reading import chain_of, rigs_of

if TYPE_CHECKING:
    from ...core.numerics.arrays import FloatArray


def with_bones(objects: Sequence[bpy.types.Object], readings: Sequence[Reading]) -> list[Reading]:
    """Add the bones to readings of which the positions at rest are known.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        The objects, in Object Mode.
    readings : sequence of Reading
        Their arrays, after `with_rests`.

    Returns
    -------
    list of Reading
        The same with `bones`, for each object that one armature moves.
    """
    skeletons: dict[str, Skeleton] = {}
    found = []
    for obj, reading in zip(objects, readings, strict=True):
        rig = next(iter(rigs_of(obj)), None)
        if rig is None or reading.rest is None:
            found.append(reading)
            continue
        skeleton = skeletons.setdefault(rig.name, _skeleton_of(rig))
        weights = _weights_of(obj, rig, reading)
        found.append(reading if weights is None else reading._replace(bones=Bones(rig.name, skeleton, weights)))
    return found


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
    """Read how far each vertex of an object follows each bone; None if not as many as were read have weights."""
    names = [bone.name for bone in rig.data.bones]
    weights = np.zeros((len(reading.vertices), len(names)))
    if any(each.type == "ARMATURE" and each.show_viewport and each.object == rig for each in obj.modifiers):
        deforming = [bone.name for bone in rig.data.bones if bone.use_deform]
        for name, own in weights_of(obj, deforming, shown=reading.deformed).items():
            if len(own) != len(weights):
                return None
            weights[:, names.index(name)] = own
        return weights
    bone = next((each.parent_bone for each in chain_of(obj) if each.parent == rig and each.parent_type == "BONE"), "")
    if bone in names:
        weights[:, names.index(bone)] = 1.0
    return weights  # without any, it moves with the armature as a whole
