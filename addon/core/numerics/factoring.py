"""Factorisation of symmetric positive definite matrices, sparse or nearly dense."""

from __future__ import annotations

from typing import Any, NamedTuple, Protocol

import numpy as np

from ..run.errors import SolverError
from .arrays import FloatArray

_LARGE = 10_000  # rows from which on minimum degree may take longer than it saves
_FULL = 0.1  # share of entries above which a matrix is factored as a dense one: all pairs of a patch fill its block


class Factor(Protocol):
    """A factored matrix."""

    def solve(self, right: FloatArray) -> FloatArray:
        """Solve for one right-hand side (n,) or several (n, d)."""


class _Dense(NamedTuple):
    """A Cholesky factor, as LAPACK keeps it."""

    lower: Any

    def solve(self, right: FloatArray) -> FloatArray:
        """Solve for one right-hand side (n,) or several (n, d)."""
        from scipy.linalg import cho_solve

        return np.asarray(cho_solve((self.lower, True), right, check_finite=False))


def factored(matrix: object) -> Factor:
    """Factor a symmetric positive definite matrix such as ``M + t L``.

    `matrix` (n, n).

    Examples
    --------
    >>> factored(np.array([[2.0, 1], [1, 3]])).solve(np.array([3.0, 4])).round(6).tolist()
    [1.0, 1.0]
    """
    from scipy.linalg import LinAlgError, cho_factor
    from scipy.sparse import csc_matrix
    from scipy.sparse.linalg import splu

    columns = csc_matrix(matrix)
    count = columns.shape[0]
    try:
        if columns.nnz > _FULL * count**2 and count > 1:
            return _Dense(cho_factor(columns.toarray(order="F"), lower=True, overwrite_a=True, check_finite=False)[0])
        order = "MMD_AT_PLUS_A" if count < _LARGE else "COLAMD"
        return splu(columns, permc_spec=order, diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except (RuntimeError, LinAlgError) as error:  # raised by SuperLU and by LAPACK
        raise SolverError("singular") from error
