"""Opens mesh files in Blender and writes results, beside and renamed."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from ..core import InvalidMeshError
from ..core.numerics.arrays import FloatArray
from .off_format import read_off

SUFFIXES = (".blend", ".obj", ".ply", ".stl", ".glb", ".off")
_BONE_SHAPES = "glTF_not_exported"  # where the importer of .glb puts what it draws bones with
_KINDS = [  # what a file may have brought into Blender
    "actions",
    "armatures",
    "cache_files",
    "cameras",
    "collections",
    "curves",
    "grease_pencils",
    "hair_curves",
    "images",
    "lattices",
    "lightprobes",
    "lights",
    "linestyles",
    "masks",
    "materials",
    "meshes",
    "metaballs",
    "movieclips",
    "node_groups",
    "objects",
    "paint_curves",
    "palettes",
    "particles",
    "pointclouds",
    "sounds",
    "speakers",
    "texts",
    "textures",
    "volumes",
    "worlds",
]


def open_meshes(path: Path, name: str | None = None) -> list[bpy.types.Object]:
    """Open a file in place of what Blender holds and list its mesh objects, each mesh once.

    Parameters
    ----------
    path : Path
        A .blend, .obj, .ply, .stl, .glb or .off file.
    name : str, optional
        Name of the one object wanted.

    Returns
    -------
    list of bpy.types.Object
        The objects, in the order of their names.

    Raises
    ------
    InvalidMeshError
        If the file is not there, is of another kind, cannot be read or holds no mesh.
    """
    if path.suffix.lower() not in SUFFIXES:
        raise InvalidMeshError(f"{path.name} is not of a kind that can be read: {', '.join(SUFFIXES)}.")
    if not path.is_file():
        raise InvalidMeshError(f"{path} is not a file.")
    try:
        with _quiet():
            if path.suffix.lower() == ".blend":
                bpy.ops.wm.open_mainfile(filepath=str(path), load_ui=False)
            else:
                _empty()
                _import(path)
    except RuntimeError as error:
        told = str(error).strip()
        if "Traceback" in told:  # of an importer; what it says last is what happened
            told = next((line for line in reversed(told.splitlines()) if line and line[0] not in " L"), told)
        raise InvalidMeshError(f"Blender cannot read {path.name}: {told}") from error
    found: dict[bpy.types.Mesh, bpy.types.Object] = {}
    for obj in sorted(bpy.data.objects, key=lambda each: each.name):
        shown = obj.users_scene and not any(each.name == _BONE_SHAPES for each in obj.users_collection)
        if obj.type == "MESH" and shown and len(obj.data.polygons) and name in (None, obj.name):
            found.setdefault(obj.data, obj)
    if not found:
        raise InvalidMeshError(
            f"{path.name} holds no mesh with faces."
            if name is None
            else f"{path.name} holds no mesh object named {name!r}."
        )
    return list(found.values())


def save_blend(path: Path) -> None:
    """Save all that Blender holds to a .blend file.

    Parameters
    ----------
    path : Path
        The file; it is replaced in one step when the new one is whole.
    """
    _replace(path, lambda beside: bpy.ops.wm.save_as_mainfile(filepath=str(beside), copy=True, compress=True))


def save_form(path: Path, vertices: FloatArray, mesh: bpy.types.Mesh) -> None:
    """Write positions and the mesh's own polygons to an .obj or .ply file, in the mesh's own space and order.

    Parameters
    ----------
    path : Path
        The file, ending in .obj or .ply; it is replaced in one step when the new one is whole.
    vertices : (n, 3) ndarray of float
        Positions.
    mesh : bpy.types.Mesh
        The mesh that the polygons are read from.

    Raises
    ------
    InvalidMeshError
        If the format cannot hold the mesh.
    """
    polygons = [list(polygon.vertices) for polygon in mesh.polygons]
    most = max(map(len, polygons))
    if path.suffix == ".ply" and most > 255:
        raise InvalidMeshError(f"{mesh.name} has a face of {most} corners, and .ply holds 255. Write .obj instead.")
    if path.suffix == ".obj":
        lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in vertices.tolist()]
        lines += ["f " + " ".join(str(corner + 1) for corner in corners) for corners in polygons]
    else:
        lines = ["ply", "format ascii 1.0", f"element vertex {len(vertices)}"]
        lines += ["property double x", "property double y", "property double z"]
        lines += [f"element face {len(polygons)}", "property list uchar int vertex_indices", "end_header"]
        lines += [f"{x:.9g} {y:.9g} {z:.9g}" for x, y, z in vertices.tolist()]
        lines += [f"{len(corners)} " + " ".join(map(str, corners)) for corners in polygons]
    text = "\n".join(lines) + "\n"
    _replace(path, lambda beside: beside.write_text(text))


def _replace(path: Path, write: Callable[[Path], object]) -> None:
    beside = path.with_name(f".{path.stem}.{os.getpid()}.partial{path.suffix}")
    try:
        write(beside)
        beside.replace(path)
    finally:
        beside.unlink(missing_ok=True)


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep what Blender's importers print about a file off the terminal: errors come as errors too."""
    sys.stderr.flush()
    kept = {number: os.dup(number) for number in (1, 2)}
    try:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        for number in kept:
            os.dup2(nowhere, number)
        os.close(nowhere)
        yield
    finally:
        _flush()
        for number, terminal in kept.items():
            os.dup2(terminal, number)
            os.close(terminal)


def _flush() -> None:
    """Write out what Blender has printed so far, where its C library can be asked to."""
    if sys.platform != "win32":
        import ctypes

        ctypes.CDLL(None).fflush(None)


def _empty() -> None:
    """Drop all data of the open file; loading an empty file instead would switch extensions off."""
    fresh = bpy.data.scenes.new("Scene")
    for window in bpy.context.window_manager.windows:
        window.scene = fresh
    old = [scene for scene in bpy.data.scenes if scene != fresh]
    for kind in _KINDS:
        old += list(getattr(bpy.data, kind, []))
    bpy.data.batch_remove(old)
    fresh.name = "Scene"


def _welded(mesh: bpy.types.Mesh) -> None:
    """Join vertices at one and the same place: glTF keeps a copy for every normal and texture coordinate."""
    import bmesh

    edited = bmesh.new()
    edited.from_mesh(mesh)
    first: dict[tuple[float, float, float], Any] = {}
    twins = {vertex: first.setdefault(tuple(vertex.co), vertex) for vertex in edited.verts}
    bmesh.ops.weld_verts(edited, targetmap={vertex: kept for vertex, kept in twins.items() if vertex != kept})
    edited.to_mesh(mesh)
    edited.free()


def _import(path: Path) -> None:
    name = str(path)
    kind = path.suffix.lower()
    if kind == ".obj":
        bpy.ops.wm.obj_import(filepath=name)
    elif kind == ".ply":
        bpy.ops.wm.ply_import(filepath=name)
    elif kind == ".stl":
        bpy.ops.wm.stl_import(filepath=name)
    elif kind == ".glb":
        bpy.ops.import_scene.gltf(filepath=name)
        for mesh in bpy.data.meshes:
            _welded(mesh)
    else:
        vertices, polygons = read_off(path)
        mesh = bpy.data.meshes.new(path.stem)
        mesh.from_pydata(np.asarray(vertices).tolist(), [], polygons)
        obj = bpy.data.objects.new(path.stem, mesh)
        bpy.context.scene.collection.objects.link(obj)
