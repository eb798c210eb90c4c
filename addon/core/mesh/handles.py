"""The handles of a surface, like that of a mug: where skin has grown together there often is one."""

from __future__ import annotations

import numpy as np

from ..numerics.arrays import IntArray
from .connectivity import border_labels
from .edges import edge_table


def handle_count(faces: IntArray) -> int:
    """Count the handles of a connected surface whose borders are closed.

    `faces` (m, 3); gives 0 for one with only one side, or with edges of more than two triangles.

    Examples
    --------
    >>> handle_count(np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])), handle_count(np.array([[0, 1, 2]]))
    (0, 0)
    """
    table = edge_table(faces)
    first, second = table.order[table.start[table.count == 2]], table.order[table.start[table.count == 2] + 1]
    if (table.count > 2).any() or (table.tail[first] == table.tail[second]).any():
        return 0
    borders = len(np.setdiff1d(border_labels(faces, table), [-1]))
    euler = len(np.unique(faces)) - len(table.count) + len(faces) + borders
    return max((2 - euler) // 2, 0)
