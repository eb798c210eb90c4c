"""Which vertices and faces are joined: edges, components, seams, duplicates, orientation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..numerics.arrays import FloatArray, IntArray

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix


def undirected_keys(tail: IntArray, head: IntArray, vertex_count: int) -> IntArray:
    """Assign each undirected edge between vertices one number, alike in both directions.

    Parameters
    ----------
    tail, head : (e,) ndarray of int
        The two ends of each edge.
    vertex_count : int
        Number of vertices n.

    Returns
    -------
    (e,) ndarray of int
        ``low * n + high``: `numpy.divmod` by n gives the ends back, the lower vertex first.

    Examples
    --------
    >>> undirected_keys(np.array([2, 0]), np.array([0, 2]), 10).tolist()
    [2, 2]
    """
    return np.minimum(tail, head) * vertex_count + np.maximum(tail, head)


def half_edges(faces: IntArray) -> tuple[IntArray, IntArray]:
    """List the edges of every triangle in its own direction.

    Parameters
    ----------
    faces : (m, 3) ndarray of int
        Triangles.

    Returns
    -------
    tail, head : (3 m,) ndarray of int
        Half-edge ``3 f + i`` runs from corner i of triangle f to the next corner.

    Examples
    --------
    >>> tail, head = half_edges(np.array([[4, 5, 6]]))
    >>> tail.tolist(), head.tolist()
    ([4, 5, 6], [5, 6, 4])
    """
    return faces.ravel(), np.roll(faces, -1, axis=1).ravel()


def pair_counts(tail: IntArray, head: IntArray, vertex_count: int) -> csr_matrix:
    """Count how often each pair of vertices occurs in a list.

    A sparse matrix sorts by counting, several times faster than a sort of keys.

    Parameters
    ----------
    tail, head : (e,) ndarray of int
        The two ends of each pair.
    vertex_count : int
        Number of vertices n.

    Returns
    -------
    (n, n) scipy.sparse.csr_matrix of int
        Entry (i, j) counts the pairs from i to j; the entries of each row are sorted.

    Examples
    --------
    >>> pair_counts(np.array([0, 0, 1]), np.array([1, 1, 0]), 2).toarray().tolist()
    [[0, 2], [1, 0]]
    """
    from scipy.sparse import coo_matrix

    return coo_matrix((np.ones(len(tail), dtype=np.int32), (tail, head)), shape=(vertex_count, vertex_count)).tocsr()


def is_closed(faces: IntArray) -> bool:
    """Check whether every edge lies between exactly two triangles.

    Parameters
    ----------
    faces : (m, 3) ndarray of int
        Triangles.

    Returns
    -------
    bool
        True if the mesh has no border and no edge of more than two triangles.

    Examples
    --------
    >>> is_closed(np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])), is_closed(np.array([[0, 1, 2]]))
    (True, False)
    """
    key = np.sort(undirected_keys(*half_edges(faces), int(faces.max()) + 1))
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

    Examples
    --------
    >>> vertex_pairs(np.array([[0, 1, 2], [2, 1, 3]])).tolist()
    [[0, 1], [0, 2], [1, 2], [1, 3], [2, 3]]
    """
    count = int(faces.max(initial=0)) + 1
    tail, head = half_edges(faces)
    found = pair_counts(np.minimum(tail, head), np.maximum(tail, head), count)
    return np.column_stack([np.repeat(np.arange(count), np.diff(found.indptr)), found.indices.astype(np.int64)])


def component_labels(vertex_count: int, pairs: IntArray) -> IntArray:
    """Label the connected components of a graph.

    Parameters
    ----------
    vertex_count : int
        Number of vertices n.
    pairs : (e, 2) ndarray of int
        Pairs of vertices that are joined.

    Returns
    -------
    (n,) ndarray of int
        Component of each vertex, numbered from 0. A vertex of no pair is a component of its own.

    Examples
    --------
    >>> component_labels(4, np.array([[0, 2]])).tolist()
    [0, 1, 0, 2]
    """
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    graph = coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(vertex_count, vertex_count))
    return connected_components(graph, directed=False)[1].astype(np.int64)


