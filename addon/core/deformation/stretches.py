"""Stretches between covariances: maps from one cloud of vectors to another without rotation."""

from __future__ import annotations

import numpy as np

from ..numerics.arrays import FloatArray

_LEAST = 1e-6  # minimum of an eigenvalue, over the largest: flat covariances have no stretch across
_MOST = 10.0  # stretch, either way


def stretch_between(before: FloatArray, after: FloatArray) -> FloatArray:
    """Compute the symmetric positive matrices that map covariances to others.

    `before, after` (n, 3, 3); gives (n, 3, 3).

    Examples
    --------
    >>> stretch_between(np.diag([4.0, 1, 9])[None], np.diag([1.0, 4, 9])[None])[0].diagonal().round(6).tolist()
    [0.5, 2.0, 1.0]

    References
    ----------
    ``U = C^-1/2 (C^1/2 D C^1/2)^1/2 C^-1/2``: Olkin and Pukelsheim, "The distance between two random vectors with given
    dispersion matrices", 1982, doi:10.1016/0024-3795(82)90112-4.
    """
    root, inverse = _roots(before)
    values, vectors = np.linalg.eigh(inverse @ _roots(root @ after @ root)[0] @ inverse)
    return np.asarray((vectors * np.clip(values, 1 / _MOST, _MOST)[:, None, :]) @ vectors.transpose(0, 2, 1))


def _roots(matrices: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Compute the square roots of symmetric matrices, and their inverses."""
    values, vectors = np.linalg.eigh(matrices)
    values = np.sqrt(np.maximum(values, np.maximum(_LEAST * values[:, -1:], np.finfo(float).tiny)))
    flipped = vectors.transpose(0, 2, 1)
    return (vectors * values[:, None, :]) @ flipped, (vectors / values[:, None, :]) @ flipped
