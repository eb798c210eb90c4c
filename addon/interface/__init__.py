"""The user interface in Blender: operators, panels, properties and the command line."""

from __future__ import annotations

from . import (
    catalogues,
    commands,
    job_operator,
    limb_operators,
    live_update,
    menus,
    operators,
    overlay,
    panels,
    pose_operators,
    preferences,
    properties,
    tool_operators,
    viewport,
)

_PARTS = (
    catalogues,
    preferences,
    properties,
    viewport,
    job_operator,
    operators,
    live_update,
    limb_operators,
    pose_operators,
    tool_operators,
    panels,
    menus,
    overlay,
    commands,
)


def register() -> None:
    """Register all modules, in order."""
    for part in _PARTS:
        part.register()


def unregister() -> None:
    """Unregister all modules, in reverse order."""
    for part in reversed(_PARTS):
        part.unregister()
