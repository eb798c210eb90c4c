"""Reads and writes Object File Format files (.off), which Blender does not."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from ...core import InvalidMeshError
from .polygon_mesh import PolygonMesh, Polygons, coordinates, counted, decoded_text

_HEAD = re.compile(r"((?:ST)?C?N?)(4?n?)(?i:OFF)(\d*)")  # some files have no space before the first count


def read_off(path: Path) -> PolygonMesh:
    """Read the vertices and polygons of an .off file; colours and normals are ignored."""
    lines = [line.split("#", 1)[0].split() for line in decoded_text(path.read_bytes()).splitlines()]
    body = _without_head(path, [words for words in lines if words])
    try:
        if not body or len(body[0]) not in (2, 3):  # a line a number, or many on a line
            return _read_words(path, [word for words in body for word in words])
        vertex_count, face_count = int(body[0][0]), int(body[0][1])
        rows = body[1:]
        short = any(len(words) < 3 for words in rows[: max(vertex_count, 0)])
        if short or min(vertex_count, face_count) < 0 or len(rows) < vertex_count + face_count:
            try:
                return _read_words(path, [word for words in body for word in words])
            except InvalidMeshError as error:
                if short and len(rows) >= vertex_count + face_count:
                    raise InvalidMeshError(f"{path.name} has a vertex with less than three coordinates.") from error
                raise
        vertices = np.array([words[:3] for words in rows[:vertex_count]], dtype=np.float64).reshape(-1, 3)
        polygons: Polygons = []
        for words in rows[vertex_count : vertex_count + face_count]:
            corners = [int(word) for word in words[1 : 1 + int(words[0])]]
            if len(corners) != int(words[0]):
                raise InvalidMeshError(f"{path.name} has a face with corners that are not there: {' '.join(words)}.")
            polygons.append(corners)
    except (ValueError, IndexError) as error:
        raise InvalidMeshError(f"{path.name} is not a well-formed .off file ({error}).") from error
    _require_corners(path, polygons, vertex_count)
    return PolygonMesh(vertices, polygons)


def _without_head(path: Path, lines: list[list[str]]) -> list[list[str]]:
    """Return the lines after the word OFF, which some files leave out."""
    head = _HEAD.fullmatch(lines[0][0]) if lines else None
    if head is None:
        if lines and len(lines[0]) == 3 and all(word.isdigit() for word in lines[0]):
            return lines
        raise InvalidMeshError(f"{path.name} does not start with OFF.")
    if head.group(2) or lines[0][1:] == ["BINARY"]:  # four or n dimensions
        raise InvalidMeshError(
            f"{path.name} is of a kind that is not read ({' '.join(lines[0])}). Save it as plain OFF."
        )
    rest = [head.group(3), *lines[0][1:]] if head.group(3) else lines[0][1:]
    return [rest, *lines[1:]] if rest else lines[1:]


def _read_words(path: Path, words: list[str]) -> PolygonMesh:
    """Read a file whose lines do not hold a vertex or a face each, without further values of these."""
    vertex_count, face_count, at = int(words[0]), int(words[1]), 3
    numbers = words[at : at + 3 * max(vertex_count, 0)]
    at += len(numbers)
    polygons: Polygons = []
    while len(polygons) < face_count and at < len(words):
        count = int(words[at])
        polygons.append([int(word) for word in words[at + 1 : at + 1 + max(count, 0)]])
        at += 1 + max(count, 0)
    short = len(numbers) < 3 * vertex_count or len(polygons) < face_count or at > len(words)
    if short or min(vertex_count, face_count) < 0:
        raise InvalidMeshError(
            f"{path.name} announces {vertex_count} vertices and {face_count} faces but does not hold them. "
            "It may be cut short."
        )
    _require_corners(path, polygons, vertex_count)
    return PolygonMesh(np.array(numbers, dtype=np.float64).reshape(-1, 3), polygons)


def _require_corners(path: Path, polygons: Polygons, vertex_count: int) -> None:
    """Reject faces with corners that do not exist."""
    for corners in polygons:
        if not corners:
            raise InvalidMeshError(f"{path.name} is not a well-formed .off file (a face without corners).")
        if min(corners) < 0 or max(corners) >= vertex_count:
            raise InvalidMeshError(
                f"{path.name} has a face with corners that are not there: {len(corners)} {' '.join(map(str, corners))}."
            )


def off_lines(mesh: PolygonMesh) -> list[str]:
    """List the lines of an .off file: vertices and polygons."""
    counts = f"{len(mesh.vertices)} {len(mesh.polygons)} 0"
    return ["OFF", counts, *coordinates(mesh.vertices), *counted(mesh.polygons)]
