"""Files that Blender's importers misread without a word: read here, or refused by name."""

from __future__ import annotations

import codecs
import re
from pathlib import Path

import numpy as np

from ...core import InvalidMeshError
from .obj_format import read_obj
from .ply_format import has_cr_lines, read_ply
from .polygon_mesh import PolygonMesh

_HEAD, _TRIANGLE = 84, 50  # bytes of a binary .stl: before its triangles, and of each
_COMMAS = re.compile(rb"^v[ \t]+[-+\d]+,\d", re.MULTILINE)
_FROM_ZERO = re.compile(rb"^f[ \t][^#\r\n]*?(?<=[ \t])0+(?=[/ \t\r\n]|$)", re.MULTILINE)
_MORE = re.compile(rb"^(vt|usemtl)[ \t]", re.MULTILINE)


def read_instead(path: Path) -> PolygonMesh | None:
    """Read a file that Blender would misread.

    Parameters
    ----------
    path : Path
        A file of any kind.

    Returns
    -------
    PolygonMesh or None
        The mesh; None if Blender reads the file as it is meant.

    Raises
    ------
    InvalidMeshError
        If Blender would misread it, and it holds more than is read here; the message says what to do.
    """
    kind = path.suffix.lower()
    if kind == ".stl":
        return _read_long_stl(path)
    if kind == ".ply":
        return read_ply(path) if has_cr_lines(path) else None
    if kind != ".obj":
        return None
    data = path.read_bytes()
    reason = _misread(data)
    if not reason:
        return None
    if _MORE.search(data.replace(b"\0", b"")):
        raise InvalidMeshError(f"{path.name} {reason}, which Blender misreads. Export it again as plain .obj.")
    return read_obj(path)


def _misread(data: bytes) -> str:
    """Say what Blender misreads in an .obj file; empty if nothing."""
    if data[:2] in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE):
        return "is encoded as UTF-16"
    if data.startswith(codecs.BOM_UTF8) and data[3:4] not in (b"#", b"\n", b"\r"):  # only the first line is misread
        return "begins with a byte-order mark"
    if _COMMAS.search(data):
        return "has decimal commas"
    return "counts its vertices from 0" if _FROM_ZERO.search(data) else ""


def _read_long_stl(path: Path) -> PolygonMesh | None:
    """Read a binary .stl that has bytes after its triangles."""
    size = path.stat().st_size
    with path.open("rb") as file:
        head = file.read(_HEAD)
        count = int.from_bytes(head[80:], "little")
        if len(head) < _HEAD or size <= _HEAD + _TRIANGLE * count or not count or b"facet" in file.read(512):
            return None
        file.seek(_HEAD)
        triangles = np.frombuffer(file.read(_TRIANGLE * count), dtype=np.uint8).reshape(count, _TRIANGLE)
    corners = triangles[:, 12:48].copy().view("<f4").reshape(-1, 3).astype(np.float64)
    vertices, number = np.unique(corners, axis=0, return_inverse=True)
    return PolygonMesh(vertices, number.reshape(-1, 3).tolist())
