"""Spectral distances: commute time [8] and biharmonic distance [9]."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..numerics.arrays import FloatArray, IntArray
from ..numerics.blocks import columns_at_once, symmetrise
from ..numerics.factoring import factored
from ..run.monitor import Monitor
from ..surface.spectrum import Spectrum

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix


class GreensFunction:
    """Solutions of ``L u = e_i``, with L factored once: the exact sums of equations 8 and 9.

    `stiffness` (n, n); `mass` (n,).

    Examples
    --------
    >>> from scipy.sparse import csr_matrix
    >>> chain = csr_matrix([[1.0, -1, 0], [-1, 2, -1], [0, -1, 1]])
    >>> green = GreensFunction(chain, np.ones(3))
    >>> green.commute_time_squared(np.arange(3)).round(6).tolist()  # resistances in a chain of unit resistors
    [[0.0, 1.0, 2.0], [1.0, 0.0, 1.0], [2.0, 1.0, 0.0]]
    >>> biharmonic = green.biharmonic_distances(np.arange(3))
    >>> np.array_equal(biharmonic, biharmonic.T)
    True
    """

    def __init__(self, stiffness: csr_matrix, mass: FloatArray) -> None:
        self._mass = mass
        # L is singular: the last vertex is held at 0, which shifts every solution by a constant
        self._solve = factored(stiffness[:-1, :-1]).solve

    def commute_time_squared(self, points: IntArray, monitor: Monitor | None = None) -> FloatArray:
        """Compute squared commute times between all pairs of some vertices (equation 8, all eigenpairs).

        `points` (p,); gives (p, p).

        References
        ----------
        Qiu and Hancock, "Clustering and Embedding Using Commute Times", 2007, doi:10.1109/TPAMI.2007.1103.
        """
        green = np.empty((len(points), len(points)))  # rows and columns of one inverse of L
        check = (monitor or Monitor()).check
        chunk = columns_at_once(len(self._mass))
        for start in range(0, len(points), chunk):
            check()
            green[start : start + chunk] = self._grounded(points[start : start + chunk])[points].T
        symmetrise(green, check)
        diagonal = np.diag(green).copy()
        for start in range(0, len(points), chunk):
            check()
            block = green[start : start + chunk]
            block *= -2
            block += diagonal[start : start + chunk, None] + diagonal
            np.maximum(block, 0.0, out=block)
        np.fill_diagonal(green, 0.0)
        return green

    def biharmonic_distances(self, points: IntArray) -> FloatArray:
        """Compute biharmonic distances between some vertices (equation 9, all eigenpairs).

        With ``L u_i = e_i`` but for what is the same for all i, and the mean under M of each taken out,
        ``dB_ij² = |u_i - u_j|²`` under M.

        `points` (k,); gives (k, k).

        References
        ----------
        Lipman, Rustamov and Funkhouser, "Biharmonic Distance", 2010, doi:10.1145/1805964.1805971.
        """
        solved = self._grounded(points)
        solved -= solved.mean(axis=1, keepdims=True)  # the drain, which cancels out: better before than after
        solved -= (self._mass @ solved) / self._mass.sum()
        product = solved.T @ (self._mass[:, None] * solved)  # (k, k)
        diagonal = np.diag(product)
        squared = diagonal[:, None] + diagonal[None, :] - product - product.T
        np.fill_diagonal(squared, 0.0)
        return np.sqrt(np.maximum(squared, 0.0))

    def _grounded(self, points: IntArray) -> FloatArray:
        """Solve for unit sources at the points, drained at the last vertex."""
        right = np.zeros((len(self._mass), len(points)))
        right[points, np.arange(len(points))] = 1.0
        solved = np.zeros_like(right)
        solved[:-1] = self._solve(right[:-1])
        return solved


def commute_time_squared(spectrum: Spectrum, first: IntArray, second: IntArray) -> FloatArray:
    """Compute squared commute times between two sets of vertices from the eigenpairs at hand.

    ``c_ij² = Σ_{k≥1} (h_k(i) - h_k(j))² / λ_k`` (equation 8). A sum cut short sees nothing smaller than its shortest
    wave: vertices around a finger come out at no distance. `GreensFunction.commute_time_squared` has the whole sum.

    `spectrum`: the eigenpairs; `first` (p,); `second` (q,); gives (p, q).

    Examples
    --------
    >>> spectrum = Spectrum(np.array([2.0]), np.array([[1.0], [-1.0]]))
    >>> commute_time_squared(spectrum, np.array([0]), np.array([0, 1])).round(6).tolist()
    [[0.0, 2.0]]
    """
    return _spectral_squared(spectrum, first, second, 1)


def biharmonic_squared(spectrum: Spectrum, first: IntArray, second: IntArray) -> FloatArray:
    """Compute squared biharmonic distances from the eigenpairs at hand.

    ``dB_ij² = Σ_{k≥1} (h_k(i) - h_k(j))² / λ_k²`` (equation 9). `GreensFunction.biharmonic_distances` has the whole
    sum.

    Gives (p, q).

    Examples
    --------
    >>> spectrum = Spectrum(np.array([2.0]), np.array([[1.0], [-1.0]]))
    >>> biharmonic_squared(spectrum, np.array([0]), np.array([0, 1])).round(6).tolist()
    [[0.0, 1.0]]
    """
    return _spectral_squared(spectrum, first, second, 2)


def _spectral_squared(spectrum: Spectrum, first: IntArray, second: IntArray, power: int) -> FloatArray:
    from scipy.spatial.distance import cdist

    scale = spectrum.eigenvalues ** (-power / 2)
    vectors = spectrum.eigenvectors
    return cdist(vectors[first] * scale, vectors[second] * scale, "sqeuclidean")
