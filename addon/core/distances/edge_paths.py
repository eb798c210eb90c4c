"""Paths along the edges of a triangulation."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..mesh.edges import undirected_keys
from ..surface.triangulation import Triangulation

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix


def edge_graph(surface: Triangulation) -> csr_matrix:
    """Build the graph of the edges, weighted by their lengths.

    `surface`: the surface; gives (n, n).

    Examples
    --------
    >>> from addon.core.surface.triangulation import triangulated
    >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
    >>> graph = edge_graph(triangulated(square, np.array([[0, 1, 2], [1, 3, 2]])))
    >>> sorted(graph.data.round(6).tolist())
    [1.0, 1.0, 1.0, 1.0, 1.414214]
    """
    from scipy.sparse import coo_matrix

    row, column = np.roll(surface.faces, -1, axis=1).ravel(), np.roll(surface.faces, -2, axis=1).ravel()
    _, first = np.unique(undirected_keys(row, column, surface.vertex_count), return_index=True)
    shape = (surface.vertex_count, surface.vertex_count)
    return coo_matrix((surface.lengths.ravel()[first], (row[first], column[first])), shape=shape).tocsr()
