"""Colours in the 3D View: solid shading switched to them, and back."""

from __future__ import annotations

import bpy

from ..blender.records import DISTANCES, RECORD
from .preferences import switches_shading

_BEFORE = "canonical_form_shading"  # of a screen: what its views were coloured by


def show_colours(context: bpy.types.Context) -> None:
    """Switch solid views to the active colours of the meshes, if the preferences say so.

    Parameters
    ----------
    context : bpy.types.Context
        Any context with windows.
    """
    if not switches_shading(context):
        return
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
    """Switch back the views that `show_colours` has switched and the user has not.

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
    """Tell whether any mesh of the file shows colours of ours.

    Returns
    -------
    bool
        True for a result or for distances.
    """
    return any(RECORD in mesh or DISTANCES in mesh for mesh in bpy.data.meshes)


@bpy.app.handlers.persistent
def _after_undo(*_: object) -> None:
    """Switch the views back where undo has taken the last result away."""
    if not any_result():
        restore_shading(bpy.context)


def register() -> None:
    """Listen to undo."""
    bpy.app.handlers.undo_post.append(_after_undo)


def unregister() -> None:
    """Switch the views back before the extension goes."""
    bpy.app.handlers.undo_post.remove(_after_undo)
    restore_shading(bpy.context)
