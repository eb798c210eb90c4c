"""Reads and writes meshes without Blender: positions and polygons of .off, .obj and .ply files."""

from __future__ import annotations

import sys
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from ..blender.files.file_access import require_readable
from ..blender.files.kinds_of_files import PLAIN
from ..blender.files.off_format import read_off
from ..blender.files.replacing_files import replaced
from ..core.numerics.arrays import FloatArray, IntArray
from ..core.run.errors import InvalidMeshError

_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
    "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
    "double": "f8", "float64": "f8",
}  # fmt: skip
_ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">"}


def has_blender() -> bool:
    """Return whether Blender is available as a module, or this code runs inside Blender.

    Returns
    -------
    bool
        True if ``import bpy`` works.
    """
    return "bpy" in sys.modules or find_spec("bpy") is not None


def read_plain(path: Path) -> tuple[FloatArray, list[list[int]]]:
    """Read a mesh.

    Parameters
    ----------
    path : Path
        A .off, .obj or .ply file.

    Returns
    -------
    vertices : (n, 3) ndarray of float
        Positions.
    polygons : list of list of int
        Corners of each polygon.

    Raises
    ------
    InvalidMeshError
        If the file is of another kind or damaged.
    """
    kind = path.suffix.lower()
    if kind not in PLAIN:
        raise InvalidMeshError(f"{path.name} can only be read by Blender. Without it, use {', '.join(PLAIN)}.")
    require_readable(path)
    try:
        vertices, polygons = _READERS[kind](path)
    except InvalidMeshError:
        raise
    except (ArithmeticError, LookupError, TypeError, ValueError) as error:
        raise InvalidMeshError(f"{path.name} is damaged or not a {kind} file.") from error
    polygons = [each for each in polygons if len(each) > 2]
    if not polygons:
        raise InvalidMeshError(f"{path.name} holds no mesh with faces.")
    if min(map(min, polygons)) < 0 or max(map(max, polygons)) >= len(vertices):
        raise InvalidMeshError(f"{path.name} has faces with vertices that are not there.")
    return vertices, polygons


def fans(polygons: list[list[int]]) -> IntArray:
    """Triangulate polygons as fans around their first corners.

    Parameters
    ----------
    polygons : list of list of int
        Corners of each polygon.

    Returns
    -------
    (m, 3) ndarray of int
        Triangles.

    Examples
    --------
    >>> fans([[0, 1, 2, 3], [3, 2, 4]]).tolist()
    [[0, 1, 2], [0, 2, 3], [3, 2, 4]]
    """
    corners = [[each[0], one, two] for each in polygons for one, two in pairwise(each[1:])]
    return np.array(corners, dtype=np.int64).reshape(-1, 3)


def write_plain(path: Path, vertices: FloatArray, polygons: list[list[int]], mark: str) -> None:
    """Write a mesh; an existing file is replaced when the new one is complete.

    Parameters
    ----------
    path : Path
        A .off, .obj or .ply file.
    vertices : (n, 3) ndarray of float
        Positions.
    polygons : list of list of int
        Corners of each polygon.
    mark : str
        Distinguishes temporary files of one run from those of others.
    """
    points = [f"{x:.9g} {y:.9g} {z:.9g}" for x, y, z in vertices.tolist()]
    lines = _LINES[path.suffix](points, polygons)
    replaced(path, lambda partial: partial.write_text("\n".join(lines) + "\n", encoding="utf-8", newline="\n"), mark)


def _obj_lines(points: list[str], polygons: list[list[int]]) -> list[str]:
    """List the lines of an .obj file."""
    return [
        *(f"v {point}" for point in points),
        *("f " + " ".join(str(corner + 1) for corner in each) for each in polygons),
    ]


def _off_lines(points: list[str], polygons: list[list[int]]) -> list[str]:
    """List the lines of an .off file."""
    return ["OFF", f"{len(points)} {len(polygons)} 0", *_with_counts(points, polygons)]


