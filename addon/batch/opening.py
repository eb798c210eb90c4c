"""Opens a mesh file with Blender if it is available, and otherwise without."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from pathlib import Path

from ..blender.files.plain_files import has_blender
from ..blender.words.file_errors import sentence
from .open_files import OpenFile
from .wanted import Wanted


def open_file(path: Path, wanted: Wanted, names: Sequence[str] = ()) -> OpenFile:
    """Open a mesh file, in place of one that is open in Blender; `names` are the required objects, empty for all."""
    if not has_blender():
        from .plain_file import PlainFile

        return PlainFile(path, wanted, names)
    if "bpy" not in sys.modules:  # what Blender prints must not come between the result lines
        sys.stdout.flush()
        os.dup2(2, 1)
    from .blender_file import BlenderFile

    return BlenderFile(path, wanted, names)


def explained(error: Exception) -> str:
    """Explain why there is no result and what to do about it, in Blender with the menu that helps."""
    if has_blender():
        from ..blender.words.advice import explained as explained_in_blender

        return explained_in_blender(error)
    if isinstance(error, MemoryError):
        return "Not enough memory. Close other programs, or reduce the mesh."
    return sentence(error) if isinstance(error, OSError) else str(error)
