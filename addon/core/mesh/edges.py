"""The edges of a mesh: half-edges, pairs of vertices, triangles at each edge."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..numerics.arrays import IntArray

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix


def undirected_keys(tail: IntArray, head: IntArray, vertex_count: int) -> IntArray:
    """Assign each undirected edge between vertices one number, alike in both directions.

    `tail, head` (e,); `vertex_count`: number of vertices n; gives (e,).

    Examples
    --------
    >>> undirected_keys(np.array([2, 0]), np.array([0, 2]), 10).tolist()
    [2, 2]
    """
    return np.minimum(tail, head) * vertex_count + np.maximum(tail, head)


def half_edges(faces: IntArray) -> tuple[IntArray, IntArray]:
    """List the edges of every triangle in its own direction.

    `faces` (m, 3); gives tail, head (3 m,).

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

    `tail, head` (e,); `vertex_count`: number of vertices n; gives (n, n).

    Examples
    --------
    >>> pair_counts(np.array([0, 0, 1]), np.array([1, 1, 0]), 2).toarray().tolist()
    [[0, 2], [1, 0]]
    """
    from scipy.sparse import coo_matrix

    return coo_matrix((np.ones(len(tail), dtype=np.int32), (tail, head)), shape=(vertex_count, vertex_count)).tocsr()


def is_closed(faces: IntArray) -> bool:
    """Check whether every edge lies between exactly two triangles.

    `faces` (m, 3).

    Examples
    --------
    >>> is_closed(np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])), is_closed(np.array([[0, 1, 2]]))
    (True, False)
    """
    return bool((_edge_counts(faces).data == 2).all())


def vertex_pairs(faces: IntArray) -> IntArray:
    """List every pair of vertices joined by an edge once.

    `faces` (m, 3); gives (e, 2).

    Examples
    --------
    >>> vertex_pairs(np.array([[0, 1, 2], [2, 1, 3]])).tolist()
    [[0, 1], [0, 2], [1, 2], [1, 3], [2, 3]]
    """
    found = _edge_counts(faces)
    tail = np.repeat(np.arange(found.shape[0]), np.diff(found.indptr))
    return np.column_stack([tail, found.indices.astype(np.int64)])


def _edge_counts(faces: IntArray) -> csr_matrix:
    """Count the triangles at every edge, in the row of its lower vertex."""
    tail, head = half_edges(faces)
    return pair_counts(np.minimum(tail, head), np.maximum(tail, head), int(faces.max(initial=0)) + 1)


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

    `faces` (m, 3).

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

    `faces` (m, 3); gives (p, 2).

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
