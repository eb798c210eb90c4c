"""Paths along the edges of a triangulation."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..mesh.connectivity import undirected_keys
from ..surface.triangulation import Triangulation

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix


def edge_graph(surface: Triangulation) -> csr_matrix:
    """Join the ends of every edge by its length.

    Parameters
    ----------
    surface : Triangulation
        The surface.

    Returns
    -------
    (n, n) scipy.sparse.csr_matrix
        One entry an edge.
    """
    from scipy.sparse import coo_matrix

    row, column = np.roll(surface.faces, -1, axis=1).ravel(), np.roll(surface.faces, -2, axis=1).ravel()
    _, first = np.unique(undirected_keys(row, column, surface.vertex_count), return_index=True)
    shape = (surface.vertex_count, surface.vertex_count)
    return coo_matrix((surface.lengths.ravel()[first], (row[first], column[first])), shape=shape).tocsr()
