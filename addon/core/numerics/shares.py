"""Shares of a whole: what falls to each part."""

from __future__ import annotations

import numpy as np

from .arrays import FloatArray, IntArray


def spread(share: FloatArray, count: int) -> IntArray:
    """Choose parts, such as vertices or triangles, as often as their share asks for, in their order.

    `share` (n,): of the area, 1 in total; `count`: how many are chosen; gives (count,), ascending.

    Examples
    --------
    >>> spread(np.array([0.25, 0.5, 0.25]), 4).tolist()
    [0, 1, 1, 2]
    """
    steps = (np.arange(count) + 0.5) / count
    return np.minimum(np.searchsorted(np.cumsum(share), steps), len(share) - 1)
