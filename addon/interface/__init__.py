"""The user interface in Blender: operators, panels, properties and the command line."""

from __future__ import annotations

import sys

import bpy

from . import (
    catalogues,
    choices,
    commands,
    contact_operators,
    gizmos,
    job_operator,
    keeping_operators,
    limb_operators,
    live_update,
    menus,
    operators,
    overlay,
    panels,
    point_operators,
    pose_operators,
    preferences,
    properties,
    reading,
    rig_operators,
    tool_operators,
    viewport,
)

_PARTS = (
    catalogues,
    preferences,
    properties,
    choices,
    viewport,
    job_operator,
    reading,
    operators,
    live_update,
    limb_operators,
    pose_operators,
    rig_operators,
    tool_operators,
    contact_operators,
    keeping_operators,
    point_operators,
    panels,
    menus,
    overlay,
    gizmos,
    commands,
)


_TWICE = (
    "Canonical Form is enabled twice, in two repositories or versions: this copy stays off. "
    "Remove one in Edit > Preferences > Get Extensions, and start Blender again."
)


def register() -> None:
    """Register all modules, in order; nothing if another copy of this extension is registered."""
    if _registered() is not None:
        print(_TWICE, file=sys.stderr)
        return
    for part in _PARTS:
        part.register()


def unregister() -> None:
    """Unregister all modules, in reverse order; nothing if it is another copy that is registered."""
    if _registered() != operators.OBJECT_OT_canonical_form:
        return
    for part in reversed(_PARTS):
        part.unregister()


def _registered() -> type | None:
    """Return the class of the main operator that is registered: ours, that of another copy, or None."""
    return getattr(bpy.types, operators.OBJECT_OT_canonical_form.__name__, None)
