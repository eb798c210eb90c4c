"""Rotations nearest to matrices."""

from __future__ import annotations

import numpy as np

from ..numerics.arrays import FloatArray
from ..numerics.blocks import AT_ONCE

_CLEAR = 1e-3  # times the cube of a covariance's size: below, its nearest rotation is too ambiguous for this method
_NEWTON_STEPS = 20  # towards the largest root of a quartic, from above


def nearest_rotations(covariances: FloatArray) -> FloatArray:
    """Compute the proper rotation nearest to each covariance.

    Parameters
    ----------
    covariances : (n, 3, 3) ndarray of float
        Covariances of vectors, those before by row and those after by column.

    Returns
    -------
    (n, 3, 3) ndarray of float
        Rotations, applied from the right: ``x ↦ x R``.

    Examples
    --------
    >>> quarter = np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]])
    >>> np.allclose(nearest_rotations(np.stack([quarter, 3 * quarter])), quarter)
    True

    References
    ----------
    Markley, "Attitude determination using vector observations: a fast optimal matrix algorithm", 1993. Where two
    rotations fit almost as well, singular values decide.
    """
    rotations = np.empty_like(covariances)
    for start in range(0, len(covariances), AT_ONCE):
        some = slice(start, start + AT_ONCE)
        rotations[some] = _nearest_at_once(covariances[some])
    return rotations


def _nearest_at_once(covariances: FloatArray) -> FloatArray:
    """Compute the rotations of a batch of covariances that stays in the cache."""
    tiny = np.finfo(float).tiny
    scaled = covariances / np.maximum(np.abs(covariances).max(axis=(1, 2)), tiny)[:, None, None]
    scaled /= np.maximum(np.sqrt(np.einsum("ijk,ijk->i", scaled, scaled)), tiny)[:, None, None]
    b = [np.ascontiguousarray(scaled[:, i, j]) for i in range(3) for j in range(3)]  # row by row
    c = [b[4] * b[8] - b[5] * b[7], b[5] * b[6] - b[3] * b[8], b[3] * b[7] - b[4] * b[6],
         b[2] * b[7] - b[1] * b[8], b[0] * b[8] - b[2] * b[6], b[1] * b[6] - b[0] * b[7],
         b[1] * b[5] - b[2] * b[4], b[2] * b[3] - b[0] * b[5], b[0] * b[4] - b[1] * b[3]]  # cofactors  # fmt: skip
    determinant = b[0] * c[0] + b[1] * c[1] + b[2] * c[2]
    minors = 4 * sum(each * each for each in c)
    best = np.full(len(scaled), np.sqrt(3.0))  # the sum of the singular values, the last with the determinant's sign
    for _ in range(_NEWTON_STEPS):
        over = best * best - 1
        best -= (over * over - 8 * best * determinant - minors) / (4 * best * over - 8 * determinant)
    kappa = (best * best - 1) / 2
    zeta = kappa * best - determinant
    clear = zeta > _CLEAR
    zeta[~clear] = 1.0
    rotation = np.empty_like(covariances)
    gram = np.einsum("nji,njk->nik", scaled, scaled)
    cubic = np.einsum("nij,njk->nik", scaled, gram)
    for at in range(9):
        i, j = divmod(at, 3)
        rotation[:, i, j] = ((kappa + 1) * b[at] + best * c[at] - cubic[:, i, j]) / zeta
    if not clear.all():
        left, _, right = np.linalg.svd(covariances[~clear])
        left[:, :, -1] *= np.sign(np.linalg.det(left @ right))[:, None]
        rotation[~clear] = left @ right
    return rotation
