"""Reads the pose of an object, to be applied to other objects."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np

from ...core import CanonicalFormError
from ..objects.combining import concatenated, moved, outward
from ..objects.mesh_reading import read_evaluated, read_mesh
from ..objects.object_states import object_mode
from ..objects.placement import placement_of
from ..objects.rest_reading import moved_by
from ..words.wording import told
from .likeness import Likeness, PoseArrays


def read_likeness(obj: bpy.types.Object | None, side: int = -1, targets: Sequence[bpy.types.Object] = ()) -> Likeness:
    """Read the pose that an object is shown in.

    Parameters
    ----------
    obj : bpy.types.Object or None
        The object.
    side : int
        Which way to match: -1 for the most likely, or its index.
    targets : sequence of bpy.types.Object
        What is to take the pose, and gives none itself.

    Returns
    -------
    Likeness
        Its pose.

    Raises
    ------
    CanonicalFormError
        If the object does not exist, has no faces or is not visible.
    """
    meshes = reference_meshes(obj, targets)
    assert obj is not None  # it has meshes
    return Likeness("OBJECT", obj.name, _together(meshes), side)


def named_reference(name: str) -> bpy.types.Object | None:
    """Find an object by its name, for `read_likeness` and the like.

    Parameters
    ----------
    name : str
        Name of the object; may be empty.

    Returns
    -------
    bpy.types.Object or None
        The object; None without a name.

    Raises
    ------
    CanonicalFormError
        If no object of the file has the name.
    """
    obj = bpy.data.objects.get(name)
    if obj is None and name:
        raise CanonicalFormError(told("There is no object {name}. Choose another reference.", name=name))
    return obj


def reference_meshes(obj: bpy.types.Object | None, targets: Sequence[bpy.types.Object] = ()) -> list[bpy.types.Object]:
    """List the meshes that an object stands for as a reference: itself, or those that an armature alone moves.

    Parameters
    ----------
    obj : bpy.types.Object or None
        The object.
    targets : sequence of bpy.types.Object
        What is to take something over from it, and is none of its meshes.

    Returns
    -------
    list of bpy.types.Object
        At least one; those of an armature that are shown.

    Raises
    ------
    CanonicalFormError
        If there are none, or one cannot be read; the message names the remedy.
    """
    if obj is None:
        raise CanonicalFormError(_reference_refusal(obj) or "")
    meshes = [obj]
    if obj.type == "ARMATURE":
        meshes = [each for each in moved_by(obj) if each not in targets]
    if not meshes:
        raise CanonicalFormError(told("{name} moves no other mesh that is shown. Choose a mesh.", name=obj.name))
    for each in meshes:
        reason = _reference_refusal(each)
        if reason is not None:
            raise CanonicalFormError(reason)
    return meshes


def may_be_reference(obj: bpy.types.Object) -> bool:
    """Return whether an object can show the pose that is wanted.

    Parameters
    ----------
    obj : bpy.types.Object
        The object.

    Returns
    -------
    bool
        True for meshes with faces, and for armatures that move some.
    """
    return bool(moved_by(obj)) if obj.type == "ARMATURE" else _reference_refusal(obj) is None


def _reference_refusal(obj: bpy.types.Object | None) -> str | None:
    """Return why the pose of an object cannot be applied to others.

    The sentence names the remedy.
    """
    if obj is None:
        return told("Choose an object in the pose that is wanted as the reference first.")
    if obj.type != "MESH":
        return told("{name} is not a mesh. Choose the mesh that shows the pose as the reference.", name=obj.name)
    if not obj.data.polygons and obj.mode != "EDIT":
        return told("{name} has no faces. Choose another reference.", name=obj.name)
    if obj.data.is_editmode and obj != bpy.context.view_layer.objects.active:
        return told("{name} is being edited. Leave Edit Mode there first.", name=obj.name)
    return None


def _together(meshes: Sequence[bpy.types.Object]) -> PoseArrays:
    """Read the evaluated meshes of a character, and its base meshes for matching if they have the same vertices."""
    read = []
    for obj in meshes:
        with object_mode(obj):
            read.append((*read_mesh(obj.data), *read_evaluated(obj)))
    same = all(len(base) == len(shown) for base, _, shown, _ in read)  # else all are matched as they are shown
    parts = []
    for obj, (base, faces, shown, shown_faces) in zip(meshes, read, strict=True):
        rest, now = placement_of(obj, not same), placement_of(obj, True)
        if len(meshes) == 1:  # where it is, and whether it rests, is nothing to its shape
            rest = now = np.block([[now[:3, :3], np.zeros((3, 1))], [0, 0, 0, 1]])
        own, corners = (base, faces) if same else (shown, shown_faces)
        parts.append(PoseArrays(moved(own, rest), outward(corners, rest), moved(shown, now)))
    vertices, triangles, _ = concatenated([each[:2] for each in parts])
    return PoseArrays(vertices, triangles, np.concatenate([each.pose for each in parts]))
