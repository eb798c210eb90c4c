"""What Blender's user meets: operators, panels, properties and the command line."""

from __future__ import annotations

from . import commands, operators, panels, properties

_PARTS = (properties, operators, panels, commands)


def register() -> None:
    """Register every part, in order."""
    for part in _PARTS:
        part.register()


def unregister() -> None:
    """Unregister every part, in reverse."""
    for part in reversed(_PARTS):
        part.unregister()
