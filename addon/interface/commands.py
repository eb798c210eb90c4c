"""Makes ``blender --background --command canonical_form …`` known to Blender."""

import bpy


class _Command:
    handle: object | None = None


def _run(arguments: list[str]) -> int:
    from ..batch.command import main
    from ..result_lines import claim_output

    return main(arguments, claim_output(), alone=True)


def register() -> None:
    """Register the command."""
    _Command.handle = bpy.utils.register_cli_command("canonical_form", _run)


def unregister() -> None:
    """Unregister the command."""
    bpy.utils.unregister_cli_command(_Command.handle)
    _Command.handle = None