@dataclass(frozen=True, eq=False)
class EdgeTable:
    """The half-edges of a mesh sorted by the edge that they lie on.

    Attributes
    ----------
    order : (3 m,) ndarray of int
        Half-edges, numbered as by `half_edges`, those of one edge beside each other.
    start : (e,) ndarray of int
        Where each edge begins in that order.
    count : (e,) ndarray of int
        Number of triangles at each edge.
    tail, head : (3 m,) ndarray of int
        Ends of each half-edge.
    """

    order: IntArray
    start: IntArray
    count: IntArray
    tail: IntArray
    head: IntArray

    @property
    def alone(self) -> IntArray:
        """Half-edges at a border, which have no other beside them."""
        return self.order[self.start[self.count == 1]]


def edge_table(faces: IntArray) -> EdgeTable:
    """Sort the half-edges of a mesh by the edge that they lie on.

    Parameters
    ----------
    faces : (m, 3) ndarray of int
        Triangles.

    Returns
    -------
    EdgeTable
        The table.

    Examples
    --------
    >>> edge_table(np.array([[0, 1, 2], [2, 1, 3]])).count.tolist()
    [1, 1, 2, 1, 1]
    """
    tail, head = half_edges(faces)
    key = undirected_keys(tail, head, int(faces.max(initial=0)) + 1)
    order = np.argsort(key, kind="stable")
    rising = key[order]
    start = np.flatnonzero(np.concatenate([[True], rising[1:] != rising[:-1]])) if len(key) else order
    return EdgeTable(order, start, np.diff(np.append(start, len(key))), tail, head)


def pairs_across_edges(faces: IntArray) -> IntArray:
    """List the pairs of vertices that face each other across an edge.

    Parameters
    ----------
    faces : (m, 3) ndarray of int
        Triangles.

    Returns
    -------
    (p, 2) ndarray of int
        Pairs, lower vertex index first, sorted, each once.

    Examples
    --------
    >>> pairs_across_edges(np.array([[0, 1, 2], [2, 1, 3]])).tolist()
    [[0, 3]]
    """
    edges = edge_table(faces)
    opposite = np.roll(faces, -2, axis=1).ravel()[edges.order]
    beside = np.ones(len(opposite), dtype=bool)
    beside[edges.start] = False  # the first at each edge has none before it
    at = np.flatnonzero(beside)
    pairs = np.sort(np.column_stack([opposite[at - 1], opposite[at]]), axis=1)
    return np.unique(pairs[pairs[:, 0] < pairs[:, 1]], axis=0)


