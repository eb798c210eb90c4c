"""Reads and writes Wavefront files (.obj)."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from .polygon_mesh import PolygonMesh, Polygons, coordinates, decoded, decoded_text, encoded

_CONTINUED = re.compile(r"\\\r?\n")  # a line that goes on in the next


def read_obj(path: Path) -> PolygonMesh:
    """Read the vertices with their colours and the polygons of an .obj file; everything else is ignored."""
    vertices: list[list[float]] = []
    colours: list[list[float]] = []
    polygons: Polygons = []
    text = _CONTINUED.sub(" ", decoded_text(path.read_bytes()))
    for line in text.splitlines():
        words = line.split("#", 1)[0].split()
        if not words:
            continue
        if words[0] == "v":
            if "," in line and "." not in line:  # decimal commas
                words = [word.replace(",", ".") for word in words]
            vertices.append([float(word) for word in words[1:4]])
            colours.append([float(word) for word in words[4:7]])
        elif words[0] == "f":
            corners = [int(float(word.split("/")[0])) for word in words[1:]]
            polygons.append([corner - 1 if corner >= 0 else len(vertices) + corner for corner in corners])
    if min((corner for corners in polygons for corner in corners), default=0) == -1:  # they count from 0
        polygons = [[corner + 1 for corner in corners] for corners in polygons]
    coloured = bool(colours) and all(len(each) == 3 for each in colours)
    shades = np.array(colours) if coloured else np.zeros((0, 3))
    shades = shades / 255 if shades.max(initial=0.0) > 1 else shades
    return PolygonMesh(
        np.array(vertices, dtype=np.float64).reshape(-1, 3),
        polygons,
        colours=decoded(shades) if coloured else None,
    )


def obj_lines(mesh: PolygonMesh) -> list[str]:
    """List the lines of an .obj file: vertices with colours, UV coordinates, polygons with groups and materials."""
    lines = [f"mtllib {mesh.library}"] if mesh.library else []
    points = coordinates(mesh.vertices)
    if mesh.colours is not None:
        points = [" ".join(each) for each in zip(points, coordinates(encoded(mesh.colours[:, :3])), strict=True)]
    lines += [f"v {point}" for point in points]
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
