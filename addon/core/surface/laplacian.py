"""Stiffness L and lumped mass M of a triangulation, and the factors of matrices made of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..numerics.arrays import FloatArray
from .triangulation import Triangulation, corner_cotangents, face_areas

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix


def stiffness(surface: Triangulation) -> csr_matrix:
    """Assemble the cotangent stiffness L, positive semi-definite, rows summing to 0.

    Parameters
    ----------
    surface : Triangulation
        Triangles of positive area.

    Returns
    -------
    (n, n) scipy.sparse.csr_matrix
        L; it has no unit. Borders carry the natural (Neumann) condition.

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
    """Give every vertex a third of the area of its triangles: the diagonal of the lumped mass M.

    Parameters
    ----------
    surface : Triangulation
        The surface.

    Returns
    -------
    (n,) ndarray of float
        Vertex areas; they sum to the area of the surface.
    """
    thirds = np.repeat(face_areas(surface.lengths) / 3, 3)
    return np.bincount(surface.faces.ravel(), weights=thirds, minlength=surface.vertex_count).astype(np.float64)
