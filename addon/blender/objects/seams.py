"""Seams of the base mesh in what modifiers make of it: Subdivision Surface draws their two sides apart."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
import numpy as np

from ...core.mesh.connectivity import border_labels, component_labels, edge_table

if TYPE_CHECKING:
    from ...core.numerics.arrays import FloatArray, IntArray

_PLACE = ".canonical_form_place"  # an attribute, there while the mesh is evaluated
_SAME = 1e-5  # of the size of the mesh: places nearer than this are one
_OPENED = 0.5  # of the longest edge at a seam: how far its two sides may come apart


def has_seams(vertices: FloatArray, faces: IntArray) -> bool:
    """Return whether borders of a mesh coincide.

    Parameters
    ----------
    vertices : (n, 3) ndarray of float
        Positions.
    faces : (m, 3) ndarray of int
        Triangles.

    Returns
    -------
    bool
        True if two vertices at borders have the same position.
    """
    border = vertices[np.flatnonzero(border_labels(faces, edge_table(faces)) >= 0)]
    return len(np.unique(border, axis=0)) < len(border)


def evaluated_places(obj: bpy.types.Object) -> FloatArray | None:
    """Find where on the base mesh the vertices of the evaluated mesh are, as far as the modifiers tell.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode.

    Returns
    -------
    (n, 3) ndarray of float or None
        Positions on the base mesh, between its vertices in straight lines; None where the modifiers drop attributes.
    """
    mesh = obj.data
    points = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    mesh.vertices.foreach_get("co", points)
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


def closed_seams(vertices: FloatArray, faces: IntArray, places: FloatArray, longest: float) -> FloatArray:
    """Bring the two sides of seams together.

    Parameters
    ----------
    vertices : (n, 3) ndarray of float
        Positions of the evaluated mesh.
    faces : (m, 3) ndarray of int
        Its triangles.
    places : (n, 3) ndarray of float
        Where on the base mesh its vertices are.
    longest : float
        Length of the longest edge of the base mesh at a border.

    Returns
    -------
    (n, 3) ndarray of float
        Positions; vertices at borders that are in one place on the base mesh, and not far apart, have their mean.
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
    """Measure the longest edge at a border.

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
