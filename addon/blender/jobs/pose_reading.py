"""Reads the pose of an object, to be applied to other objects."""

from __future__ import annotations

import bpy
import numpy as np

from ...core import CanonicalFormError
from ..objects.mesh_reading import read_evaluated, read_mesh
from ..objects.object_states import object_mode
from ..words.wording import told
from .likeness import Likeness, PoseArrays


def read_likeness(obj: bpy.types.Object | None, side: int = -1) -> Likeness:
    """Read the pose that an object is shown in.

    Parameters
    ----------
    obj : bpy.types.Object or None
        The object.
    side : int
        Which way to match: -1 for the most likely, or its index.

    Returns
    -------
    Likeness
        Its pose.

    Raises
    ------
    CanonicalFormError
        If the object does not exist, has no faces or is not visible.
    """
    reason = reference_refusal(obj)
    if obj is None or reason is not None:
        raise CanonicalFormError(reason or "")
    return Likeness("OBJECT", obj.name, _read(obj), side)


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


def reference_refusal(obj: bpy.types.Object | None) -> str | None:
    """Return why the pose of an object cannot be applied to others.

    Parameters
    ----------
    obj : bpy.types.Object or None
        The object.

    Returns
    -------
    str or None
        A sentence that names the remedy; None if it can be applied.
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


def _read(obj: bpy.types.Object) -> PoseArrays:
    """Read an object's evaluated mesh, and its base mesh for matching if both have the same vertices."""
    with object_mode(obj):
        vertices, faces = read_mesh(obj.data)
        shown, shown_faces = read_evaluated(obj)
    if len(shown) != len(vertices):
        vertices, faces = shown, shown_faces
    turn = np.array(obj.matrix_world)[:3, :3]
    if np.linalg.det(turn) < 0:
        faces = faces[:, ::-1]
    return PoseArrays(vertices @ turn.T, faces, shown @ turn.T)
