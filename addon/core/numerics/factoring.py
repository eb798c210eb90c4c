"""Sparse factorisation."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..run.errors import SolverError

if TYPE_CHECKING:
    from scipy.sparse.linalg import SuperLU

_LARGE = 10_000  # rows from which on minimum degree may take longer than it saves


def factored(matrix: object) -> SuperLU:
    """Factor a sparse symmetric positive definite matrix such as ``M + t L``.

    `matrix` (n, n).

    Examples
    --------
    >>> import numpy as np
    >>> factored(np.array([[2.0, 1], [1, 3]])).solve(np.array([3.0, 4])).round(6).tolist()
    [1.0, 1.0]
    """
    from scipy.sparse import csc_matrix
    from scipy.sparse.linalg import splu

    try:
        columns = csc_matrix(matrix)
        order = "MMD_AT_PLUS_A" if len(columns.indptr) <= _LARGE else "COLAMD"
        return splu(columns, permc_spec=order, diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError as error:  # raised by SuperLU
        raise SolverError("singular") from error
