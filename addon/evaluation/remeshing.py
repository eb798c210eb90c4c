"""The same surface with other triangles, so that a method cannot read the truth off their numbers."""

from __future__ import annotations

import numpy as np

from ..core.mesh.coarsening import coarsened
from ..core.numerics.arrays import FloatArray, IntArray

LEFT = 0.7  # share of the vertices that are kept


def thinned(vertices: FloatArray, faces: IntArray) -> tuple[IntArray, IntArray]:
    """Reduce a mesh and shuffle its vertices and triangles, deterministically.

    Parameters
    ----------
    vertices : (n, 3) ndarray of float
        Positions.
    faces : (m, 3) ndarray of int
        Triangles.

    Returns
    -------
    rows : (k,) ndarray of int
        The vertices that are kept, in their new order.
    faces : (l, 3) ndarray of int
        Triangles of these.
    """
    coarse = coarsened(vertices, faces, int(LEFT * len(vertices)))
    rng = np.random.default_rng(1)
    order = rng.permutation(len(coarse.kept))
    number = np.empty_like(order)
    number[order] = np.arange(len(order))
    triangles = number[coarse.faces]
    return coarse.kept[order], triangles[rng.permutation(len(triangles))]
