"""Opens a mesh file with Blender if it is available, and otherwise without."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from pathlib import Path

from ..blender.files.plain_files import has_blender
from ..blender.words.file_errors import sentence
from ..core.run.errors import CanonicalFormError
from .open_files import OpenFile
from .wanted import Wanted


def open_file(path: Path, wanted: Wanted, names: Sequence[str] = ()) -> OpenFile:
    """Open a mesh file, in place of one that is open in Blender; `names` are the required objects, empty for all."""
    if not has_blender():
        from .plain_file import PlainFile

        return PlainFile(path, wanted, names)
    with_blender("This")
    from .blender_file import BlenderFile

    return BlenderFile(path, wanted, names)


def with_blender(what: str) -> None:
    """Start Blender as a module, so that what it prints does not come between the result lines."""
    if not has_blender():
        raise CanonicalFormError(f"{what} needs Blender as a module (pip install bpy).")
    if "bpy" not in sys.modules:
        sys.stdout.flush()
        os.dup2(2, 1)


def explained(error: Exception) -> str:
    """Explain why there is no result and what to do about it, in Blender with the menu that helps."""
    if has_blender():
        from ..blender.words.advice import explained as explained_in_blender

        return explained_in_blender(error)
    if isinstance(error, MemoryError):
        return "Not enough memory. Close other programs, or reduce the mesh."
    return sentence(error) if isinstance(error, OSError) else str(error)
