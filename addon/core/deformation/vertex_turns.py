"""One rotation per vertex between two shapes of a surface, smooth, so that changes of one can be made on the other."""

from __future__ import annotations

import numpy as np

from ..mesh.edges import vertex_pairs
from ..mesh.geometry import surface_area
from ..numerics.arrays import FloatArray, IntArray
from ..numerics.factoring import factored
from .rotations import nearest_rotations

_WIDE = 0.03  # sqrt(area): width of the neighbourhood over which the rotation is estimated


def vertex_turns(before: FloatArray, after: FloatArray, faces: IntArray, joined: IntArray | None = None) -> FloatArray:
    """Find the rotation of each vertex from one shape of a surface to another, for row vectors, (n, 3, 3).

    `before`, `after` (n, 3); `faces` (m, 3); `joined` (n,): for each vertex the one that it coincides with, or itself.

    Examples
    --------
    >>> points, faces = np.eye(3), np.array([[0, 1, 2]])
    >>> quarter = np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]])
    >>> np.allclose(vertex_turns(points, points @ quarter, faces), quarter)
    True
    """
    from scipy.sparse import coo_array, diags

    own = np.arange(len(after)) if joined is None else joined
    pairs = vertex_pairs(own[faces])
    i, j = np.concatenate([pairs, pairs[:, ::-1]]).T
    edges, likes = after[j] - after[i], before[j] - before[i]
    covariance = np.zeros((len(after), 3, 3))
    np.add.at(covariance, i, likes[:, :, None] * edges[:, None, :])
    size = float(np.sqrt(surface_area(after, faces)))
    length = float(np.linalg.norm(edges, axis=1).mean()) if len(edges) else 1.0
    degree = np.maximum(np.bincount(i, minlength=len(after)), 1).astype(float)
    weight = coo_array((np.ones(len(i)), (i, j)), shape=(len(after),) * 2)
    time = (_WIDE * size / (length or 1.0)) ** 2
    smooth = factored(((1 + time) * diags(degree) - time * weight).tocsc()).solve
    return nearest_rotations(smooth(covariance.reshape(-1, 9)).reshape(-1, 3, 3))[own]
