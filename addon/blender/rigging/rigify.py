"""Rigify's own rig on the bones of a body: its metarig laid on them, and generated."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

import bpy
import numpy as np
from mathutils import Matrix, Vector

from ...core import CanonicalFormError
from ...core.rigging.reference_rig import MANNEQUIN_BONES
from ..words.wording import told
from .armatures import active_alone, bones_edited, motion_matrix, put_beside

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from ...core import Skeleton
    from ...core.numerics.arrays import FloatArray
    from ...core.rigging.skeleton import BoneMotions

_WIDGETS = "WGTS_"  # what Rigify puts before the name of a rig to name the collection of its widgets
_METARIG = "Metarig of {}"
_SWITCH = "IK_FK"  # property of a limb
_MISSED = 0.02  # of the size: joints that are off by more show a pose that the controls do not reach
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
    with active_alone(None), _in_the_scene():
        bpy.ops.object.armature_basic_human_metarig_add()
        metarig = bpy.context.view_layer.objects.active
        metarig.data.rigify_rig_basename = _free(name)
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
    rig.location = origin  # Rigify leaves a new rig at the scene's origin
    for each in (rig, metarig):
        put_beside(each, beside)
    rig.name, metarig.name = name, _METARIG.format(beside.name)
    metarig.hide_set(True)
    return rig


def add_rigify_pose(
    rig: bpy.types.Object, name: str, skeleton: Skeleton, motions: BoneMotions, origin: FloatArray
) -> bpy.types.Action | None:
    """Keep a pose of Rigify's rig, by its FK controls, as an action in the asset browser.

    Parameters
    ----------
    rig : bpy.types.Object
        The rig, without an action, in its rest pose; it is left so.
    name : str
        Name of the action, if that is free.
    skeleton : Skeleton
        The mannequin's bones, in world space.
    motions : BoneMotions
        How they move.
    origin : (3,) ndarray of float
        Where the rig was made.

    Returns
    -------
    bpy.types.Action or None
        The action; None if the controls do not reach the pose.
    """
    with _evaluated(rig):
        action, off = _keyed(rig, skeleton, motions, origin)
    size = float(np.ptp(np.vstack([skeleton.heads, skeleton.tails]), axis=0).max())
    if off > _MISSED * size:
        bpy.data.actions.remove(action)
        return None
    action.name = name
    action.asset_mark()
    return action


def _keyed(
    rig: bpy.types.Object, skeleton: Skeleton, motions: BoneMotions, origin: FloatArray
) -> tuple[bpy.types.Action, float]:
    """Key a pose on the FK controls, and leave the rig as it was; also how far joints are off it."""
    layer, bones = bpy.context.view_layer, rig.pose.bones
    switches = [bone for bone in bones if bone.name.endswith(("_parent.L", "_parent.R")) and _SWITCH in bone]
    before = [bone[_SWITCH] for bone in switches]
    moved = []
    try:
        for bone in switches:
            bone[_SWITCH] = 1.0  # FK
            bone.keyframe_insert(f'["{_SWITCH}"]', frame=1)
        for control, bone in ((bones.get(each), name) for each, name in _controls()):
            if control is None:
                continue
            moved.append(control)
            layer.update()  # where its parents are by now
            control.matrix = motion_matrix(skeleton.names.index(bone), motions, origin) @ control.bone.matrix_local
            turn = {"QUATERNION": "rotation_quaternion", "AXIS_ANGLE": "rotation_axis_angle"}
            for path in ("location", turn.get(control.rotation_mode, "rotation_euler")):
                control.keyframe_insert(path, frame=1)
        layer.update()
        off = max(
            (
                motion_matrix(number, motions, origin) @ Vector(skeleton.heads[number] - origin)
                - bones[DEFORMING + bone].head
            ).length
            for number, bone in enumerate(skeleton.names)
        )
        action = rig.animation_data.action
        rig.animation_data.action = None  # its drivers stay
    finally:
        for bone, value in zip(switches, before, strict=True):
            bone[_SWITCH] = value
        for control in moved:
            control.matrix_basis = Matrix.Identity(4)
        layer.update()
    return action, off


def _controls() -> Iterator[tuple[str, str]]:
    """Name controls, each after those that it hangs on, and the bones of the mannequin that they move."""
    yield "torso", "spine"
    for number in (".001", ".002", ".003", ""):  # the lowest hangs on the next
        yield f"spine_fk{number}", f"spine{number}"
    yield from (("neck", "spine.004"), ("head", "spine.006"))
    for side in "LR":
        yield f"shoulder.{side}", f"shoulder.{side}"
        for limb in _LIMBS:
            yield f"{limb}_fk.{side}", f"{limb}.{side}"


def _free(name: str) -> str:
    """Return a name that neither an object has nor the widgets of a rig: rigs of one name would share them."""
    number, found = 0, name
    while found in bpy.data.objects or f"{_WIDGETS}{found}" in bpy.data.collections:
        number += 1
        found = f"{name}.{number:03}"
    return found


@contextmanager
def _in_the_scene() -> Iterator[None]:
    """Let new objects lie in the scene's own collection, whatever collection is active, locked or hidden."""
    layer = bpy.context.view_layer
    active = layer.active_layer_collection
    layer.active_layer_collection = layer.layer_collection
    try:
        yield
    finally:
        layer.active_layer_collection = active


@contextmanager
def _evaluated(rig: bpy.types.Object) -> Iterator[None]:
    """Let Blender compute a rig even if its collections are switched off."""
    own = bpy.context.scene.collection
    linked = rig.name in own.objects
    if not linked:
        own.objects.link(rig)
    try:
        yield
    finally:
        if not linked:
            own.objects.unlink(rig)


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
