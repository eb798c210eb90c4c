"""Classical scaling, on landmarks carried to the rest (section 2, equation 4), and points placed by distances."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..numerics.arrays import FloatArray, IntArray
from ..numerics.products import product
from ..run.errors import SolverError

_ROWS = 256  # points against a hundred landmarks: they fit the cache
_DENSE = 400  # points up to which all eigenvectors are computed


def classical_scaling(distances: ArrayLike, dimensions: int = 3) -> tuple[FloatArray, FloatArray]:
    """Embed a full matrix of distances by the leading eigenvectors of its Gram matrix.

    ``G = -½ J D² J`` with ``J = I - 11ᵀ/n`` (equation 4; the paper prints J = 11ᵀ/n).

    `distances` (n, n); `dimensions`: dimension d of the embedding; gives embedding (n, d), eigenvalues (n,).

    Examples
    --------
    >>> embedding, _ = classical_scaling([[0, 3, 4], [3, 0, 5], [4, 5, 0]], 2)
    >>> [round(float(np.linalg.norm(embedding[i] - embedding[j])), 6) for i, j in ((0, 1), (0, 2), (1, 2))]
    [3.0, 4.0, 5.0]

    References
    ----------
    Torgerson, "Multidimensional scaling: I. Theory and method", 1952, doi:10.1007/BF02288916.
    """
    from scipy.linalg import eigh

    squared = np.asarray(distances, dtype=np.float64) ** 2
    row_mean = squared.mean(axis=1, keepdims=True)
    gram = -(squared - row_mean - row_mean.T + squared.mean()) / 2
    values, vectors = eigh((gram + gram.T) / 2)
    values, vectors = values[::-1], vectors[:, ::-1]
    leading = np.maximum(values[:dimensions], 0.0)
    embedding = np.zeros((len(squared), dimensions))
    embedding[:, : len(leading)] = vectors[:, :dimensions] * np.sqrt(leading)
    return embedding, values


def landmark_scaling(distances: FloatArray, landmarks: IntArray, dimensions: int = 3) -> FloatArray:
    """Embed landmarks by classical scaling and every other point by its distances from them.

    `distances` (n, l); `landmarks` (l,); `dimensions`: dimension d of the embedding; gives (n, d).

    Examples
    --------
    >>> places = np.array([0.0, 1, 2, 5])
    >>> line = landmark_scaling(np.abs(places[:, None] - places[[0, 3]]), np.array([0, 3]), 1)
    >>> np.abs(line - line[0]).ravel().round(6).tolist()
    [0.0, 1.0, 2.0, 5.0]

    References
    ----------
    De Silva and Tenenbaum, "Sparse multidimensional scaling using landmark points", 2004.
    """
    between = (distances[landmarks] + distances[landmarks].T) / 2  # (l, l)
    embedding, values = classical_scaling(between, dimensions)
    usable = values[:dimensions] > 1e-12 * values[0]
    inverse = np.zeros_like(embedding)  # pseudo-inverse of the landmarks' embedding
    axes = np.flatnonzero(usable)
    inverse[:, axes] = embedding[:, axes] / values[axes]
    return -((distances**2 - (between**2).mean(axis=0)) @ inverse) / 2


def placed_around(
    distances: FloatArray,
    landmarks: IntArray,
    fixed: FloatArray,
    start: FloatArray,
    *,
    steps: int = 20,
) -> FloatArray:
    """Place every point by its distances from landmarks in known places: SMACOF, point by point.

    `distances` (n, l); `landmarks` (l,); `fixed` (l, 3); `start` (n, 3); `steps`: number of steps; gives (n, 3).

    Examples
    --------
    >>> from scipy.spatial.distance import cdist
    >>> cross = np.array([[1.0, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0], [0, 0, 0]])
    >>> start = np.vstack([cross[:4], [0.3, 0.2, 0]])
    >>> found = placed_around(cdist(cross, cross[:4]), np.arange(4), cross[:4], start)
    >>> np.allclose(found, cross, atol=1e-4)
    True

    References
    ----------
    De Leeuw, "Applications of convex analysis to multidimensional scaling", 1977.
    """
    nearness = 1 / np.maximum(distances, 1e-3 * distances.max()) ** 2
    layout = start + product(nearness, fixed - start[landmarks]) / nearness.sum(axis=1)[:, None]
    layout[landmarks] = fixed
    distances = np.ascontiguousarray(distances)
    for first in range(0, len(layout), _ROWS):  # each point on its own: a block stays in the cache through all steps
        rows = slice(first, first + _ROWS)
        for _ in range(steps):
            layout[rows] = _nearer(layout[rows], fixed, distances[rows])
    layout[landmarks] = fixed
    return layout


def _nearer(points: FloatArray, fixed: FloatArray, distances: FloatArray) -> FloatArray:
    """Take one step of SMACOF of each point against points that are thought fixed, with unit weights."""
    ratio = product(-2 * points, fixed.T)
    ratio += (points**2).sum(axis=1)[:, None]
    ratio += (fixed**2).sum(axis=1)  # squared distances
    np.sqrt(np.maximum(ratio, 1e-12 * ratio.max(), out=ratio), out=ratio)
    np.divide(distances, ratio, out=ratio)
    return np.asarray(fixed.mean(axis=0) + (ratio.sum(axis=1)[:, None] * points - product(ratio, fixed)) / len(fixed))


def leading_scaling(distances: FloatArray, dimensions: int = 3) -> FloatArray:
    """Embed a full matrix of distances by classical scaling, with only the eigenvectors needed.

    `distances` (n, n); `dimensions`: dimension d of the embedding; gives (n, d).

    Examples
    --------
    >>> embedding = leading_scaling(np.array([[0.0, 3, 4], [3, 0, 5], [4, 5, 0]]))
    >>> round(raw_stress(embedding, np.array([[0.0, 3, 4], [3, 0, 5], [4, 5, 0]])), 6)
    0.0

    References
    ----------
    Torgerson, "Multidimensional scaling: I. Theory and method", 1952, doi:10.1007/BF02288916; paper, equation 4.
    """
    from scipy.sparse.linalg import ArpackError, eigsh

    count = len(distances)
    if count <= _DENSE:
        return classical_scaling(distances, dimensions)[0]
    gram = distances**2
    mean = gram.mean(axis=1)
    gram -= mean[:, None]
    gram -= mean - mean.mean()
    gram *= -0.5  # G = -½ J D² J
    begin = np.sin(np.arange(1.0, count + 1))  # any fixed vector that is not the constant one
    try:
        values, vectors = eigsh(gram, k=dimensions, which="LA", v0=begin)
    except ArpackError as error:
        raise SolverError("no_axes") from error
    order = np.argsort(-values)
    return vectors[:, order] * np.sqrt(np.maximum(values[order], 0.0))


def raw_stress(points: FloatArray, distances: FloatArray) -> float:
    """Sum the squared differences between straight and wanted distances over all pairs.

    `points` (n, d); `distances` (n, n).

    Examples
    --------
    >>> raw_stress(np.array([[0.0], [1.0]]), np.array([[0.0, 3.0], [3.0, 0.0]]))
    4.0
    """
    from scipy.spatial.distance import pdist, squareform

    return float(((pdist(points) - squareform(distances, checks=False)) ** 2).sum())
