"""Large dense computations in blocks: bounded memory, and cancellation between blocks."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .arrays import FloatArray

AT_ONCE = 8192  # rows of a few numbers each: they stay in the cache from one step of a formula to the next
_COLUMNS = 32  # maximum number of right-hand sides at once: more do not fit the cache and take longer each
_VALUES = 200_000  # maximum number of values at once
_ROWS = 128


def columns_at_once(rows: int) -> int:
    """Choose how many right-hand sides of a linear system to solve together.

    `rows`: unknowns of the system.

    Examples
    --------
    >>> columns_at_once(1_000), columns_at_once(1_000_000)
    (32, 4)
    """
    return int(np.clip(_VALUES // rows, 4, _COLUMNS))


def symmetrise(matrix: FloatArray, check: Callable[[], object]) -> None:
    """Replace a square matrix by the mean of itself and its transpose, in place.

    `matrix` (n, n); `check`: called between blocks; raises if the run is cancelled.

    Examples
    --------
    >>> matrix = np.array([[0.0, 2.0], [4.0, 0.0]])
    >>> symmetrise(matrix, lambda: None)
    >>> matrix.tolist()
    [[0.0, 3.0], [3.0, 0.0]]
    """
    for start in range(0, len(matrix), _ROWS):
        check()
        stop = start + _ROWS
        mean = (matrix[start:stop, start:] + matrix[start:, start:stop].T) / 2
        matrix[start:stop, start:] = mean
        matrix[start:, start:stop] = mean.T
