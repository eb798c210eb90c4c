"""Rows of one table looked up in another."""

from __future__ import annotations

import numpy as np

from ..numerics.arrays import IntArray


def rows_in(rows: IntArray, table: IntArray) -> IntArray:
    """Look up rows of three in a table.

    `rows` (q, 3); `table` (m, 3); gives (q,).

    Examples
    --------
    >>> rows_in(np.array([[3, 4, 5], [9, 9, 9]]), np.array([[0, 1, 2], [3, 4, 5]])).tolist()
    [1, -1]
    """
    both = np.concatenate([table, rows])
    order = np.lexsort(both.T[::-1])
    group = np.empty(len(both), dtype=np.int64)
    group[order] = np.cumsum(np.concatenate([[0], (np.diff(both[order], axis=0) != 0).any(axis=1)]))
    number = np.full(len(both), -1)
    number[group[: len(table)]] = np.arange(len(table))
    return number[group[len(table) :]]
