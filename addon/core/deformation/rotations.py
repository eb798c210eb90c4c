"""Rotations nearest to matrices."""

from __future__ import annotations

import numpy as np

from ..numerics.arrays import FloatArray
from ..numerics.blocks import AT_ONCE

_CLEAR = 1e-3  # times the cube of a covariance's size: below, its nearest rotation is too ambiguous for this method
_NEWTON_STEPS = 20  # at most, towards the largest root of a quartic, from above
_ARRIVED = 1e-15  # a step as short


def nearest_rotations(covariances: FloatArray) -> FloatArray:
    """Compute the proper rotation nearest to each covariance.

    `covariances` (n, 3, 3); gives (n, 3, 3).

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
    b = covariances.reshape(-1, 9).T.copy()  # (9, n), row by row
    b /= np.maximum(np.abs(b).max(axis=0), tiny)
    b /= np.maximum(np.sqrt((b * b).sum(axis=0)), tiny)
    scaled = np.ascontiguousarray(b.T).reshape(-1, 3, 3)
    c = np.array([  # cofactors
        b[4] * b[8] - b[5] * b[7], b[5] * b[6] - b[3] * b[8], b[3] * b[7] - b[4] * b[6],
        b[2] * b[7] - b[1] * b[8], b[0] * b[8] - b[2] * b[6], b[1] * b[6] - b[0] * b[7],
        b[1] * b[5] - b[2] * b[4], b[2] * b[3] - b[0] * b[5], b[0] * b[4] - b[1] * b[3],
    ])  # fmt: skip
    determinant = b[0] * c[0] + b[1] * c[1] + b[2] * c[2]
    minors = 4 * (c * c).sum(axis=0)
    best = np.full(len(scaled), np.sqrt(3.0))  # the sum of the singular values, the last with the determinant's sign
    for _ in range(_NEWTON_STEPS):
        over = best * best - 1
        step = (over * over - 8 * best * determinant - minors) / (4 * best * over - 8 * determinant)
        best -= step
        if np.abs(step).max(initial=0.0) < _ARRIVED:
            break
    kappa = (best * best - 1) / 2
    zeta = kappa * best - determinant
    clear = zeta > _CLEAR
    zeta[~clear] = 1.0
    cubic = scaled @ (scaled.transpose(0, 2, 1) @ scaled)
    rotation = ((kappa + 1) * b + best * c - cubic.reshape(-1, 9).T) / zeta
    rotation = np.ascontiguousarray(rotation.T).reshape(-1, 3, 3)
    if not clear.all():
        left, _, right = np.linalg.svd(covariances[~clear])
        left[:, :, -1] *= np.sign(np.linalg.det(left @ right))[:, None]
        rotation[~clear] = left @ right
    return rotation
