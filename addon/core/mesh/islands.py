"""Islands of values on corners: parts of a surface on which they have no seam."""

from __future__ import annotations

import numpy as np

from ..numerics.arrays import FloatArray, IntArray
from .connectivity import component_labels


def island_labels(faces: IntArray, values: FloatArray) -> IntArray:
    """Find the parts of a surface on which values of corners agree across edges.

    `faces` (m, 3); `values` (m, 3, d); gives (m,).

    Examples
    --------
    >>> faces = np.array([[0, 1, 2], [2, 1, 3]])
    >>> whole = np.array([[0.0, 0], [1, 0], [0, 1], [1, 1]])[faces]
    >>> cut = whole + np.array([0.0, 5.0])[:, None, None]
    >>> island_labels(faces, whole).tolist(), island_labels(faces, cut).tolist()
    ([0, 0], [0, 1])
    """
    tail, head = faces[:, [0, 1, 2]].reshape(-1), faces[:, [1, 2, 0]].reshape(-1)
    first = values.reshape(len(tail), -1)
    second = values[:, [1, 2, 0]].reshape(len(tail), -1)
    forward = (tail < head)[:, None]
    ends = np.where(forward, np.column_stack([tail, head]), np.column_stack([head, tail]))
    sides = np.column_stack([ends, np.where(forward, first, second), np.where(forward, second, first)])
    order = np.lexsort(sides.T[::-1])
    same = (np.diff(sides[order], axis=0) == 0).all(axis=1)
    face = order // 3
    return component_labels(len(faces), np.column_stack([face[:-1], face[1:]])[same])
