"""The meshes that the user means: the active one, those selected, or those of the active armature."""

from __future__ import annotations

import bpy

from ...core import CanonicalFormError
from ..results.companions import with_companions
from ..words.wording import told


def meant_object(context: bpy.types.Context) -> bpy.types.Object | None:
    """Find the object whose result is shown and changed.

    Parameters
    ----------
    context : bpy.types.Context
        Any context.

    Returns
    -------
    bpy.types.Object or None
        The active object if it is a mesh; otherwise the first of the meshes meant, or the active object where there
        are none.
    """
    active = context.object
    if active is not None and active.type == "MESH":
        return active
    others = _others(context)
    return others[0] if others else active


def require_object(context: bpy.types.Context) -> bpy.types.Object:
    """Find the object whose result is changed, where there must be one.

    Parameters
    ----------
    context : bpy.types.Context
        Any context.

    Returns
    -------
    bpy.types.Object
        As `meant_object`.

    Raises
    ------
    CanonicalFormError
        If there is none.
    """
    obj = meant_object(context)
    if obj is None:
        raise CanonicalFormError(told("Select a mesh object first."))
    return obj


def meant_objects(context: bpy.types.Context) -> list[bpy.types.Object]:
    """List the meshes that a run takes.

    Parameters
    ----------
    context : bpy.types.Context
        Any context.

    Returns
    -------
    list of bpy.types.Object
        The active mesh first, then, in Object Mode, the other selected ones, and those whose forms are of one body with
        theirs. Where the active object is no mesh, the selected meshes; where none is selected, the visible ones that
        the active armature moves. The active object alone where none of that is a mesh.
    """
    active = context.object
    if active is None or active.type != "MESH":
        return with_companions(_others(context)) or [active]
    others = context.selected_objects if active.mode == "OBJECT" else ()
    return with_companions([active, *(obj for obj in others if obj.type == "MESH" and obj != active)])


def armature_of(obj: bpy.types.Object) -> bpy.types.Object | None:
    """Find the armature that moves an object.

    Parameters
    ----------
    obj : bpy.types.Object
        The object.

    Returns
    -------
    bpy.types.Object or None
        The armature of its first modifier that is shown and has one.
    """
    for modifier in obj.modifiers:
        if modifier.type == "ARMATURE" and modifier.show_viewport and modifier.object is not None:
            return modifier.object
    return None


def _others(context: bpy.types.Context) -> list[bpy.types.Object]:
    """List the selected meshes, or those of the active armature, the one with most vertices first."""
    active = context.object
    found = [obj for obj in context.selected_objects if obj.type == "MESH"]
    if not found and active is not None and active.type == "ARMATURE":
        found = [obj for obj in context.visible_objects if obj.type == "MESH" and armature_of(obj) == active]
    return sorted(found, key=lambda obj: (-len(obj.data.vertices), obj.name))
