"""Patches: geodesic Voronoi cells of the feature points, open as published or closed (paper section 3.2)."""

from __future__ import annotations

import numpy as np

from ..mesh.connectivity import vertex_pairs
from ..numerics.arrays import FloatArray, IntArray

_TIE = 1e-6  # share of the largest distance within which two feature points count as equally near


def voronoi_cells(distances: FloatArray, feature_points: IntArray, faces: IntArray) -> IntArray:
    """Assign every vertex to its nearest feature point.

    Each cell is connected and holds its own feature point: an island that rounding or a poor distance cut off goes
    to the cell around it. On a tie the first feature point wins.

    Parameters
    ----------
    distances : (n, k) ndarray of float
        Geodesic distance of every vertex from each feature point.
    feature_points : (k,) ndarray of int
        Vertex indices.
    faces : (m, 3) ndarray of int
        Triangles of a connected mesh.

    Returns
    -------
    (n,) ndarray of int
        Index into `feature_points`.
    """
    nearest = distances.min(axis=1, keepdims=True)
    cell = np.argmax(distances <= nearest + _TIE * distances.max(), axis=1).astype(np.int64)
    cell[feature_points] = np.arange(len(feature_points))
    pairs = vertex_pairs(faces)
    home = _reached(cell, feature_points, pairs)
    while not home.all():
        border = pairs[home[pairs[:, 0]] != home[pairs[:, 1]]]
        outside = np.where(home[border[:, 0]], border[:, 1], border[:, 0])
        inside = np.where(home[border[:, 0]], border[:, 0], border[:, 1])
        order = np.lexsort((cell[inside], distances[outside, cell[inside]]))[::-1]  # the nearest is written last
        cell[outside[order]] = cell[inside[order]]
        home[outside] = True
    return cell


def closed_cell_faces(cells: IntArray, faces: IntArray, index: int) -> IntArray:
    """List the triangles of a closed cell: those with at least one corner in the cell.

    Neighbouring closed cells share a band of vertices, which is what keeps the form in one piece.

    Parameters
    ----------
    cells : (n,) ndarray of int
        Cell of every vertex.
    faces : (m, 3) ndarray of int
        Triangles.
    index : int
        The cell.

    Returns
    -------
    (f,) ndarray of int
        Rows of `faces`.
    """
    return np.flatnonzero((cells[faces] == index).any(axis=1))


def _reached(cell: IntArray, feature_points: IntArray, pairs: IntArray) -> np.ndarray:
    """Mark the vertices that are joined to their feature point inside their own cell."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    inner = pairs[cell[pairs[:, 0]] == cell[pairs[:, 1]]]
    graph = coo_matrix((np.ones(len(inner)), (inner[:, 0], inner[:, 1])), shape=(len(cell), len(cell)))
    part = connected_components(graph, directed=False)[1]
    return part == part[feature_points][cell]
