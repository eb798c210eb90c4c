"""Makes an armature of a skeleton, and poses of it as assets."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, nullcontext
from typing import TYPE_CHECKING

import bpy
import numpy as np
from mathutils import Matrix, Vector

from ...core import CanonicalFormError
from ..objects.object_states import object_mode
from ..words.wording import told

if TYPE_CHECKING:
    from ...core import Skeleton
    from ...core.numerics.arrays import BoolArray, FloatArray
    from ...core.rigging.skeleton import BoneMotions

_JOINED = 1e-5  # of the skeleton's size: bones that are as near are connected
_SHORTEST = 1e-3  # of the skeleton's size: Blender deletes bones without length
_DOUBTFUL = "THEME01"  # red


def add_armature(
    name: str,
    skeleton: Skeleton,
    bends: FloatArray,
    deforming: BoolArray,
    origin: FloatArray,
    beside: bpy.types.Object,
) -> bpy.types.Object:
    """Make an armature.

    Parameters
    ----------
    name : str
        Its name, if that is free.
    skeleton : Skeleton
        Its bones, in world space.
    bends : (b, 3) ndarray of float
        X axis of each bone.
    deforming : (b,) ndarray of bool
        Whether each bone holds skin.
    origin : (3,) ndarray of float
        Where the object stands.
    beside : bpy.types.Object
        An object of the file, whose collections it shares.

    Returns
    -------
    bpy.types.Object
        The armature, in Object Mode, neither selected nor active.

    Raises
    ------
    CanonicalFormError
        If Blender cannot edit it.
    """
    data = bpy.data.armatures.new(name)
    armature = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(armature)
    armature.location = origin
    with active_alone(armature), bones_edited(data):
        _fill(data, skeleton, bends, deforming, origin)
    put_beside(armature, beside)
    armature.show_in_front = True
    return armature


@contextmanager
def active_alone(armature: bpy.types.Object | None) -> Iterator[None]:
    """Make an armature the only selected object, and the active one, and restore both and the mode afterwards.

    Parameters
    ----------
    armature : bpy.types.Object or None
        The armature, in the scene's own collection; None for one that is yet to be made.

    Yields
    ------
    None
        Control.

    Raises
    ------
    CanonicalFormError
        If Blender cannot leave the mode of the active object, or work on an armature here.
    """
    layer = bpy.context.view_layer
    active, selected = layer.objects.active, [each for each in layer.objects if each.select_get()]
    with nullcontext() if active is None else object_mode(active):
        try:
            for each in selected:
                each.select_set(False)
            layer.objects.active = armature
            with ExitStack() as stack:
                if armature is not None:
                    armature.select_set(True)
                    one = {"object": armature, "active_object": armature}
                    some = {"selected_objects": [armature], "selected_editable_objects": [armature]}
                    stack.enter_context(bpy.context.temp_override(**one, **some))  # a script may have overridden them
                yield
        except RuntimeError as error:
            raise CanonicalFormError(
                told("Blender cannot edit a new armature here. Leave Local View, and run again.")
            ) from error
        finally:
            for each in layer.objects:
                each.select_set(each in selected)
            layer.objects.active = active


@contextmanager
def bones_edited(data: bpy.types.Armature) -> Iterator[None]:
    """Switch to Edit Mode with the active armature, and back, even after an error.

    Parameters
    ----------
    data : bpy.types.Armature
        The armature.

    Yields
    ------
    None
        Control, with its bones to be edited.

    Raises
    ------
    CanonicalFormError
        If Blender edits something else.
    """
    bpy.ops.object.mode_set(mode="EDIT")
    if not data.is_editmode:
        raise CanonicalFormError(told("Blender cannot edit a new armature here. Leave Local View, and run again."))
    try:
        yield
    finally:
        bpy.ops.object.mode_set(mode="OBJECT")


def follow(armature: bpy.types.Object, obj: bpy.types.Object) -> None:
    """Hang an armature on what a body hangs on, in place.

    Parameters
    ----------
    armature : bpy.types.Object
        The armature.
    obj : bpy.types.Object
        The body; it may have no parent.
    """
    if obj.parent is not None:
        armature.parent, armature.parent_type = obj.parent, obj.parent_type
        armature.parent_vertices = obj.parent_vertices
        place = armature.matrix_basis.copy()
        bpy.context.view_layer.update()
        armature.matrix_parent_inverse = (armature.matrix_world @ place.inverted()).inverted()
    bpy.context.view_layer.update()


def put_beside(armature: bpy.types.Object, beside: bpy.types.Object) -> None:
    """Move an armature from where Blender or Rigify has put it to the collections of another object.

    Parameters
    ----------
    armature : bpy.types.Object
        The armature.
    beside : bpy.types.Object
        The other object.
    """
    wanted = beside.users_collection
    for collection in wanted:
        if armature.name not in collection.objects:
            collection.objects.link(armature)
    for collection in armature.users_collection if wanted else ():
        if collection not in wanted:
            collection.objects.unlink(armature)


def _fill(
    data: bpy.types.Armature, skeleton: Skeleton, bends: FloatArray, deforming: BoolArray, origin: FloatArray
) -> None:
    """Add the bones, in Edit Mode."""
    heads, tails = skeleton.heads - origin, skeleton.tails - origin
    size = float(np.ptp(np.vstack([heads, tails]), axis=0).max())
    bones = [data.edit_bones.new(name) for name in skeleton.names]
    for number, bone in enumerate(bones):
        parent, way = int(skeleton.parents[number]), tails[number] - heads[number]
        if np.linalg.norm(way) < _SHORTEST * size:
            way = np.array([0.0, 0.0, _SHORTEST * size])
        bone.head, bone.tail = heads[number], heads[number] + way
        bone.use_deform = bool(deforming[number])
        bone.align_roll(Vector(np.cross(bends[number], way)))
        if parent >= 0:
            bone.parent = bones[parent]
            bone.use_connect = bool(np.linalg.norm(tails[parent] - heads[number]) < _JOINED * size)


def colour_bones(armature: bpy.types.Object, names: Iterable[str]) -> None:
    """Colour bones that are doubtful.

    Parameters
    ----------
    armature : bpy.types.Object
        The armature.
    names : iterable of str
        Names of its bones.
    """
    for name in names:
        armature.data.bones[name].color.palette = _DOUBTFUL


def add_pose(armature: bpy.types.Object, name: str, motions: Mapping[str, tuple[Matrix, Matrix]]) -> bpy.types.Action:
    """Keep a pose as an action in the asset browser.

    Parameters
    ----------
    armature : bpy.types.Object
        The armature, without an action, in its rest pose; it is left so.
    name : str
        Name of the action, if that is free.
    motions : mapping of str to (Matrix, Matrix)
        For each bone, its matrix at rest and in the pose, in the space of the armature.

    Returns
    -------
    bpy.types.Action
        The action.
    """
    posed: dict[str, Matrix] = {}
    for bone in armature.pose.bones:
        rest, wanted = motions[bone.name]
        if bone.parent is not None:
            rest = posed[bone.parent.name] @ motions[bone.parent.name][0].inverted() @ rest
        basis = rest.inverted() @ wanted
        if bone.bone.use_connect:
            basis.translation = (0.0, 0.0, 0.0)
        posed[bone.name] = rest @ basis
        bone.rotation_mode = "QUATERNION"
        bone.location, bone.rotation_quaternion, _ = basis.decompose()
        for path in ("location", "rotation_quaternion"):
            bone.keyframe_insert(path, frame=1)
    action = armature.animation_data.action
    action.name = name
    action.asset_mark()
    armature.animation_data_clear()
    for bone in armature.pose.bones:
        bone.matrix_basis = Matrix.Identity(4)
    return action


def bone_matrices(
    armature: bpy.types.Object, skeleton: Skeleton, motions: BoneMotions
) -> dict[str, tuple[Matrix, Matrix]]:
    """Compute where bones lie at rest and after motions.

    Parameters
    ----------
    armature : bpy.types.Object
        The armature.
    skeleton : Skeleton
        Its bones.
    motions : BoneMotions
        How they move, in world space.

    Returns
    -------
    dict of str to (Matrix, Matrix)
        For each bone, its matrix at rest and in the pose, in the space of the armature.
    """
    found = {}
    origin = np.array(armature.location)
    for number, name in enumerate(skeleton.names):
        rest = armature.data.bones[name].matrix_local.copy()
        found[name] = rest, motion_matrix(number, motions, origin) @ rest
    return found


def motion_matrix(bone: int, motions: BoneMotions, origin: FloatArray) -> Matrix:
    """Return how a bone moves, in the space of an armature.

    Parameters
    ----------
    bone : int
        Its number.
    motions : BoneMotions
        How bones move, in world space.
    origin : (3,) ndarray of float
        Where the armature stands.

    Returns
    -------
    Matrix
        The motion.
    """
    turn = Matrix(motions.turns[bone].tolist()).to_4x4()
    there, start = (Vector(each[bone] - origin) for each in (motions.heads, motions.starts))
    return Matrix.Translation(there) @ turn @ Matrix.Translation(-start)
