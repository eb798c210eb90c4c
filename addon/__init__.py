"""Canonical Form: takes the pose out of a mesh."""


def register() -> None:
    """Register operators, panels, properties and the command line with Blender."""
    from . import interface

    interface.register()


def unregister() -> None:
    """Take everything out of Blender that `register` put in."""
    from . import interface

    interface.unregister()
