"""Stiffness L and lumped mass M of a triangulation."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..numerics.arrays import FloatArray
from .triangulation import Triangulation, corner_cotangents, face_areas

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix


def stiffness(surface: Triangulation) -> csr_matrix:
    """Assemble the cotangent stiffness matrix L, positive semi-definite, with rows summing to 0.

    `surface`: triangles of positive area; gives (n, n).

    Examples
    --------
    >>> from addon.core.surface.triangulation import triangulated
    >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
    >>> L = stiffness(triangulated(square, np.array([[0, 1, 2], [1, 3, 2]])))
    >>> L.diagonal().round(6).tolist(), np.allclose(L.sum(axis=1), 0)
    ([1.0, 1.0, 1.0, 1.0], True)

    References
    ----------
    Pinkall and Polthier, "Computing Discrete Minimal Surfaces and Their Conjugates", 1993.
    """
    from scipy.sparse import coo_matrix, diags

    row = np.roll(surface.faces, -1, axis=1).ravel()
    column = np.roll(surface.faces, -2, axis=1).ravel()
    shape = (surface.vertex_count, surface.vertex_count)
    half = coo_matrix((corner_cotangents(surface.lengths).ravel() / 2, (row, column)), shape=shape).tocsr()
    weights = half + half.T
    return (diags(np.asarray(weights.sum(axis=1)).ravel()) - weights).tocsr()


def mass(surface: Triangulation) -> FloatArray:
    """Compute the diagonal of the lumped mass matrix M: a third of the area of the triangles at each vertex.

    `surface`: the surface; gives (n,).

    Examples
    --------
    >>> from addon.core.surface.triangulation import triangulated
    >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
    >>> mass(triangulated(square, np.array([[0, 1, 2], [1, 3, 2]]))).round(6).tolist()
    [0.166667, 0.333333, 0.333333, 0.166667]
    """
    thirds = np.repeat(face_areas(surface.lengths) / 3, 3)
    return np.bincount(surface.faces.ravel(), weights=thirds, minlength=surface.vertex_count).astype(np.float64)


def stiffness_and_mass(surface: Triangulation) -> tuple[csr_matrix, FloatArray]:
    """Compute both: L (n, n) and the diagonal of M (n,)."""
    return stiffness(surface), mass(surface)
