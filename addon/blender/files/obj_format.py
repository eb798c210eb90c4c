"""Reads and writes Wavefront files (.obj)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from .polygon_mesh import PolygonMesh, Polygons, coordinates


def read_obj(path: Path) -> PolygonMesh:
    """Read the vertices and polygons of an .obj file; everything else is ignored."""
    vertices: list[list[float]] = []
    polygons: Polygons = []
    for line in path.read_text(encoding="utf-8", errors="replace").replace("\\\n", " ").splitlines():
        words = line.split()
        if not words:
            continue
        if words[0] == "v":
            vertices.append([float(word) for word in words[1:4]])
        elif words[0] == "f":
            corners = [int(word.split("/")[0]) for word in words[1:]]
            polygons.append([corner - 1 if corner > 0 else len(vertices) + corner for corner in corners])
    return PolygonMesh(np.array(vertices, dtype=np.float64).reshape(-1, 3), polygons)


def obj_lines(mesh: PolygonMesh) -> list[str]:
    """List the lines of an .obj file: vertices, UV coordinates, polygons with their patches as groups and materials."""
    lines = [f"mtllib {mesh.library}"] if mesh.library else []
    lines += [f"v {point}" for point in coordinates(mesh.vertices)]
    corner_uv: list[int] | None = None
    if mesh.corner_uv is not None:
        places, number = np.unique(mesh.corner_uv, axis=0, return_inverse=True)
        lines += [f"vt {place}" for place in coordinates(places)]
        corner_uv = (number.ravel() + 1).tolist()
    patches = None if mesh.patches is None else mesh.patches.tolist()
    group, material, start = None, "", 0
    for index, corners in enumerate(mesh.polygons):
        own = None if patches is None else max(patches[corner] for corner in corners)
        if own is not None and own != group:
            group = own
            lines.append(f"g Patch_{own + 1}" if own >= 0 else "g")
        slot = mesh.slots[index] if len(mesh.slots) else 0
        called = mesh.materials[slot] if slot < len(mesh.materials) else ""
        if called != material:
            material = called
            lines.append(f"usemtl {word(called)}" if called else "usemtl ")  # as Blender ends a material
        if corner_uv is None:
            lines.append("f " + " ".join(str(corner + 1) for corner in corners))
        else:
            uvs = corner_uv[start : start + len(corners)]
            lines.append("f " + " ".join(f"{corner + 1}/{uv}" for corner, uv in zip(corners, uvs, strict=True)))
        start += len(corners)
    return lines


def word(name: str) -> str:
    """Replace spaces in a name, as they end a name in .obj.

    Examples
    --------
    >>> word("Paper label")
    'Paper_label'
    """
    return "_".join(name.split()) or "_"
