"""Reads and writes Polygon File Format files (.ply)."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np

from ...core import InvalidMeshError
from ...core.numerics.arrays import FloatArray
from .polygon_mesh import PolygonMesh, Polygons, coordinates, counted, decoded, decoded_text, encoded

_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
    "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
    "double": "f8", "float64": "f8",
}  # fmt: skip
_ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">"}
_END = re.compile(rb"end_header[ \t]*(\r\n|\n|\r)")
_MOST_CORNERS = 255  # of a face: their number is one byte, as many readers expect


def read_ply(path: Path) -> PolygonMesh:
    """Read vertices with their colours and polygons of a .ply file, text or binary; everything else is ignored."""
    data = path.read_bytes()
    end = _END.search(data)
    if end is None:
        raise ValueError("no end of the header")
    body = data[end.start(1) + 1 if has_cr_lines(path) else end.end() :]  # where a line feed is its first byte
    header = [line.split() for line in decoded_text(data[: end.start()].replace(b"\r", b"\n")).splitlines()]
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
    colours = _colours(found["vertex"], next(each for name, _, each in elements if name == "vertex"))
    strips = [row.get("vertex_indices", row.get("vertex_index")) for row in found.get("tristrips", [])]
    lists = [row.get("vertex_indices", row.get("vertex_index")) for row in found.get("face", [])]
    polygons = [[int(each) for each in row or ()] for row in lists]
    polygons += [triangle for strip in strips for triangle in _triangles([int(each) for each in strip or ()])]
    return PolygonMesh(np.array(points, dtype=np.float64).reshape(-1, 3), polygons, colours=colours)


def has_cr_lines(path: Path) -> bool:
    """Return whether the lines of a .ply header end with CR alone."""
    with path.open("rb") as file:
        head = file.read(5)
    return head[3:4] == b"\r" and head[4:5] != b"\n"


def ply_lines(mesh: PolygonMesh) -> list[str]:
    """List the lines of a .ply file: vertices with their colours, and polygons."""
    most = max(map(len, mesh.polygons))
    if most > _MOST_CORNERS:
        raise InvalidMeshError(
            f"The mesh has a face of {most} corners, and .ply holds {_MOST_CORNERS}. Write .obj instead."
        )
    points, channels = coordinates(mesh.vertices), []
    if mesh.colours is not None:
        channels = ["property uchar red", "property uchar green", "property uchar blue"]
        colours = np.round(255 * encoded(mesh.colours[:, :3])).astype(int).tolist()
        points = [f"{point} {red} {green} {blue}" for point, (red, green, blue) in zip(points, colours, strict=True)]
    return [
        "ply",
        "format ascii 1.0",
        f"element vertex {len(points)}",
        *(f"property double {axis}" for axis in "xyz"),
        *channels,
        f"element face {len(mesh.polygons)}",
        "property list uchar int vertex_indices",
        "end_header",
        *points,
        *counted(mesh.polygons),
    ]


def _triangles(strip: list[int]) -> Polygons:
    """Cut strips of triangles, which -1 ends, into triangles: every second one is the other way round."""
    found, start = [], 0
    for at, corner in enumerate(strip):
        if corner == -1:
            start = at + 1
        elif at - start >= 2:
            one, other = strip[at - 2], strip[at - 1]
            found.append([one, other, corner] if (at - start) % 2 == 0 else [other, one, corner])
    return found


def _colours(rows: list[dict[str, Any]], properties: list[list[str]]) -> FloatArray | None:
    """Return the colours of the vertices, whole numbers up to 255 or shares of 1; None if they have none."""
    kinds = {words[-1]: words[0] for words in properties}
    if not rows or not {"red", "green", "blue"} <= kinds.keys():
        return None
    values = np.array([[row["red"], row["green"], row["blue"]] for row in rows], dtype=np.float64)
    kind = _TYPES[kinds["red"]]
    return decoded(values if kind[0] == "f" else values / (255 if kind == "u1" else np.iinfo(kind).max))


def _length(value: Any) -> int:
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
            return [float(self._next()) for _ in range(_length(self._next()))]
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
            return self._read(words[2], _length(self._read(words[1], 1)[0]))
        return self._read(words[0], 1)[0]
