"""Matrix products in blocks so small that a linear algebra library runs each on one thread.

If the threads of a library have to be woken, or share their cores with another program, they wait for each other longer
than such products take: 5 to 80 ms at a time were measured.
"""

from __future__ import annotations

import numpy as np

from .arrays import FloatArray

_LIMIT = 64**3  # multiplications that OpenBLAS still does on one thread
_SIDE = 64


def product(left: FloatArray, right: FloatArray) -> FloatArray:
    """Multiply two matrices block by block.

    Parameters
    ----------
    left : (r, k) ndarray of float
        A matrix.
    right : (k, c) ndarray of float
        Another.

    Returns
    -------
    (r, c) ndarray of float
        Their product.

    Examples
    --------
    >>> product(np.array([[1.0, 2]]), np.array([[3.0], [4]])).tolist()
    [[11.0]]
    >>> product(np.ones((100, 80)), np.ones((80, 90))).sum().item()
    720000.0
    """
    (rows, inner), columns = left.shape, right.shape[1]
    if rows * inner * columns <= _LIMIT:
        return np.asarray(left @ right)
    wide = min(columns, _SIDE)
    deep = min(inner, _LIMIT // (_SIDE * wide))
    high = _LIMIT // (wide * deep)
    result = np.empty((rows, columns))
    for i in range(0, rows, high):
        for j in range(0, columns, wide):
            block = result[i : i + high, j : j + wide]
            np.matmul(left[i : i + high, :deep], right[:deep, j : j + wide], out=block)
            for k in range(deep, inner, deep):
                block += left[i : i + high, k : k + deep] @ right[k : k + deep, j : j + wide]
    return result


def inverse_of_lower(lower: FloatArray) -> FloatArray:
    """Invert a small lower triangular matrix row by row, without waking a library's threads.

    Parameters
    ----------
    lower : (n, n) ndarray of float
        The matrix; what lies above the diagonal is not read.

    Returns
    -------
    (n, n) ndarray of float
        Its inverse, lower triangular.

    Examples
    --------
    >>> inverse_of_lower(np.array([[2.0, 0], [1, 1]])).tolist()
    [[0.5, 0.0], [-0.5, 1.0]]
    """
    result = np.zeros_like(lower)
    for row, scale in enumerate(1 / np.diag(lower)):
        result[row, :row] = -scale * (lower[row, :row] @ result[:row, :row])
        result[row, row] = scale
    return result
