"""Canonical Form: takes the pose out of a mesh. What `core` exports can be imported from here as well."""

from typing import Any


def register() -> None:
    """Register operators, panels, properties and the command line with Blender."""
    from . import interface

    interface.register()


def unregister() -> None:
    """Take everything out of Blender that `register` put in."""
    from . import interface

    interface.unregister()


def __getattr__(name: str) -> Any:
    """Import a name of the core when it is first asked for: ``from canonical_form import Settings``."""
    from importlib import import_module

    core = import_module(".core", __name__)
    if name in core.__all__:
        return getattr(core, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
