"""Which vertices and faces are connected: components, borders, repeated corners, duplicates, orientation."""

from __future__ import annotations

import numpy as np

from ..numerics.arrays import BoolArray, IntArray
from .edges import EdgeTable


def component_labels(vertex_count: int, pairs: IntArray) -> IntArray:
    """Label the connected components of a graph.

    `vertex_count`: number of vertices n; `pairs` (e, 2); gives (n,).

    Examples
    --------
    >>> component_labels(4, np.array([[0, 2]])).tolist()
    [0, 1, 0, 2]
    """
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    graph = coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(vertex_count, vertex_count))
    return connected_components(graph, directed=False)[1].astype(np.int64)


def border_labels(faces: IntArray, edges: EdgeTable) -> IntArray:
    """Label the borders of a mesh.

    `faces` (m, 3); `edges`: their edges; gives (n,).

    Examples
    --------
    >>> from addon.core.mesh.edges import edge_table
    >>> two = np.array([[0, 1, 2], [3, 4, 5]])
    >>> border_labels(two, edge_table(two)).tolist()
    [0, 0, 0, 1, 1, 1]
    """
    alone = edges.alone
    pairs = np.column_stack([edges.tail[alone], edges.head[alone]])
    label = np.full(int(faces.max(initial=-1)) + 1, -1, dtype=np.int64)
    if len(pairs):
        vertices, ends = np.unique(pairs, return_inverse=True)
        label[vertices] = component_labels(len(vertices), ends.reshape(-1, 2))
    return label


def repeats_a_corner(faces: IntArray) -> BoolArray:
    """Tell which triangles name a vertex twice.

    `faces` (m, 3); gives (m,).

    Examples
    --------
    >>> repeats_a_corner(np.array([[0, 1, 2], [1, 1, 2]])).tolist()
    [False, True]
    """
    return np.asarray((faces == np.roll(faces, 1, axis=1)).any(axis=1))


def repeats_a_triangle(faces: IntArray) -> BoolArray:
    """Tell which triangles have the same three vertices as an earlier one, whatever their order.

    `faces` (m, 3); gives (m,).

    Examples
    --------
    >>> repeats_a_triangle(np.array([[0, 1, 2], [2, 1, 0], [1, 2, 3]])).tolist()
    [False, True, False]
    """
    low, mid, high = np.sort(faces, axis=1).T.astype(np.uint64)
    with np.errstate(over="ignore"):
        mixed = low * np.uint64(0x9E3779B97F4A7C15) ^ mid * np.uint64(0xC2B2AE3D27D4EB4F) ^ high
    order = np.argsort(mixed, kind="stable")
    alike = np.flatnonzero(mixed[order][1:] == mixed[order][:-1])
    repeats = np.zeros(len(faces), dtype=bool)
    if len(alike):
        some = np.unique(order[np.concatenate([alike, alike + 1])])  # rising, so the first of each stays
        _, first = np.unique(np.sort(faces[some], axis=1), axis=0, return_index=True)
        repeats[some] = True
        repeats[some[first]] = False
    return repeats


def turned_over(faces: IntArray, edges: EdgeTable) -> BoolArray:
    """Tell which triangles to flip, as few as possible, so that neighbours across an edge agree.

    One-sided pieces stay as they are. `faces` (m, 3); `edges`: their edges; gives (m,).

    Examples
    --------
    >>> from addon.core.mesh.edges import edge_table
    >>> strip = np.array([[0, 1, 2], [2, 1, 3], [2, 4, 3]])
    >>> turned_over(strip, edge_table(strip)).tolist()
    [False, False, True]
    """
    start = edges.start[edges.count == 2]
    one, other = edges.order[start], edges.order[start + 1]
    disagree = edges.tail[one] == edges.tail[other]
    if not disagree.any():
        return np.zeros(len(faces), dtype=bool)
    m = len(faces)
    f, g = one // 3, other // 3
    # each triangle stands twice in the graph: f as it is, m + f turned over
    pairs = np.concatenate([np.column_stack([f, g + m * disagree]), np.column_stack([m + f, m + g - m * disagree])])
    label = component_labels(2 * m, pairs)
    as_is, over = label[:m], label[m:]
    kept = np.bincount(as_is, minlength=int(label.max()) + 1)
    return np.asarray((kept[over] > kept[as_is]) | ((kept[over] == kept[as_is]) & (over < as_is)))
