"""Reads and writes Object File Format files (.off), which Blender does not."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import numpy as np

from ...core import InvalidMeshError
from .polygon_mesh import PolygonMesh, Polygons, coordinates, counted

_HEADS = {"".join(parts) for parts in product(("", "ST"), ("", "C"), ("", "N"), ("OFF",))}  # 4OFF, nOFF: not 3D


def read_off(path: Path) -> PolygonMesh:
    """Read the vertices and polygons of an .off file; colours and normals are ignored."""
    lines = [line.split("#", 1)[0].split() for line in path.read_text(encoding="utf-8", errors="replace").splitlines()]
    lines = [words for words in lines if words]
    if not lines or not lines[0][0].endswith("OFF"):
        raise InvalidMeshError(f"{path.name} does not start with OFF.")
    if lines[0][0] not in _HEADS:
        raise InvalidMeshError(f"{path.name} is of a kind that is not read ({lines[0][0]}). Save it as plain OFF.")
    first = lines[0][1:] if len(lines[0]) > 1 else lines[1] if len(lines) > 1 else []
    body = lines[1:] if len(lines[0]) > 1 else lines[2:]
    try:
        vertex_count, face_count = int(first[0]), int(first[1])
        if len(body) < vertex_count + face_count or min(vertex_count, face_count) < 0:
            raise InvalidMeshError(
                f"{path.name} announces {vertex_count} vertices and {face_count} faces but holds {len(body)} lines. "
                "It may be cut short."
            )
        if any(len(words) < 3 for words in body[:vertex_count]):
            raise InvalidMeshError(f"{path.name} has a vertex with less than three coordinates.")
        vertices = np.array([words[:3] for words in body[:vertex_count]], dtype=np.float64).reshape(-1, 3)
        polygons: Polygons = []
        for words in body[vertex_count : vertex_count + face_count]:
            corners = [int(word) for word in words[1 : 1 + int(words[0])]]
            if len(corners) != int(words[0]) or min(corners) < 0 or max(corners) >= vertex_count:
                raise InvalidMeshError(f"{path.name} has a face with corners that are not there: {' '.join(words)}.")
            polygons.append(corners)
    except (ValueError, IndexError) as error:
        raise InvalidMeshError(f"{path.name} is not a well-formed .off file ({error}).") from error
    return PolygonMesh(vertices, polygons)


def off_lines(mesh: PolygonMesh) -> list[str]:
    """List the lines of an .off file: vertices and polygons."""
    counts = f"{len(mesh.vertices)} {len(mesh.polygons)} 0"
    return ["OFF", counts, *coordinates(mesh.vertices), *counted(mesh.polygons)]
