"""Reads and writes .off, .obj and .ply files, with or without Blender."""

from __future__ import annotations

import sys
from importlib.util import find_spec
from pathlib import Path

from ...core import InvalidMeshError
from .file_access import require_readable
from .kinds_of_files import PLAIN
from .obj_format import obj_lines, read_obj
from .off_format import off_lines, read_off
from .ply_format import ply_lines, read_ply
from .polygon_mesh import PolygonMesh
from .replacing_files import replaced

_READERS = {".off": read_off, ".obj": read_obj, ".ply": read_ply}  # for each of PLAIN
_LINES = {".off": off_lines, ".obj": obj_lines, ".ply": ply_lines}


def has_blender() -> bool:
    """Return whether Blender is available as a module, or this code runs inside Blender."""
    return "bpy" in sys.modules or find_spec("bpy") is not None


def read_plain(path: Path) -> PolygonMesh:
    """Read a mesh."""
    kind = path.suffix.lower()
    if kind not in PLAIN:
        raise InvalidMeshError(f"{path.name} can only be read by Blender. Without it, use {', '.join(PLAIN)}.")
    require_readable(path)
    try:
        mesh = _READERS[kind](path)
    except InvalidMeshError:
        raise
    except (ArithmeticError, LookupError, TypeError, ValueError) as error:
        raise InvalidMeshError(f"{path.name} is damaged or not a {kind} file.") from error
    polygons = [each for each in mesh.polygons if len(each) > 2]
    if not polygons:
        raise InvalidMeshError(f"{path.name} holds no mesh with faces.")
    if min(map(min, polygons)) < 0 or max(map(max, polygons)) >= len(mesh.vertices):
        raise InvalidMeshError(f"{path.name} has faces with vertices that are not there.")
    return mesh._replace(polygons=polygons)


def write_plain(path: Path, mesh: PolygonMesh, mark: str = "") -> None:
    """Write a mesh; an existing file is replaced when the new one is complete."""
    write_lines(path, _LINES[path.suffix](mesh), mark)


def write_lines(path: Path, lines: list[str], mark: str) -> None:
    """Write a text file that is identical on every system, and replace an existing one when it is complete."""
    text = "\n".join(lines) + "\n"
    replaced(path, lambda partial: partial.write_text(text, encoding="utf-8", newline="\n"), mark)
