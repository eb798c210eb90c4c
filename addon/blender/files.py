"""Opens mesh files in Blender and writes results; a file is replaced only when the new one is complete."""

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
_BONE_SHAPES = "glTF_not_exported"  # collection in which the .glb importer puts the custom shapes of bones
_KINDS = [  # collections of bpy.data that a file may fill
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
    """Open a file in place of the current one and list its mesh objects, each mesh once.

    Parameters
    ----------
    path : Path
        A .blend, .obj, .ply, .stl, .glb or .off file.
    name : str, optional
        Name of the one object wanted.

    Returns
    -------
    list of bpy.types.Object
        The objects, sorted by name.

    Raises
    ------
    InvalidMeshError
        If the file does not exist, has another format, cannot be read or holds no mesh.
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
        reason = str(error).strip()
        if "Traceback" in reason:  # of an importer: its last line is the error
            reason = next((line for line in reversed(reason.splitlines()) if line and line[0] not in " L"), reason)
        raise InvalidMeshError(f"Blender cannot read {path.name}: {reason}") from error
    found: dict[bpy.types.Mesh, bpy.types.Object] = {}
    for obj in sorted(bpy.data.objects, key=lambda each: each.name):
        visible = obj.users_scene and not any(each.name == _BONE_SHAPES for each in obj.users_collection)
        if obj.type == "MESH" and visible and len(obj.data.polygons) and name in (None, obj.name):
            found.setdefault(obj.data, obj)
    if not found:
        raise InvalidMeshError(
            f"{path.name} holds no mesh with faces."
            if name is None
            else f"{path.name} holds no mesh object named {name!r}."
        )
    return list(found.values())


def save_blend(path: Path) -> None:
    """Save the current file as a .blend file.

    Parameters
    ----------
    path : Path
        The file; it is replaced atomically when the new one is complete.
    """
    _replace(path, lambda partial: bpy.ops.wm.save_as_mainfile(filepath=str(partial), copy=True, compress=True))


def save_form(path: Path, vertices: FloatArray, mesh: bpy.types.Mesh) -> None:
    """Write positions with the polygons of a mesh to an .obj or .ply file, in local space and the mesh's order.

    Parameters
    ----------
    path : Path
        The file, ending in .obj or .ply; it is replaced atomically when the new one is complete.
    vertices : (n, 3) ndarray of float
        Positions.
    mesh : bpy.types.Mesh
        The mesh whose polygons are written.

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
    _replace(path, lambda partial: partial.write_text(text))


def _replace(path: Path, write: Callable[[Path], object]) -> None:
    partial = path.with_name(f".{path.stem}.{os.getpid()}.partial{path.suffix}")
    try:
        write(partial)
        partial.replace(path)
    finally:
        partial.unlink(missing_ok=True)


@contextmanager
def _quiet() -> Iterator[None]:
    """Discard what Blender's importers print about a file: they raise errors too."""
    sys.stderr.flush()
    terminals = {number: os.dup(number) for number in (1, 2)}
    try:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        for number in terminals:
            os.dup2(nowhere, number)
        os.close(nowhere)
        yield
    finally:
        _flush()
        for number, terminal in terminals.items():
            os.dup2(terminal, number)
            os.close(terminal)


def _flush() -> None:
    """Flush what Blender has printed so far through the C library, where it can be reached."""
    if sys.platform != "win32":
        import ctypes

        ctypes.CDLL(None).fflush(None)


def _empty() -> None:
    """Remove all data of the open file; loading an empty file instead would disable extensions."""
    fresh = bpy.data.scenes.new("Scene")
    for window in bpy.context.window_manager.windows:
        window.scene = fresh
    old = [scene for scene in bpy.data.scenes if scene != fresh]
    for kind in _KINDS:
        old += list(getattr(bpy.data, kind, []))
    bpy.data.batch_remove(old)
    fresh.name = "Scene"


def _weld(mesh: bpy.types.Mesh) -> None:
    """Merge vertices at identical positions: glTF stores a copy for every normal and texture coordinate."""
    import bmesh

    edited = bmesh.new()
    edited.from_mesh(mesh)
    first: dict[tuple[float, float, float], Any] = {}
    kept = {vertex: first.setdefault(tuple(vertex.co), vertex) for vertex in edited.verts}
    bmesh.ops.weld_verts(edited, targetmap={vertex: target for vertex, target in kept.items() if vertex != target})
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
            _weld(mesh)
    else:
        vertices, polygons = read_off(path)
        mesh = bpy.data.meshes.new(path.stem)
        mesh.from_pydata(np.asarray(vertices).tolist(), [], polygons)
        obj = bpy.data.objects.new(path.stem, mesh)
        bpy.context.scene.collection.objects.link(obj)
