"""SMACOF: least-squares multidimensional scaling of a full matrix of distances."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..numerics.arrays import FloatArray
from ..run.monitor import Monitor
from ..stress.majorisation import Majorisation
from ..stress.pairs import AllPairs


def smacof(
    distances: ArrayLike,
    start: ArrayLike,
    *,
    weights: ArrayLike | None = None,
    max_iterations: int = 300,
    tolerance: float = 1e-6,
    momentum: bool = True,
    monitor: Monitor | None = None,
) -> tuple[FloatArray, FloatArray]:
    """Embed points so that their distances fit given ones, from a start: ``Σ_{i<j} w_ij (δ_ij - d_ij)²``.

    `distances` (n, n); `start` (n, d); `weights` (n, n); gives embedding (n, d), history (s + 1,).

    Examples
    --------
    >>> points, history = smacof([[0, 3, 4], [3, 0, 5], [4, 5, 0]], [[0, 0], [1, 0], [0, 1]], tolerance=1e-9)
    >>> round(float(np.linalg.norm(points[1] - points[2])), 4)
    5.0

    References
    ----------
    De Leeuw, "Applications of convex analysis to multidimensional scaling", 1977.
    """
    wanted, begin = np.asarray(distances, dtype=np.float64), np.asarray(start, dtype=np.float64)
    count = len(wanted)
    heavy = np.ones_like(wanted) if weights is None else np.asarray(weights, dtype=np.float64)
    pairs = AllPairs(np.arange(count), wanted, heavy, count)
    solve = (lambda pulled: pulled / count) if weights is None else None  # V⁺ of equal weights
    return Majorisation([pairs], solve=solve).lowered(
        begin - begin.mean(axis=0), max_iterations, tolerance=tolerance, momentum=momentum, monitor=monitor
    )
