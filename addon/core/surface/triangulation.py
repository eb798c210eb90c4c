"""A surface as triangles with edge lengths, without positions in space.

Functions of a `Triangulation` use only its triangles and the lengths of their edges, so they cannot depend on how the
mesh lies in space.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..mesh.edges import undirected_keys
from ..numerics.arrays import FloatArray, IntArray


class Triangulation(NamedTuple):
    """Triangles glued along edges, each edge with a length: a surface without positions in space.

    Attributes
    ----------
    vertex_count : int
        Number of vertices n.
    faces : (m, 3) ndarray of int
        Corners of each triangle. An intrinsic triangle may name a vertex twice: it then wraps around a limb.
    lengths : (m, 3) ndarray of float
        Length of the edge opposite to each corner.
    edges : (m, 3) ndarray of int
        Number of the edge opposite to each corner, from 0. Two edges may join the same two vertices.
    """

    vertex_count: int
    faces: IntArray
    lengths: FloatArray
    edges: IntArray


def triangulated(vertices: FloatArray, faces: IntArray, slack: float = 1e-5) -> Triangulation:
    """Build the triangulation of a mesh in space, mollified so that every triangle has some area.

    `vertices` (n, 3); `faces` (m, 3); `slack`: as `factor` in `mollified`.

    Examples
    --------
    >>> triangle = triangulated(np.array([[0.0, 0, 0], [3, 0, 0], [0, 4, 0]]), np.array([[0, 1, 2]]))
    >>> triangle.vertex_count, triangle.lengths.round(6).tolist()
    (3, [[5.0, 4.0, 3.0]])
    """
    tail, head = np.roll(faces, -1, axis=1), np.roll(faces, -2, axis=1)
    _, number = np.unique(undirected_keys(tail, head, len(vertices)), return_inverse=True)
    return Triangulation(
        len(vertices), faces, mollified(corner_lengths(vertices, faces), slack), number.reshape(-1, 3).astype(np.int64)
    )


def corner_lengths(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """Measure the edges of every triangle.

    `vertices` (n, 3); `faces` (m, 3); gives (m, 3).

    Examples
    --------
    >>> corner_lengths(np.array([[0.0, 0, 0], [3, 0, 0], [0, 4, 0]]), np.array([[0, 1, 2]])).tolist()
    [[5.0, 4.0, 3.0]]
    """
    corners = vertices[faces]  # (m, 3 corners, 3)
    opposite = np.roll(corners, -1, axis=1) - np.roll(corners, -2, axis=1)
    return np.linalg.norm(opposite, axis=2)  # (m, 3)


def mollified(lengths: FloatArray, factor: float = 1e-5) -> FloatArray:
    """Lengthen all edges by one constant, just enough that no triangle is degenerate.

    A mesh whose triangles are all thick enough is returned unchanged.

    `lengths` (m, 3); `factor`: slack required of every triangle inequality, in units of the mean edge length; gives
    (m, 3).

    Examples
    --------
    >>> mollified(np.array([[3.0, 4.0, 5.0]])).tolist()
    [[3.0, 4.0, 5.0]]
    >>> mollified(np.array([[1.0, 2.0, 3.0]]), 0.1).round(6).tolist()
    [[1.2, 2.2, 3.2]]

    References
    ----------
    Sharp and Crane, "A Laplacian for Nonmanifold Triangle Meshes", 2020, doi:10.1111/cgf.14069, section 4.5.
    """
    slack = lengths.sum(axis=1, keepdims=True) - 2 * lengths  # (m, 3)
    return lengths + max(0.0, factor * float(lengths.mean()) - float(slack.min()))


def face_areas(lengths: FloatArray) -> FloatArray:
    """Compute triangle areas from edge lengths (Heron's formula in Kahan's stable order).

    `lengths` (m, 3); gives (m,).

    Examples
    --------
    >>> face_areas(np.array([[3.0, 4.0, 5.0]])).round(6).tolist()
    [6.0]
    """
    c, b, a = np.sort(lengths, axis=1).T  # a >= b >= c
    squared = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c))
    return np.sqrt(np.maximum(squared, 0.0)) / 4


def corner_cotangents(lengths: FloatArray) -> FloatArray:
    """Compute the cotangent of every corner from edge lengths.

    `lengths` (m, 3); gives (m, 3).

    Examples
    --------
    >>> corner_cotangents(np.array([[5.0, 3.0, 4.0]])).round(6).tolist()
    [[0.0, 1.333333, 0.75]]
    """
    squared = lengths**2
    area = np.maximum(face_areas(lengths), np.finfo(np.float64).tiny)
    return (squared.sum(axis=1, keepdims=True) - 2 * squared) / (4 * area[:, None])
