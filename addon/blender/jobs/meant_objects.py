"""The meshes that a run applies to: the active one, the selected ones, or those of the active armature."""

from __future__ import annotations

import bpy

from ...core import CanonicalFormError
from ..objects.movers import armature_of
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
        armature deforms, or that hang on the active object. Only the active object if none of these is a mesh.
    """
    active = context.object
    if active is None or active.type != "MESH":
        return with_companions(_others(context)) or [active]
    others = context.selected_objects if active.mode == "OBJECT" else ()
    return with_companions([active, *(obj for obj in others if obj.type == "MESH" and obj != active)])


def meant_meshes(context: bpy.types.Context) -> list[bpy.types.Object]:
    """Return the meshes that a run applies to, none where nothing can be computed.

    Parameters
    ----------
    context : bpy.types.Context
        Any context.

    Returns
    -------
    list of bpy.types.Object
        Those of `meant_objects` that are meshes.
    """
    return [obj for obj in meant_objects(context) if obj is not None and obj.type == "MESH"]


def _others(context: bpy.types.Context) -> list[bpy.types.Object]:
    """Return the selected meshes, or those of the active armature or below what is active, the largest first."""
    active = context.object
    found = [obj for obj in context.selected_objects if obj.type == "MESH"]
    meshes = [] if found or active is None else [obj for obj in context.visible_objects if obj.type == "MESH"]
    if active is not None and active.type == "ARMATURE":
        found += [obj for obj in meshes if armature_of(obj) == active]
    elif active is not None and meshes:
        found += [obj for obj in active.children_recursive if obj in meshes]  # an importer's root
    return sorted(found, key=lambda obj: (-len(obj.data.vertices), obj.name))
