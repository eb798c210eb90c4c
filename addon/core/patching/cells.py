"""Patches: geodesic Voronoi cells of the feature points, open as published or closed (paper section 4)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..mesh.connectivity import component_labels
from ..mesh.edges import vertex_pairs
from ..numerics.arrays import FloatArray, IntArray

_TIE = 1e-6  # share of the largest distance within which two feature points count as equally near


def voronoi_cells(distances: FloatArray, feature_points: IntArray, faces: IntArray) -> IntArray:
    """Assign every vertex to its nearest feature point.

    Each cell is connected and holds its own feature point: an island that rounding or an inaccurate distance cut off is
    assigned to the cell around it. On a tie the first feature point wins.

    `distances` (n, k); `feature_points` (k,); `faces` (m, 3); gives (n,).

    Examples
    --------
    >>> distances = np.array([[0.0, 4], [1, 3], [2, 2], [3, 1], [4, 0]])
    >>> voronoi_cells(distances, np.array([0, 4]), np.array([[0, 1, 2], [1, 3, 2], [2, 3, 4]])).tolist()
    [0, 0, 0, 1, 1]
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


class Patch(NamedTuple):
    """The part of the surface around one feature point.

    Attributes
    ----------
    faces : (f, 3) ndarray of int
        Triangles with at least one corner in the cell: distances are measured on them.
    vertices : (p,) ndarray of int
        Vertices whose pairs the stress uses, in ascending order: all corners of those triangles if the cell is closed,
        those in the cell alone if it is open.
    """

    faces: IntArray
    vertices: IntArray


def patches_of(cells: IntArray, faces: IntArray, count: int, *, closed: bool = True) -> list[Patch]:
    """Build the patches from the cells.

    Neighbouring closed patches share a band of vertices, which keeps the form connected. Open ones, as published, share
    none.

    `cells` (n,); `faces` (m, 3); `count`: number of cells; `closed`: whether a patch also holds the neighbours of its
    cell.

    Examples
    --------
    >>> strip = np.array([[0, 1, 2], [1, 3, 2], [2, 3, 4]])
    >>> [patch.vertices.tolist() for patch in patches_of(np.array([0, 0, 0, 1, 1]), strip, 2)]
    [[0, 1, 2, 3, 4], [1, 2, 3, 4]]
    >>> [patch.vertices.tolist() for patch in patches_of(np.array([0, 0, 0, 1, 1]), strip, 2, closed=False)]
    [[0, 1, 2], [3, 4]]

    References
    ----------
    The paper, section 4.
    """
    found = []
    for index in range(count):
        touched = faces[(cells[faces] == index).any(axis=1)]
        found.append(Patch(touched, np.unique(touched) if closed else np.flatnonzero(cells == index)))
    return found


def _reached(cell: IntArray, feature_points: IntArray, pairs: IntArray) -> np.ndarray:
    """Mark the vertices that are connected to their feature point inside their own cell."""
    component = component_labels(len(cell), pairs[cell[pairs[:, 0]] == cell[pairs[:, 1]]])
    return component == component[feature_points][cell]
