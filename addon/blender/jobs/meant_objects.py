"""The meshes that a run applies to: the active one, the selected ones, or those of the active armature."""

from __future__ import annotations

import bpy

from ...core import CanonicalFormError
from ..results.companions import with_companions
from ..words.wording import told


def meant_object(context: bpy.types.Context) -> bpy.types.Object | None:
    """Return the object whose result is shown and changed.

    Parameters
    ----------
    context : bpy.types.Context
        Any context.

    Returns
    -------
    bpy.types.Object or None
        The active object if it is a mesh; otherwise the first of `meant_objects`, or the active object if there are
        none.
    """
    active = context.object
    if active is not None and active.type == "MESH":
        return active
    others = _others(context)
    return others[0] if others else active


def require_object(context: bpy.types.Context) -> bpy.types.Object:
    """Return the object whose result is changed, which must exist.

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
    """Return the meshes that a run applies to.

    Parameters
    ----------
    context : bpy.types.Context
        Any context.

    Returns
    -------
    list of bpy.types.Object
        The active mesh, then, in Object Mode, the other selected meshes and the companions of all of these. If the
        active object is not a mesh: the selected meshes; if none is selected, the visible meshes that the active
        armature deforms. Only the active object if none of these is a mesh.
    """
    active = context.object
    if active is None or active.type != "MESH":
        return with_companions(_others(context)) or [active]
    others = context.selected_objects if active.mode == "OBJECT" else ()
    return with_companions([active, *(obj for obj in others if obj.type == "MESH" and obj != active)])


def armature_of(obj: bpy.types.Object) -> bpy.types.Object | None:
    """Return the armature that deforms an object.

    Parameters
    ----------
    obj : bpy.types.Object
        The object.

    Returns
    -------
    bpy.types.Object or None
        The armature of its first enabled Armature modifier that has one.
    """
    for modifier in obj.modifiers:
        if modifier.type == "ARMATURE" and modifier.show_viewport and modifier.object is not None:
            return modifier.object
    return None


def _others(context: bpy.types.Context) -> list[bpy.types.Object]:
    """Return the selected meshes, or those of the active armature, the one with most vertices first."""
    active = context.object
    found = [obj for obj in context.selected_objects if obj.type == "MESH"]
    if not found and active is not None and active.type == "ARMATURE":
        found = [obj for obj in context.visible_objects if obj.type == "MESH" and armature_of(obj) == active]
    return sorted(found, key=lambda obj: (-len(obj.data.vertices), obj.name))
