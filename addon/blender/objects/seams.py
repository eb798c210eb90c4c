"""Seams of the base mesh in the evaluated mesh: a Subdivision Surface modifier moves their two sides apart."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
import numpy as np

from ...core.mesh.connectivity import border_labels, component_labels
from ...core.mesh.edges import edge_table

if TYPE_CHECKING:
    from ...core.numerics.arrays import FloatArray, IntArray

_PLACE = ".canonical_form_place"  # an attribute that exists while the mesh is evaluated
_SAME = 1e-5  # of the size of the mesh: closer places are identical
_OPENED = 0.5  # of the longest edge at a seam: largest gap between its two sides


def has_seams(vertices: FloatArray, faces: IntArray) -> bool:
    """Return whether a mesh has coincident borders.

    Parameters
    ----------
    vertices : (n, 3) ndarray of float
        Positions.
    faces : (m, 3) ndarray of int
        Triangles.

    Returns
    -------
    bool
        True if two border vertices have the same position.
    """
    border = vertices[np.flatnonzero(border_labels(faces, edge_table(faces)) >= 0)]
    return len(np.unique(border, axis=0)) < len(border)


def evaluated_places(obj: bpy.types.Object) -> FloatArray | None:
    """Return where the vertices of the evaluated mesh are on the base mesh, if the modifiers keep attributes.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode.

    Returns
    -------
    (n, 3) ndarray of float or None
        Positions on the base mesh, interpolated linearly between its vertices; None if the modifiers drop attributes.
    """
    mesh = obj.data
    points = vertex_places(mesh).ravel()
    attribute = mesh.attributes.new(_PLACE, "FLOAT_VECTOR", "POINT")
    name = attribute.name
    try:
        attribute.data.foreach_set("vector", points)
        mesh.update()
        bpy.context.view_layer.update()
        evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
        shown = evaluated.to_mesh()
        try:
            there = shown.attributes.get(name)
            if there is None or there.domain != "POINT":
                return None
            places = np.empty(3 * len(shown.vertices), dtype=np.float32)
            there.data.foreach_get("vector", places)
        finally:
            evaluated.to_mesh_clear()
    finally:
        mesh.attributes.remove(mesh.attributes[name])
        mesh.update()
        bpy.context.view_layer.update()
    return places.reshape(-1, 3).astype(np.float64)


def vertex_places(mesh: bpy.types.Mesh) -> np.ndarray:
    """Return where the vertices of a mesh are, as `evaluated_places` has them.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh, with its objects in Object Mode, or an evaluated one.

    Returns
    -------
    (n, 3) ndarray of float32
        Positions.
    """
    points = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    mesh.vertices.foreach_get("co", points)
    return points.reshape(-1, 3)


def closed_seams(vertices: FloatArray, faces: IntArray, places: FloatArray, longest: float) -> FloatArray:
    """Close seams by merging the positions of their two sides.

    Parameters
    ----------
    vertices : (n, 3) ndarray of float
        Positions of the evaluated mesh.
    faces : (m, 3) ndarray of int
        Its triangles.
    places : (n, 3) ndarray of float
        Positions of its vertices on the base mesh.
    longest : float
        Length of the longest edge of the base mesh at a border.

    Returns
    -------
    (n, 3) ndarray of float
        Positions; border vertices at the same place of the base mesh, and not far apart, are moved to their mean.
    """
    from scipy.spatial import cKDTree

    border = np.flatnonzero(border_labels(faces, edge_table(faces)) >= 0)
    pairs = cKDTree(places[border]).query_pairs(_SAME * float(np.ptp(places, axis=0).max()), output_type="ndarray")
    apart = np.linalg.norm(vertices[border[pairs[:, 0]]] - vertices[border[pairs[:, 1]]], axis=1)
    label = component_labels(len(border), pairs[apart <= _OPENED * longest])
    count = np.bincount(label)
    closed = vertices.copy()
    closed[border] = np.column_stack([np.bincount(label, vertices[border, axis]) / count for axis in range(3)])[label]
    return closed


def longest_border_edge(vertices: FloatArray, faces: IntArray) -> float:
    """Return the length of the longest border edge.

    Parameters
    ----------
    vertices : (n, 3) ndarray of float
        Positions.
    faces : (m, 3) ndarray of int
        Triangles.

    Returns
    -------
    float
        Its length; 0 without a border.
    """
    edges = edge_table(faces)
    lengths = np.linalg.norm(vertices[edges.tail[edges.alone]] - vertices[edges.head[edges.alone]], axis=1)
    return float(lengths.max(initial=0.0))
