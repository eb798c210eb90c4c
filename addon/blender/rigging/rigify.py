"""Rigify's own rig on the bones of a body: its metarig laid on them, and generated."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
import numpy as np
from mathutils import Vector

from ...core import CanonicalFormError
from ...core.rigging.reference_rig import MANNEQUIN_BONES
from ..words.wording import told
from .armatures import active_alone, bones_edited, put_beside

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ...core import Skeleton
    from ...core.numerics.arrays import FloatArray

_METARIG = "Metarig of {}"
DEFORMING = "DEF-"  # how Rigify calls the bones that move the skin
_LIMBS = ("upper_arm", "forearm", "hand", "thigh", "shin", "foot", "toe")
_BACK, _WIDE = 0.35, 0.2  # lengths of a foot: from the ankle back to the heel, and half the heel's width


def require_rigify(names: Sequence[str]) -> None:
    """Require that Rigify is switched on, and knows the bones.

    Parameters
    ----------
    names : sequence of str
        Names of the bones.

    Raises
    ------
    CanonicalFormError
        If not; the message names the remedy.
    """
    if "rigify" not in bpy.context.preferences.addons:
        raise CanonicalFormError(
            told("Rigify is switched off. Tick it in Edit > Preferences > Add-ons, and run again.")
        )
    if not set(MANNEQUIN_BONES) <= set(names):
        raise CanonicalFormError(
            told("Rigify needs bones of its own names: leave Bones From empty, and choose Names: Rigify.")
        )


def add_rigify(
    name: str, skeleton: Skeleton, bends: FloatArray, origin: FloatArray, beside: bpy.types.Object
) -> bpy.types.Object:
    """Lay Rigify's basic human metarig on bones, and generate its rig.

    Parameters
    ----------
    name, skeleton, bends, origin, beside
        As in `add_armature`; bones have the mannequin's names.

    Returns
    -------
    bpy.types.Object
        The generated rig, in Object Mode, neither selected nor active; the metarig is hidden.

    Raises
    ------
    CanonicalFormError
        If Rigify fails; the message says why.
    """
    with active_alone(None):
        bpy.ops.object.armature_basic_human_metarig_add()
        metarig = bpy.context.view_layer.objects.active
        metarig.location, metarig.rotation_euler = origin, (0.0, 0.0, 0.0)
        with bones_edited(metarig.data):
            _lay(metarig.data, skeleton, bends, origin)
        for bone in metarig.pose.bones:
            if bone.rigify_type.startswith("limbs."):
                bone.rigify_parameters.segments = 1  # so that each has one bone that moves skin
                bone.rigify_parameters.rotation_axis = "x"
        bpy.context.view_layer.update()
        try:
            bpy.ops.pose.rigify_generate()
        except RuntimeError as error:
            raise CanonicalFormError(told("Rigify failed: {reason}", reason=str(error).strip())) from error
        rig = metarig.data.rigify_target_rig
        if rig is None:
            raise CanonicalFormError(
                told("Rigify has made no rig. Its messages are in Window > Toggle System Console.")
            )
    for each in (rig, metarig):
        put_beside(each, beside)
    rig.name, metarig.name = name, _METARIG.format(beside.name)
    metarig.hide_set(True)
    return rig


def _lay(data: bpy.types.Armature, skeleton: Skeleton, bends: FloatArray, origin: FloatArray) -> None:
    """Lay the bones of a metarig, in Edit Mode; those that the skeleton lacks are removed, but for heels."""
    bones = data.edit_bones
    for bone in list(bones):
        if bone.name not in skeleton.names and not bone.name.startswith("heel"):
            for child in bone.children:
                child.parent = bone.parent
            bones.remove(bone)
    for bone in bones:
        bone.use_connect = False
    for number, name in enumerate(skeleton.names):
        if name in bones:
            way = skeleton.tails[number] - skeleton.heads[number]
            bones[name].head, bones[name].tail = skeleton.heads[number] - origin, skeleton.tails[number] - origin
            bones[name].align_roll(Vector(np.cross(bends[number], way)))
    for side in "LR":
        shin, foot = bones[f"shin.{side}"], bones[f"foot.{side}"]
        down, way = (shin.tail - shin.head).normalized(), foot.tail - foot.head
        drop = way.dot(down)
        ahead = (way - drop * down).normalized()
        heel, across = foot.head + drop * down - _BACK * way.length * ahead, down.cross(ahead) * _WIDE * way.length
        bone = bones[f"heel.02.{side}"]
        sign = 1.0 if across.x * (bone.tail.x - bone.head.x) > 0 else -1.0
        bone.head, bone.tail = heel - sign * across, heel + sign * across
        bone.roll = 0.0
    for name in ("spine.001", "spine.002", "spine.003", "spine.006"):
        bones[name].use_connect = True
    for name in _LIMBS:
        for side in "LR":
            bones[f"{name}.{side}"].use_connect = name not in ("upper_arm", "thigh")
