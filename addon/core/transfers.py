"""Entry points for transfer along a match: whether it may be, values on vertices and on corners, deformations."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .deformation.vertex_turns import vertex_turns
from .mesh.geometry import surface_area, vertex_areas
from .mesh.islands import island_labels
from .mesh.tables import rows_in
from .numerics.arrays import BoolArray, FloatArray, IntArray
from .results import Match
from .run.errors import InvalidMeshError

_FARTHER = 1.2  # factor on the stretch of a map: corners farther apart there lie on different sides of a seam
_SURE = 0.4  # mean confidence: between bodies of different kinds it is .17 to .36, and .6 to .9 where a match is right
_ROUNDING = 1e-9  # difference below which values are the same


def require_fit(matched: Match, vertices: ArrayLike, faces: ArrayLike) -> None:
    """Refuse a match that does not tell enough for data to be transferred.

    Parameters
    ----------
    matched : Match
        A match of this mesh with the other.
    vertices : (n, 3) array_like of float
        Positions of this mesh.
    faces : (m, 3) array_like of int
        Its triangles.

    Raises
    ------
    InvalidMeshError
        If its mean confidence, by area, is below that of bodies of one kind.

    Examples
    --------
    >>> points, faces = [[0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
    >>> from addon.core import match
    >>> require_fit(match(points, faces, points, faces), points, faces)
    """
    points, triangles = np.asarray(vertices, dtype=np.float64), np.asarray(faces, dtype=np.int64)
    areas = vertex_areas(points, triangles)
    if areas @ matched.confidence / areas.sum() < _SURE:
        raise InvalidMeshError("transfer_unlike")


def transferred(matched: Match, values: ArrayLike) -> FloatArray:
    """Transfer values from the vertices of the other mesh to those of this one.

    Parameters
    ----------
    matched : Match
        A match of this mesh with the other.
    values : (n', ...) array_like of float
        Values on the vertices of the other mesh: weights, colours, positions.

    Returns
    -------
    (n, ...) ndarray of float
        Values on the vertices of this mesh, averaged with the weights of the match; sums over columns, such as those of
        bone weights, are preserved. 0 at vertices without a match. Copies of one place get one value, except where
        values differ at a seam of the other mesh: there each gets that of its side.

    Raises
    ------
    InvalidMeshError
        If there is not one item per vertex of the other mesh.

    Examples
    --------
    >>> points, faces = [[0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
    >>> from addon.core import match
    >>> transferred(match(points, faces, points, faces), np.ones(4)).round(6).tolist()
    [1.0, 1.0, 1.0, 1.0]
    """
    values = np.asarray(values, dtype=np.float64)
    if values.ndim < 1 or len(values) != matched.other_count:
        raise InvalidMeshError("transfer_shape", count=matched.other_count)
    corners = matched.other_faces[matched.faces]  # where there is no match, the weights are 0
    found = np.asarray(np.einsum("ij,ij...->i...", matched.weights, values[corners]))
    seams = matched.seams
    if seams is None or not len(seams.sides.vertices) or _alike(values, values[seams.other_joined]).all():
        return found
    vertices, faces, weights = seams.sides
    own = np.einsum("ij,ij...->i...", weights, values[matched.other_faces[faces]])
    place = seams.joined[vertices]
    _, first, group = np.unique(place, return_index=True, return_inverse=True)
    differs = np.bincount(group.ravel(), ~_alike(own, own[first[group.ravel()]]))[group.ravel()] > 0
    found[vertices[differs]] = own[differs]  # elsewhere copies keep one value
    return found


def transferred_corners(
    matched: Match,
    polygon_of: IntArray,
    vertex_of: IntArray,
    other_vertices: FloatArray,
    other_corners: IntArray,
    values: ArrayLike,
    other_vertex_of: IntArray,
) -> FloatArray:
    """Transfer values on the corners of the other mesh, such as a UV map; no polygon spans a seam.

    Where its corners come from different sides of a seam, the side of most of them is extrapolated linearly.

    Parameters
    ----------
    matched : Match
        A match of this mesh with the other.
    polygon_of : (l,) ndarray of int
        The polygon of each corner of this mesh.
    vertex_of : (l,) ndarray of int
        The vertex of each corner.
    other_vertices : (n', 3) ndarray of float
        Positions of the other mesh.
    other_corners : (t, 3) ndarray of int
        Corners of its triangles.
    values : (l', d) array_like of float
        Values on its corners.
    other_vertex_of : (l',) ndarray of int
        The vertex of each of its corners.

    Returns
    -------
    (l, d) ndarray of float
        Values on the corners of this mesh; 0 where there is no match.

    Raises
    ------
    InvalidMeshError
        If there is not one item per corner of the other mesh.

    Examples
    --------
    >>> from addon.core import match
    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]])
    >>> faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> corners = np.arange(12).reshape(4, 3)
    >>> same = match(points, faces, points, faces)
    >>> found = transferred_corners(
    ...     same, np.repeat(np.arange(4), 3), faces.ravel(), points, corners, points[faces.ravel()], faces.ravel())
    >>> np.allclose(found, points[faces.ravel()])
    True
    """
    values = np.asarray(values, dtype=np.float64)
    if values.ndim != 2 or len(values) != len(other_vertex_of):
        raise InvalidMeshError("transfer_corners", count=len(other_vertex_of))
    triangles = other_vertex_of[other_corners]
    places = triangles if matched.seams is None else matched.seams.other_joined[triangles]
    island = island_labels(places, values[other_corners])
    triangle, weights = _on_triangles(matched, triangles)
    own, share = triangle[vertex_of], weights[vertex_of]
    known = own >= 0
    label = np.where(known, island[own], -1)
    same = label == _commonest(polygon_of, label)[polygon_of]
    base = np.full(int(polygon_of.max()) + 1, -1)  # a corner of each polygon that decides its side of a seam
    base[polygon_of[same][::-1]] = np.flatnonzero(same)[::-1]
    base = base[polygon_of]
    carried = np.einsum("ij,ijk->ik", share, values[other_corners[own]])
    places = np.einsum("ij,ijk->ik", share, other_vertices[triangles[own]])
    beyond = _extended(other_vertices[triangles[own[base]]], places)
    straight = np.einsum("ij,ijk->ik", beyond, values[other_corners[own[base]]])
    stretch = _stretch(other_vertices[triangles], values[other_corners])
    stretch = np.maximum(stretch, np.median(stretch))  # a map may be flat in places
    reach = np.maximum(stretch[own], stretch[own[base]]) * np.linalg.norm(places - places[base], axis=1)
    reach = _FARTHER * reach + np.linalg.norm(straight - carried[base], axis=1)
    kept = same & (np.linalg.norm(carried - carried[base], axis=1) <= reach + _ROUNDING)
    return np.where(known[:, None], np.where(kept[:, None], carried, straight), 0.0)


def transferred_labels(
    matched: Match, polygon_of: IntArray, vertex_of: IntArray, other_triangles: IntArray, labels: IntArray
) -> IntArray:
    """Transfer labels of the triangles of the other mesh, such as materials: a polygon gets that of most corners.

    Parameters
    ----------
    matched : Match
        A match of this mesh with the other.
    polygon_of : (l,) ndarray of int
        The polygon of each corner of this mesh.
    vertex_of : (l,) ndarray of int
        The vertex of each corner.
    other_triangles : (t, 3) ndarray of int
        Triangles of the other mesh, in any order.
    labels : (t,) ndarray of int
        Their labels, from 0.

    Returns
    -------
    (p,) ndarray of int
        Labels of the polygons of this mesh; -1 where no corner has a match.

    Examples
    --------
    >>> from addon.core import match
    >>> points, faces = [[0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
    >>> same = match(points, faces, points, faces)
    >>> transferred_labels(same, np.repeat(np.arange(4), 3), np.ravel(faces), np.array(faces), np.full(4, 7)).tolist()
    [7, 7, 7, 7]
    """
    triangle, _ = _on_triangles(matched, other_triangles)
    own = triangle[vertex_of]
    return _commonest(polygon_of, np.where(own < 0, -1, labels[own]))


def transferred_shape(
    matched: Match,
    vertices: ArrayLike,
    faces: ArrayLike,
    other_vertices: ArrayLike,
    other_shape: ArrayLike,
) -> FloatArray:
    """Transfer a deformation of the other mesh: every point moves as its counterpart, rotated and scaled to this mesh.

    Parameters
    ----------
    matched : Match
        A match of this mesh with the other.
    vertices : (n, 3) array_like of float
        Positions of this mesh.
    faces : (m, 3) array_like of int
        Its triangles.
    other_vertices, other_shape : (n', 3) array_like of float
        Positions of the other mesh before and after, in any unit and pose.

    Returns
    -------
    (n, 3) ndarray of float
        Positions of this mesh after the deformation.

    Raises
    ------
    InvalidMeshError
        If there is not one position per vertex of the other mesh.

    Examples
    --------
    >>> from addon.core import match
    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]])
    >>> faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
    >>> same = match(points, faces, points, faces)
    >>> np.allclose(transferred_shape(same, points, faces, points, 1.1 * points), 1.1 * points)
    True

    References
    ----------
    Sumner and Popović, "Deformation Transfer for Triangle Meshes", 2004, doi:10.1145/1015706.1015736, who transfer
    changes instead of positions; this is simpler: one rotation per vertex.
    """
    points, before = np.asarray(vertices, dtype=np.float64), np.asarray(other_vertices, dtype=np.float64)
    there = transferred(matched, before)
    way = transferred(matched, np.asarray(other_shape, dtype=np.float64) - before)
    triangles = np.asarray(faces, dtype=np.int64)
    turn = vertex_turns(there, points, triangles, None if matched.seams is None else matched.seams.joined)
    size = float(np.sqrt(surface_area(points, triangles)))
    scale = size / np.sqrt(surface_area(before, matched.other_faces))
    moved: FloatArray = points + scale * np.einsum("ij,ijk->ik", way, turn)
    return moved


def _alike(one: FloatArray, other: FloatArray) -> BoolArray:
    """Tell which values (k, ...) of two lists are the same, but for rounding; gives (k,)."""
    return np.asarray((np.abs(one - other) <= _ROUNDING).reshape(len(one), -1).all(axis=1))


def _on_triangles(matched: Match, triangles: IntArray) -> tuple[IntArray, FloatArray]:
    """Express a match in terms of other triangles of the same mesh, corners in any order; -1 where there is none."""
    order = np.argsort(matched.other_faces, axis=1)
    own_order = np.argsort(triangles, axis=1)
    number = rows_in(np.take_along_axis(matched.other_faces, order, 1), np.take_along_axis(triangles, own_order, 1))
    triangle = np.where(matched.faces < 0, -1, number[matched.faces])
    ranked = np.take_along_axis(matched.weights, order[matched.faces], 1)
    weights = np.empty_like(ranked)
    np.put_along_axis(weights, own_order[triangle], ranked, 1)
    return triangle, weights


def _extended(triangles: FloatArray, points: FloatArray) -> FloatArray:
    """Compute barycentric coordinates of points in the planes of triangles, also outside the triangles."""
    first, second = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    normal = np.cross(first, second)
    size = np.maximum(np.einsum("ij,ij->i", normal, normal), np.finfo(float).tiny)
    way = points - triangles[:, 0]
    two = np.einsum("ij,ij->i", np.cross(way, second), normal) / size
    three = np.einsum("ij,ij->i", np.cross(first, way), normal) / size
    return np.column_stack([1 - two - three, two, three])


def _stretch(points: FloatArray, values: FloatArray) -> FloatArray:
    """Compute the ratio of the longest side of each triangle in a map to that in space."""
    there, here = (np.linalg.norm(each - np.roll(each, 1, axis=1), axis=2).max(axis=1) for each in (values, points))
    return np.asarray(there / np.maximum(here, np.finfo(float).tiny))


def _commonest(group: IntArray, labels: IntArray) -> IntArray:
    """Find the most common label of each group, on ties the smallest; -1 only where there is no other."""
    known = labels >= 0
    pairs, count = np.unique(np.column_stack([group[known], labels[known]]), axis=0, return_counts=True)
    found = np.full(int(group.max()) + 1 if len(group) else 0, -1)
    order = np.lexsort([-pairs[:, 1], count])  # the last written wins
    found[pairs[order, 0]] = pairs[order, 1]
    return found
