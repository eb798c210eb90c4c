"""The distances that the stress is made of: commute time, biharmonic distance and in-patch geodesics."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .heat import HeatMethod
from .laplacian import factored
from .monitor import Monitor
from .spectrum import Spectrum
from .surface import FloatArray, IntArray, Triangulation

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

_CHUNK = 32  # most sources solved at once: more do not fit the processor's cache and take longer each
_ROWS = 128  # rows of a matrix made symmetric at once
_CHUNK_VALUES = 200_000  # most distances solved at once: bounds the time until a cancel is heard


class GreensFunction:
    """Solutions of ``L u = e_i``, with L factored once: the exact sums of equations 8 and 9.

    Parameters
    ----------
    stiffness : (n, n) scipy.sparse.csr_matrix
        L of a connected surface.
    mass : (n,) ndarray of float
        Diagonal of M.
    """

    def __init__(self, stiffness: csr_matrix, mass: FloatArray) -> None:
        self._mass = mass
        # L is singular: the last vertex is held at 0, which shifts every solution by a constant
        self._solve = factored(stiffness[:-1, :-1]).solve

    def commute_time_squared(self, points: IntArray, monitor: Monitor | None = None) -> FloatArray:
        """Compute squared commute times between all pairs of some vertices (equation 8, all eigenpairs).

        Parameters
        ----------
        points : (p,) ndarray of int
            Vertices.
        monitor : Monitor, optional
            Asked between blocks of vertices whether to stop.

        Returns
        -------
        (p, p) ndarray of float
            c²; it has no unit.

        Raises
        ------
        CancelledError
            If the monitor says so.

        References
        ----------
        Qiu and Hancock, "Clustering and Embedding Using Commute Times", 2007.
        """
        green = np.empty((len(points), len(points)))  # rows and columns of one inverse of L
        chunk = int(np.clip(_CHUNK_VALUES // len(self._mass), 4, _CHUNK))
        for start in range(0, len(points), chunk):
            if monitor is not None:
                monitor.check()
            green[start : start + chunk] = self._grounded(points[start : start + chunk])[points].T
        diagonal = np.diag(green).copy()
        for start in range(0, len(points), _ROWS):
            if monitor is not None:
                monitor.check()
            stop = start + _ROWS
            mean = (green[start:stop, start:] + green[start:, start:stop].T) / 2
            squared = np.maximum(diagonal[start:stop, None] + diagonal[None, start:] - 2 * mean, 0.0)
            green[start:stop, start:] = squared
            green[start:, start:stop] = squared.T
        np.fill_diagonal(green, 0.0)
        return green

    def biharmonic_distances(self, points: IntArray) -> FloatArray:
        """Compute biharmonic distances between some vertices (equation 9, all eigenpairs).

        With ``L u_i = e_i`` but for what is the same for all i, and the mean under M of each taken out,
        ``dB_ij² = |u_i - u_j|²`` under M.

        Parameters
        ----------
        points : (k,) ndarray of int
            Vertices.

        Returns
        -------
        (k, k) ndarray of float
            dB, a length.

        References
        ----------
        Lipman, Rustamov and Funkhouser, "Biharmonic Distance", 2010.
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

    Parameters
    ----------
    spectrum : Spectrum
        The eigenpairs.
    first : (p,) ndarray of int
        Vertices i.
    second : (q,) ndarray of int
        Vertices j.

    Returns
    -------
    (p, q) ndarray of float
        c²; it has no unit.
    """
    return _spectral_squared(spectrum, first, second, 1)


def biharmonic_squared(spectrum: Spectrum, first: IntArray, second: IntArray) -> FloatArray:
    """Compute squared biharmonic distances from the eigenpairs at hand.

    ``dB_ij² = Σ_{k≥1} (h_k(i) - h_k(j))² / λ_k²`` (equation 9). `GreensFunction.biharmonic_distances` has the whole
    sum.

    Parameters
    ----------
    spectrum : Spectrum
        The eigenpairs.
    first : (p,) ndarray of int
        Vertices i.
    second : (q,) ndarray of int
        Vertices j.

    Returns
    -------
    (p, q) ndarray of float
        dB², in squared units of length.
    """
    return _spectral_squared(spectrum, first, second, 2)


def all_geodesics(
    surface: Triangulation, monitor: Monitor, smooth: float | None = None, done: float = 0.0, share: float = 1.0
) -> FloatArray:
    """Measure geodesic distances between all vertices of a patch by the heat method (paper section 3.3).

    Parameters
    ----------
    surface : Triangulation
        The patch, connected, with its natural (Neumann) border.
    monitor : Monitor
        Asked between blocks of sources whether to stop, and told the progress.
    smooth : float, optional
        Diffusion time of smoothed distances; see `HeatMethod`. Without, the triangles are refined for accuracy.
    done, share : float
        The fraction of the present stage that is done before, and that this call is worth.

    Returns
    -------
    (p, p) ndarray of float
        Distances, symmetric (the mean of both ways), diagonal 0.

    Raises
    ------
    CancelledError
        If the monitor says so.
    """
    count = surface.vertex_count
    heat = HeatMethod(surface, smooth, refine=smooth is None, monitor=monitor)
    distance = np.empty((count, count))
    chunk = int(np.clip(_CHUNK_VALUES // count, 4, _CHUNK))
    for start in range(0, count, chunk):
        block = np.arange(start, min(start + chunk, count))
        distance[block] = heat.distances(block).T  # by rows: a column of a large matrix touches every page of it
        monitor.tick(done + share * (block[-1] + 1) / count)
    for start in range(0, count, _ROWS):
        stop = start + _ROWS
        mean = (distance[start:stop, start:] + distance[start:, start:stop].T) / 2
        distance[start:stop, start:] = mean
        distance[start:, start:stop] = mean.T
        monitor.check()
    np.fill_diagonal(distance, 0.0)
    return distance


def _spectral_squared(spectrum: Spectrum, first: IntArray, second: IntArray, power: int) -> FloatArray:
    from scipy.spatial.distance import cdist

    scale = spectrum.eigenvalues ** (-power / 2)
    vectors = spectrum.eigenvectors
    return cdist(vectors[first] * scale, vectors[second] * scale, "sqeuclidean")