def border_labels(faces: IntArray, edges: EdgeTable) -> IntArray:
    """Label the borders of a mesh.

    Parameters
    ----------
    faces : (m, 3) ndarray of int
        Triangles.
    edges : EdgeTable
        Their edges.

    Returns
    -------
    (n,) ndarray of int
        For every vertex up to the last that a triangle names: the border that it lies on, from 0; -1 inside.

    Examples
    --------
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


def without_repeated_corners(faces: IntArray) -> IntArray:
    """Drop the triangles that name a vertex twice.

    Parameters
    ----------
    faces : (m, 3) ndarray of int
        Triangles.

    Returns
    -------
    (m', 3) ndarray of int
        The others; the same array if all stay.

    Examples
    --------
    >>> without_repeated_corners(np.array([[0, 1, 2], [1, 1, 2]])).tolist()
    [[0, 1, 2]]
    """
    twice = (faces == np.roll(faces, 1, axis=1)).any(axis=1)
    return faces[~twice] if twice.any() else faces


def without_duplicates(faces: IntArray) -> IntArray:
    """Keep the first of triangles with the same three vertices, whatever their order.

    Parameters
    ----------
    faces : (m, 3) ndarray of int
        Triangles.

    Returns
    -------
    (m', 3) ndarray of int
        The others; the same array if all stay.

    Examples
    --------
    >>> without_duplicates(np.array([[0, 1, 2], [2, 1, 0], [1, 2, 3]])).tolist()
    [[0, 1, 2], [1, 2, 3]]
    """
    low, mid, high = np.sort(faces, axis=1).T.astype(np.uint64)
    with np.errstate(over="ignore"):
        mixed = low * np.uint64(0x9E3779B97F4A7C15) ^ mid * np.uint64(0xC2B2AE3D27D4EB4F) ^ high
    order = np.argsort(mixed, kind="stable")
    alike = np.flatnonzero(mixed[order][1:] == mixed[order][:-1])
    if not len(alike):
        return faces
    some = np.unique(order[np.concatenate([alike, alike + 1])])  # rising, so the first of each stays
    _, first = np.unique(np.sort(faces[some], axis=1), axis=0, return_index=True)
    keep = np.ones(len(faces), dtype=bool)
    keep[some] = False
    keep[some[first]] = True
    return faces[keep]


def joined_at_seams(points: FloatArray, faces: IntArray, edges: EdgeTable) -> IntArray:
    """Join vertices along border edges that coincide: map every vertex to the first at its place.

    Sheets that lie on each other all over are not joined: there the third corners lie on each other too.

    Parameters
    ----------
    points : (n, 3) ndarray of float
        Vertices.
    faces : (m, 3) ndarray of int
        Triangles.
    edges : EdgeTable
        Their edges.

    Returns
    -------
    (n,) ndarray of int
        The representative of each vertex: itself, or the first at its place along a seam.

    Examples
    --------
    >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    >>> cut = np.array([[0, 1, 2], [3, 4, 5]])
    >>> joined_at_seams(square, cut, edge_table(cut)).tolist()
    [0, 1, 2, 1, 4, 2]
    """
    representative = np.arange(len(points))
    alone = edges.alone
    if len(alone) < 2:
        return representative
    ends = np.stack([edges.tail[alone], edges.head[alone]])
    rim, place = np.unique(ends, return_inverse=True)
    _, site = np.unique(points[rim] + 0.0, axis=0, return_inverse=True)  # + 0.0: -0 is 0
    if site.max() + 1 == len(rim):
        return representative
    site = site.ravel()[place.ravel()].reshape(2, -1)
    swap = site[0] > site[1]
    site[:, swap], ends[:, swap] = site[::-1, swap], ends[::-1, swap]
    third = points[faces.ravel()[alone // 3 * 3 + (alone + 2) % 3]] + 0.0
    order = np.lexsort((alone, site[1], site[0]))
    site, ends, third = site[:, order], ends[:, order], third[order]
    new = np.concatenate([[True], (site[:, 1:] != site[:, :-1]).any(axis=0)])
    group = np.cumsum(new) - 1
    first = np.flatnonzero(new)[group]
    differs = np.bincount(group, (third != third[first]).any(axis=1)) > 0
    joined = (first != np.arange(len(group))) & differs[group] & (site[0] != site[1])
    pairs = np.column_stack([ends[:, first[joined]].ravel(), ends[:, joined].ravel()])
    if not len(pairs):
        return representative
    label = component_labels(len(points), pairs)
    _, lowest, back = np.unique(label, return_index=True, return_inverse=True)
    return lowest[back.ravel()].astype(np.int64)


def consistently_oriented(faces: IntArray, edges: EdgeTable) -> IntArray:
    """Flip as few triangles as possible so that neighbours across an edge agree; one-sided pieces stay.

    Parameters
    ----------
    faces : (m, 3) ndarray of int
        Triangles.
    edges : EdgeTable
        Their edges.

    Returns
    -------
    (m, 3) ndarray of int
        The triangles; the same array if all agree.

    Examples
    --------
    >>> strip = np.array([[0, 1, 2], [2, 1, 3], [2, 4, 3]])
    >>> consistently_oriented(strip, edge_table(strip)).tolist()
    [[0, 1, 2], [2, 1, 3], [3, 4, 2]]
    """
    start = edges.start[edges.count == 2]
    one, other = edges.order[start], edges.order[start + 1]
    disagree = edges.tail[one] == edges.tail[other]
    if not disagree.any():
        return faces
    m = len(faces)
    f, g = one // 3, other // 3
    # each triangle stands twice in the graph: f as it is, m + f turned over
    pairs = np.concatenate([np.column_stack([f, g + m * disagree]), np.column_stack([m + f, m + g - m * disagree])])
    label = component_labels(2 * m, pairs)
    as_is, over = label[:m], label[m:]
    kept = np.bincount(as_is, minlength=int(label.max()) + 1)
    turn = (kept[over] > kept[as_is]) | ((kept[over] == kept[as_is]) & (over < as_is))
    result = faces.copy()
    result[turn] = result[turn][:, ::-1]
    return result
