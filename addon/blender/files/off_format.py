"""Reads the Object File Format (.off), which Blender does not import."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import numpy as np

from ...core import InvalidMeshError
from ...core.numerics.arrays import FloatArray

_HEADS = {"".join(parts) for parts in product(("", "ST"), ("", "C"), ("", "N"), ("OFF",))}  # 4OFF, nOFF: not 3D


def read_off(path: Path) -> tuple[FloatArray, list[list[int]]]:
    """Read the vertices and polygons of an .off file; colours and normals are ignored.

    Parameters
    ----------
    path : Path
        The file.

    Returns
    -------
    vertices : (n, 3) ndarray of float
        Positions.
    polygons : list of list of int
        Vertex indices of every polygon.

    Raises
    ------
    InvalidMeshError
        If the file is not in that format; the message describes the error.
    """
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
        polygons = []
        for words in body[vertex_count : vertex_count + face_count]:
            corners = [int(word) for word in words[1 : 1 + int(words[0])]]
            if len(corners) != int(words[0]) or min(corners) < 0 or max(corners) >= vertex_count:
                raise InvalidMeshError(f"{path.name} has a face with corners that are not there: {' '.join(words)}.")
            polygons.append(corners)
    except (ValueError, IndexError) as error:
        raise InvalidMeshError(f"{path.name} is not a well-formed .off file ({error}).") from error
    return vertices, polygons