def _ply_lines(points: list[str], polygons: list[list[int]]) -> list[str]:
    """List the lines of a .ply file."""
    return [
        "ply",
        "format ascii 1.0",
        f"element vertex {len(points)}",
        *(f"property double {axis}" for axis in "xyz"),
        f"element face {len(polygons)}",
        "property list uint int vertex_indices",
        "end_header",
        *_with_counts(points, polygons),
    ]


def _with_counts(points: list[str], polygons: list[list[int]]) -> list[str]:
    """List points, and polygons after their numbers of corners."""
    return [*points, *(f"{len(each)} " + " ".join(map(str, each)) for each in polygons)]


def _read_obj(path: Path) -> tuple[FloatArray, list[list[int]]]:
    """Read the v and f lines of an .obj file."""
    vertices: list[list[float]] = []
    polygons: list[list[int]] = []
    for line in path.read_text(encoding="utf-8", errors="replace").replace("\\\n", " ").splitlines():
        words = line.split()
        if not words:
            continue
        if words[0] == "v":
            vertices.append([float(word) for word in words[1:4]])
        elif words[0] == "f":
            corners = [int(word.split("/")[0]) for word in words[1:]]
            polygons.append([corner - 1 if corner > 0 else len(vertices) + corner for corner in corners])
    return np.array(vertices, dtype=np.float64).reshape(-1, 3), polygons


def _read_ply(path: Path) -> tuple[FloatArray, list[list[int]]]:
    """Read the vertices and faces of a .ply file, text or binary."""
    data = path.read_bytes()
    end = data.index(b"end_header")
    body = data[data.index(b"\n", end) + 1 :]
    header = [line.split() for line in data[:end].decode("ascii").splitlines()]
    if header[0] != ["ply"]:
        raise ValueError("not a .ply file")
    formats = [words[1] for words in header if words[:1] == ["format"]]
    if len(formats) != 1:
        raise ValueError("no format")
    order = _ORDERS.get(formats[0])
    elements: list[tuple[str, int, list[list[str]]]] = []
    for words in header:
        if words[:1] == ["element"]:
            elements.append((words[1], int(words[2]), []))
        elif words[:1] == ["property"]:
            elements[-1][2].append(words[1:])
    reader = _Text(body) if order is None else _Binary(body, order)
    found: dict[str, list[dict[str, Any]]] = {}
    for name, count, properties in elements:
        if count < 0 or count * min(len(properties), 1) > len(body):  # every value needs at least a byte
            raise ValueError("cut short")
        found[name] = [
            {words[-1]: reader.value(words) for words in properties} for _ in range(count if properties else 0)
        ]
    points = [[row["x"], row["y"], row["z"]] for row in found["vertex"]]
    lists = [row.get("vertex_indices", row.get("vertex_index")) for row in found.get("face", [])]
    return np.array(points, dtype=np.float64).reshape(-1, 3), [[int(each) for each in row or ()] for row in lists]


def _counted(value: Any) -> int:
    """Convert the length of a list."""
    count = int(value)
    if count < 0:
        raise ValueError("negative list length")
    return count


class _Text:
    """The words of a .ply text file."""

    def __init__(self, body: bytes) -> None:
        self._words = iter(body.split())

    def _next(self) -> bytes:
        word = next(self._words, None)
        if word is None:
            raise ValueError("cut short")
        return word

    def value(self, words: list[str]) -> Any:
        if words[0] == "list":
            return [float(self._next()) for _ in range(_counted(self._next()))]
        return float(self._next())


class _Binary:
    """The bytes of a binary .ply file."""

    def __init__(self, body: bytes, order: str) -> None:
        self._body, self._order, self._at = body, order, 0

    def _read(self, kind: str, count: int) -> list[Any]:
        form = np.dtype(self._order + _TYPES[kind])
        values = np.frombuffer(self._body, form, count, self._at)
        self._at += form.itemsize * count
        return list(values.tolist())

    def value(self, words: list[str]) -> Any:
        if words[0] == "list":
            return self._read(words[2], _counted(self._read(words[1], 1)[0]))
        return self._read(words[0], 1)[0]


_READERS = {".off": read_off, ".obj": _read_obj, ".ply": _read_ply}  # for each of PLAIN
_LINES = {".off": _off_lines, ".obj": _obj_lines, ".ply": _ply_lines}
