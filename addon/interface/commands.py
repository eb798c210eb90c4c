"""Registers the command ``blender --background --command canonical_form …`` with Blender."""

from collections.abc import Iterator
from contextlib import contextmanager

import bpy


class _Command:
    handle: object | None = None


def _run(arguments: list[str]) -> int:
    from ..batch.command import main
    from ..result_lines import claim_output

    with in_english():
        return main(arguments, claim_output(), alone=True)


@contextmanager
def in_english() -> Iterator[None]:
    """Temporarily switch Blender's interface and reports to English, as programs read the output.

    Yields
    ------
    None
        Interface and reports are in English until the end of the block.
    """
    view = bpy.context.preferences.view
    names = [name for name in ("use_translate_interface", "use_translate_reports") if hasattr(view, name)]
    kept = {name: getattr(view, name) for name in names}
    try:
        for name in names:
            setattr(view, name, False)
        yield
    finally:
        for name, value in kept.items():
            setattr(view, name, value)


def register() -> None:
    """Register the command."""
    _Command.handle = bpy.utils.register_cli_command("canonical_form", _run)


def unregister() -> None:
    """Unregister the command."""
    bpy.utils.unregister_cli_command(_Command.handle)
    _Command.handle = None
