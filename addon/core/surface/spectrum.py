"""Eigenpairs of the Laplace-Beltrami operator (paper section 4)."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..numerics.arrays import FloatArray
from ..numerics.factoring import factored
from ..run.errors import SolverError
from ..run.monitor import Monitor

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

_ACCURACY = 1e-8  # largest residual of an eigenpair that is accepted
_CONNECTED = 1e-10  # least λ_1, in 1/area; a thread 100,000 times as long as wide has 1e-4
_DENSE = 300  # up to this many vertices all eigenpairs are computed at once


class Spectrum(NamedTuple):
    """The lowest non-constant eigenpairs of ``L h = λ M h``.

    Attributes
    ----------
    eigenvalues : (K,) ndarray of float
        λ_1 ≤ … ≤ λ_K, in 1/area; λ_0 = 0 is left out.
    eigenvectors : (n, K) ndarray of float
        Columns h_k with ``hᵀ M h = I``, in 1/sqrt(area).
    """

    eigenvalues: FloatArray
    eigenvectors: FloatArray


def compute_spectrum(stiffness: csr_matrix, mass: FloatArray, count: int, monitor: Monitor | None = None) -> Spectrum:
    """Solve the generalised eigenproblem for the smallest eigenvalues above 0.

    `stiffness` (n, n); `mass` (n,); `count`: number K of eigenpairs wanted; at most n - 1 exist.

    Examples
    --------
    >>> from scipy.sparse import csr_matrix
    >>> chain = csr_matrix([[1.0, -1, 0], [-1, 2, -1], [0, -1, 1]])
    >>> compute_spectrum(chain, np.ones(3), 2).eigenvalues.round(6).tolist()
    [1.0, 3.0]
    """
    from scipy.sparse import diags, identity

    n = len(mass)
    monitor = monitor or Monitor()
    scale = 1 / np.sqrt(mass)
    symmetric = (diags(scale) @ stiffness @ diags(scale)).tocsc()  # M^-1/2 L M^-1/2
    symmetric = (symmetric + symmetric.T) / 2
    shift = -1e-2 / mass.sum()  # just below 0, where L is singular
    inverse = factored(symmetric - shift * identity(n))
    # the inverse, because thin triangles make the largest eigenvalues so large that rounding swamps the lowest
    if n <= max(_DENSE, count + 2):
        whole = inverse.solve(np.eye(n))
        inverted, vectors = np.linalg.eigh((whole + whole.T) / 2)
    else:
        inverted, vectors = _largest(inverse.solve, n, count + 1, monitor)
    order = np.argsort(-inverted)[1 : count + 1]
    least = np.finfo(float).eps * inverted.max()  # below it the sign is due to rounding
    values, vectors = 1 / np.maximum(inverted[order], least) + shift, vectors[:, order]
    residual = np.linalg.norm(inverse.solve(np.ascontiguousarray(symmetric @ vectors - vectors * values)), axis=0)
    residual *= values[0] / values  # all that uses them weighs them by 1/λ or less
    if not values[0] > _CONNECTED / mass.sum():
        raise SolverError("disconnected")
    if not (residual < _ACCURACY).all():
        raise SolverError("inaccurate_spectrum", residual=float(residual.max()))
    return Spectrum(values, vectors * scale[:, None])


def _largest(
    solve: Callable[[FloatArray], FloatArray], n: int, count: int, monitor: Monitor
) -> tuple[FloatArray, FloatArray]:
    """Compute the largest eigenvalues of an inverse by Lanczos."""
    from scipy.sparse.linalg import ArpackError, LinearOperator, eigsh

    def checked_solve(vector: FloatArray) -> FloatArray:
        monitor.check()
        return solve(vector)

    start = np.random.default_rng(0).uniform(0.5, 1.5, n)  # fixed: the same mesh gives the same result
    try:
        values, vectors = eigsh(LinearOperator((n, n), matvec=checked_solve, dtype=np.float64), count, v0=start)
    except ArpackError as error:
        raise SolverError("spectrum_diverged", reason=error) from error
    return values, vectors
