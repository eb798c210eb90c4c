"""Ramps: how far values are from one bound to another, 0 to 1."""

from __future__ import annotations

import numpy as np

from .arrays import FloatArray


def ramp(values: FloatArray | float, start: float, end: float) -> FloatArray:
    """Rise linearly from 0 at one bound to 1 at another, and stay there.

    `values`: any shape; `start, end`: where the ramp is 0 and 1; the first may be the larger one.

    Examples
    --------
    >>> ramp(np.array([0.0, 2.5, 9.0]), 2.0, 4.0).tolist()
    [0.0, 0.25, 1.0]
    """
    return np.asarray(np.clip((values - start) / (end - start), 0.0, 1.0))


def smooth_ramp(values: FloatArray | float, start: float, end: float) -> FloatArray:
    """Rise from 0 at one bound to 1 at another, level at both (the cubic smooth step).

    Examples
    --------
    >>> smooth_ramp(np.array([0.0, 2.5, 9.0]), 2.0, 4.0).tolist()
    [0.0, 0.15625, 1.0]
    """
    share = ramp(values, start, end)
    return np.asarray(share * share * (3 - 2 * share))
