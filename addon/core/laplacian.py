"""Stiffness L and lumped mass M of a triangulation, and the factors of matrices made of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .errors import SolverError
from .surface import FloatArray, Triangulation, corner_cotangents, face_areas

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix
    from scipy.sparse.linalg import SuperLU


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


def factored(matrix: object) -> SuperLU:
    """Factor a sparse symmetric positive definite matrix such as ``M + t L``.

    Parameters
    ----------
    matrix : (n, n) scipy.sparse matrix
        The matrix.

    Returns
    -------
    scipy.sparse.linalg.SuperLU
        Its factors; `solve` takes one or many right-hand sides. Columns are ordered by COLAMD, which on surfaces is
        many times faster than SuperLU's orderings for symmetric matrices.

    Raises
    ------
    SolverError
        If rounding makes the matrix singular.
    """
    from scipy.sparse import csc_matrix
    from scipy.sparse.linalg import splu

    try:
        return splu(csc_matrix(matrix), permc_spec="COLAMD", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError as error:  # what SuperLU calls it
        raise SolverError(
            "The triangles are too thin, or of too different sizes, to compute with. Clean the mesh up (Mesh > "
            "Clean Up > Merge by Distance and Degenerate Dissolve) or remesh it."
        ) from error
