"""Solid shading of the 3D Views, switched to colour attributes and back."""

from __future__ import annotations

import bpy

from ..blender.records.distance_record import DISTANCES_PROPERTY
from ..blender.records.record import RECORD_PROPERTY

_BEFORE = "canonical_form_shading"  # property of a screen: the earlier colour types of its views


def show_colours(context: bpy.types.Context) -> None:
    """Switch views in solid shading to the active colour attributes.

    Parameters
    ----------
    context : bpy.types.Context
        Any context with windows.
    """
    for window in context.window_manager.windows:
        screen = window.screen
        before = screen[_BEFORE].to_dict() if _BEFORE in screen else {}
        for number, area in enumerate(screen.areas):
            shading = area.spaces.active.shading if area.type == "VIEW_3D" else None
            if shading is not None and shading.type == "SOLID" and shading.color_type != "VERTEX":
                before[str(number)] = shading.color_type
                shading.color_type = "VERTEX"
        if before:
            screen[_BEFORE] = before


def restore_shading(context: bpy.types.Context) -> None:
    """Switch back the views that `show_colours` switched, if they still show colour attributes.

    Parameters
    ----------
    context : bpy.types.Context
        Any context.
    """
    for screen in bpy.data.screens:
        if _BEFORE not in screen:
            continue
        before = screen[_BEFORE].to_dict()
        for number, area in enumerate(screen.areas):
            if area.type == "VIEW_3D" and str(number) in before and area.spaces.active.shading.color_type == "VERTEX":
                area.spaces.active.shading.color_type = before[str(number)]
        del screen[_BEFORE]


def any_result() -> bool:
    """Return whether any mesh of the file that has a user has colours written by this extension.

    Returns
    -------
    bool
        True for the result of a run and for distances.
    """
    ours = {RECORD_PROPERTY, DISTANCES_PROPERTY}
    return any(mesh.users and not ours.isdisjoint(mesh.keys()) for mesh in bpy.data.meshes)


@bpy.app.handlers.persistent
def _after_undo(*_: object) -> None:
    """Switch the views back if undo has removed the last result."""
    if not any_result():
        restore_shading(bpy.context)


def register() -> None:
    """Add the undo handler."""
    bpy.app.handlers.undo_post.append(_after_undo)


def unregister() -> None:
    """Remove the handler and switch the views back."""
    bpy.app.handlers.undo_post.remove(_after_undo)
    restore_shading(bpy.context)
