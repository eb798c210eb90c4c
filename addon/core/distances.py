"""The distances that the stress is made of: commute time, biharmonic distance and in-patch geodesics."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .heat import HeatMethod
from .monitor import Monitor
from .spectrum import Spectrum
from .surface import FloatArray, IntArray, Triangulation

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

_CHUNK = 128  # most sources solved at once
_CHUNK_VALUES = 600_000  # most distances solved at once: bounds memory and the time until a cancel is heard


def commute_time_squared(spectrum: Spectrum, first: IntArray, second: IntArray) -> FloatArray:
    """Compute squared commute times between two sets of vertices.

    ``c_ij² = Σ_{k≥1} (h_k(i) - h_k(j))² / λ_k`` (equation 8).

    Parameters
    ----------
    spectrum : Spectrum
        The eigenpairs; the sum runs over those that are there.
    first : (p,) ndarray of int
        Vertices i.
    second : (q,) ndarray of int
        Vertices j.

    Returns
    -------
    (p, q) ndarray of float
        c²; it has no unit.

    References
    ----------
    Qiu and Hancock, "Clustering and Embedding Using Commute Times", 2007.
    """
    return _spectral_squared(spectrum, first, second, 1)


def biharmonic_squared(spectrum: Spectrum, first: IntArray, second: IntArray) -> FloatArray:
    """Compute squared biharmonic distances from the eigenpairs at hand.

    ``dB_ij² = Σ_{k≥1} (h_k(i) - h_k(j))² / λ_k²`` (equation 9). The sum converges slowly; `biharmonic_distances`
    has the exact value.

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

    References
    ----------
    Lipman, Rustamov and Funkhouser, "Biharmonic Distance", 2010.
    """
    return _spectral_squared(spectrum, first, second, 2)


def biharmonic_distances(stiffness: csr_matrix, mass: FloatArray, points: IntArray) -> FloatArray:
    """Compute biharmonic distances between some vertices exactly, as if all eigenpairs were summed (equation 9).

    With g = L⁺ M L⁺ (L⁺ orthogonal to constants under M), ``dB_ij² = g_ii + g_jj - 2 g_ij``; one linear solve a point.

    Parameters
    ----------
    stiffness : (n, n) scipy.sparse.csr_matrix
        L of a connected surface.
    mass : (n,) ndarray of float
        Diagonal of M.
    points : (k,) ndarray of int
        Vertices.

    Returns
    -------
    (k, k) ndarray of float
        dB, a length.
    """
    from scipy.sparse.linalg import splu

    n, area = len(mass), mass.sum()
    right = np.zeros((n, len(points)))
    right[points, np.arange(len(points))] = 1.0
    right -= mass[:, None] / area
    # L is singular: hold the last vertex at 0, then take the mean out
    solved = np.zeros((n, len(points)))
    solved[:-1] = splu(stiffness[:-1, :-1].tocsc()).solve(right[:-1])
    solved -= (mass @ solved) / area
    product = solved.T @ (mass[:, None] * solved)  # g_ij
    diagonal = np.diag(product)
    squared = diagonal[:, None] + diagonal[None, :] - product - product.T
    np.fill_diagonal(squared, 0.0)
    return np.sqrt(np.maximum(squared, 0.0))


def all_geodesics(surface: Triangulation, monitor: Monitor, done: float = 0.0, share: float = 1.0) -> FloatArray:
    """Measure geodesic distances between all vertices of a patch by the heat method (paper section 3.3).

    Parameters
    ----------
    surface : Triangulation
        The patch, connected, with its natural (Neumann) border.
    monitor : Monitor
        Asked between blocks of sources whether to stop, and told the progress.
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
    heat = HeatMethod(surface, monitor=monitor)
    distance = np.empty((count, count))
    chunk = int(np.clip(_CHUNK_VALUES // count, 4, _CHUNK))
    for start in range(0, count, chunk):
        block = np.arange(start, min(start + chunk, count))
        distance[:, block] = heat.distances(block)
        monitor.tick(done + share * (block[-1] + 1) / count)
    for start in range(0, count, _CHUNK):
        stop = start + _CHUNK
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
