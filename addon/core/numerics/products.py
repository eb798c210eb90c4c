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

    `left` (r, k); `right` (k, c); gives (r, c).

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
