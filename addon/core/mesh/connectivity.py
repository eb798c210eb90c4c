"""Which vertices are joined: edges, borders, connected components."""

from __future__ import annotations

import numpy as np

from ..numerics.arrays import IntArray


def is_closed(faces: IntArray) -> bool:
    """Tell whether every edge lies between exactly two triangles.

    Parameters
    ----------
    faces : (m, 3) ndarray of int
        Triangles.

    Returns
    -------
    bool
        True if the mesh has no border and no edge of more than two triangles.
    """
    tail, head = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    key = np.sort(np.minimum(tail, head) * (int(faces.max()) + 1) + np.maximum(tail, head))
    return len(key) % 2 == 0 and bool((key[::2] == key[1::2]).all() and (key[1:-1:2] != key[2::2]).all())


def vertex_pairs(faces: IntArray) -> IntArray:
    """List every pair of vertices joined by an edge once.

    Parameters
    ----------
    faces : (m, 3) ndarray of int
        Triangles.

    Returns
    -------
    (e, 2) ndarray of int
        Pairs, lower vertex index first, sorted.
    """
    count = int(faces.max(initial=0)) + 1
    tail, head = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    key = np.unique(np.minimum(tail, head) * count + np.maximum(tail, head))
    return np.column_stack([key // count, key % count])


def component_labels(vertex_count: int, faces: IntArray) -> IntArray:
    """Tell the connected parts of the mesh apart.

    Parameters
    ----------
    vertex_count : int
        Number of vertices n.
    faces : (m, 3) ndarray of int
        Triangles.

    Returns
    -------
    (n,) ndarray of int
        Part of each vertex, numbered from 0. A vertex of no face is a part of its own.
    """
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    row, column = faces[:, [0, 1]].ravel(), faces[:, [1, 2]].ravel()
    graph = coo_matrix((np.ones(len(row)), (row, column)), shape=(vertex_count, vertex_count))
    return connected_components(graph, directed=False)[1].astype(np.int64)
