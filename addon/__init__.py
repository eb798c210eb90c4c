"""Canonical Form: takes the pose out of a mesh. Everything that `core` exports can also be imported from here."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .core import *  # noqa: F403
    from .core import __version__ as __version__
    from .evaluation.plotting import plot as plot


def register() -> None:
    """Register operators, panels, properties and the command line with Blender."""
    from . import interface

    interface.register()


def unregister() -> None:
    """Unregister everything that `register` registered."""
    from . import interface

    interface.unregister()


def __getattr__(name: str) -> Any:
    """Import a name of the core, or `plot`, on first access: ``from canonical_form import Settings``."""
    from importlib import import_module

    if name == "plot":  # not part of the Blender extension
        return import_module(".evaluation.plotting", __name__).plot
    core = import_module(".core", __name__)
    if name in core.__all__ or name == "__version__":
        return getattr(core, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
