"""The surface between the inside and the outside of a field on a grid."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..numerics.arrays import FloatArray, IntArray

_AROUND = ((0, 0), (-1, 0), (-1, -1), (0, -1))  # cells around an edge of the grid, across it


def surface_net(field: FloatArray, axes: Sequence[FloatArray]) -> tuple[FloatArray, IntArray]:
    """Triangulate field = 0: a vertex in each cell that the surface crosses, a quad around each edge that it crosses.

    `field` (k, k', k''); `axes`: coordinates of the grid, evenly spaced; gives vertices (n, 3), faces (m, 3).

    References
    ----------
    Gibson, "Constrained Elastic Surface Nets", 1998, doi:10.1007/BFb0056277.

    Examples
    --------
    >>> axis = np.linspace(-2.0, 2.0, 9)
    >>> x, y, z = np.meshgrid(axis, axis, axis, indexing="ij")
    >>> points, faces = surface_net(np.sqrt(x**2 + y**2 + z**2) - 1.3, (axis, axis, axis))
    >>> float(np.linalg.norm(points, axis=1).max().round(1)), len(points) - len(faces) // 2
    (1.3, 2)
    """
    cells = tuple(size - 1 for size in field.shape)
    inside = field < 0
    total, count = np.zeros((int(np.prod(cells)), 3)), np.zeros(int(np.prod(cells)), dtype=np.int64)
    rings = []
    for axis in range(3):
        here = tuple(slice(0, -1) if each == axis else slice(None) for each in range(3))
        there = tuple(slice(1, None) if each == axis else slice(None) for each in range(3))
        crossed = inside[here] != inside[there]
        at, first, last = np.argwhere(crossed), field[here][crossed], field[there][crossed]
        places = at.astype(float)
        places[:, axis] += first / (first - last)
        across = [(axis + 1) % 3, (axis + 2) % 3]
        ring = np.empty((len(at), 4), dtype=np.int64)
        for number, shift in enumerate(_AROUND):
            cell = at.copy()
            cell[:, across] += shift
            ring[:, number] = np.ravel_multi_index(tuple(cell.T), cells)
            np.add.at(total, ring[:, number], places)
            np.add.at(count, ring[:, number], 1)
        rings.append(np.where(inside[here][crossed][:, None], ring, ring[:, ::-1]))
    used = np.flatnonzero(count)
    start, step = (np.array([axis[place] for axis in axes]) for place in (0, 1))
    vertices = start + total[used] / count[used, None] * (step - start)
    return vertices, _cut(vertices, np.searchsorted(used, np.concatenate(rings)))


def _cut(vertices: FloatArray, quads: IntArray) -> IntArray:
    """Cut quads into triangles along the shorter diagonal."""
    a, b, c, d = (vertices[quads[:, corner]] for corner in range(4))
    first = (np.linalg.norm(a - c, axis=1) <= np.linalg.norm(b - d, axis=1))[:, None]
    one = np.where(first, quads[:, [0, 1, 2]], quads[:, [1, 2, 3]])
    two = np.where(first, quads[:, [0, 2, 3]], quads[:, [1, 3, 0]])
    return np.stack([one, two], axis=1).reshape(-1, 3)
