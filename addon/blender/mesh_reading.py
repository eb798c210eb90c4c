"""Reads the active mesh as arrays, or says why it cannot be used."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
import numpy as np

if TYPE_CHECKING:
    from ..core.surface import FloatArray, IntArray


def refusal(obj: bpy.types.Object | None) -> str | None:
    """Say why an object cannot be given a canonical form, before anything is read or computed.

    Parameters
    ----------
    obj : bpy.types.Object or None
        The object, usually the active one.

    Returns
    -------
    str or None
        A sentence that says what to do, or None if the object can be used.
    """
    if obj is None:
        return "Select a mesh object first."
    if obj.type != "MESH":
        return f"{obj.name} is not a mesh. Convert it first (Object > Convert > Mesh)."
    mesh = obj.data
    if obj.library is not None or mesh.library is not None or mesh.override_library is not None:
        return f"{mesh.name} is linked from another file. Make it local first (Object > Relations > Make Local)."
    if not mesh.is_editable:
        return f"{mesh.name} cannot be edited. Make it local first (Object > Relations > Make Local)."
    keys = mesh.shape_keys
    if keys is not None and not keys.use_relative:
        return f"The shape keys of {mesh.name} are absolute. Tick Relative in the Shape Keys panel first."
    if obj.mode != "OBJECT" and obj != bpy.context.view_layer.objects.active:
        return f"{obj.name} is not the active object. Make it active, or leave its mode, and run again."
    if obj.mode != "EDIT" and mesh.is_editmode:
        return f"{mesh.name} is being edited through another object. Leave Edit Mode there first."
    if obj.mode == "OBJECT" and not mesh.polygons:  # in Edit Mode the mesh may not know its faces yet
        return f"{mesh.name} has no faces. Choose a mesh with a surface."
    return None


def read_mesh(mesh: bpy.types.Mesh) -> tuple[FloatArray, IntArray]:
    """Read the rest shape of a mesh: the Basis where there are shape keys, n-gons as triangles.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh, with its object in Object Mode.

    Returns
    -------
    vertices : (n, 3) ndarray of float
        Positions in the mesh's own space.
    faces : (m, 3) ndarray of int
        Triangles.
    """
    points = mesh.vertices if mesh.shape_keys is None else mesh.shape_keys.reference_key.data
    vertices = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    points.foreach_get("co", vertices)
    mesh.calc_loop_triangles()
    faces = np.empty(3 * len(mesh.loop_triangles), dtype=np.int32)
    mesh.loop_triangles.foreach_get("vertices", faces)
    return vertices.reshape(-1, 3).astype(np.float64), faces.reshape(-1, 3).astype(np.int64)
