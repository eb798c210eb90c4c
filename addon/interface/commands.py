"""Makes ``blender --background --command canonical_form …`` known to Blender."""

import bpy


class _Command:
    handle: object | None = None


def _run(arguments: list[str]) -> int:
    from .. import command_line

    return command_line.main(arguments)


def register() -> None:
    """Register the command."""
    _Command.handle = bpy.utils.register_cli_command("canonical_form", _run)


def unregister() -> None:
    """Unregister the command."""
    bpy.utils.unregister_cli_command(_Command.handle)
    _Command.handle = None
