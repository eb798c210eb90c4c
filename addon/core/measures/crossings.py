"""Self-intersections of a surface: pairs of triangles that cross, and the edges that pass through triangles."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..numerics.arrays import FloatArray, IntArray
from ..run.monitor import Monitor

_CELLS = 8  # of the grid per triangle at most, on average
_AT_ONCE = 500_000  # pairs that are tested together
_SIDES = ((0, 1), (1, 2), (2, 0))


class Passes(NamedTuple):
    """Edges that pass through the interior of triangles.

    Attributes
    ----------
    pairs : (k,) ndarray of int
        The pair of triangles that each belongs to.
    edges : (k, 2) ndarray of int
        The two vertices of the edge.
    along : (k,) ndarray of float
        Where on the edge it passes, from 0 at its first vertex to 1.
    faces : (k,) ndarray of int
        The triangle.
    weights : (k, 3) ndarray of float
        Barycentric coordinates of the point in the triangle.
    """

    pairs: IntArray
    edges: IntArray
    along: FloatArray
    faces: IntArray
    weights: FloatArray


class _Grid(NamedTuple):
    """The cells of a grid that overlap the boxes of triangles, sorted."""

    cell: IntArray  # of each overlap
    box: IntArray
    first: IntArray  # (m, 3), cell of the lowest corner of each box
    extent: IntArray  # cells along each axis


def crossings(vertices: FloatArray, faces: IntArray, monitor: Monitor | None = None) -> IntArray:
    """Find the pairs of triangles that cross and have no vertex in common.

    Triangles are sorted into the cells of a grid; two in one cell cross if an edge of one passes through the interior
    of the other. Triangles that only touch, or lie in one plane, do not cross.

    `vertices` (n, 3); `faces` (m, 3); gives (c, 2).

    Examples
    --------
    >>> flat = [[0, 0, 0], [4, 0, 0], [0, 4, 0]]
    >>> upright = [[1, 1, -1], [1, 1, 1], [3, 3, 1]]
    >>> crossings(np.array(flat + upright, dtype=float), np.array([[0, 1, 2], [3, 4, 5]])).tolist()
    [[0, 1]]

    References
    ----------
    Möller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997, doi:10.1080/10867651.1997.10487468.
    """
    monitor = monitor or Monitor()
    corners = vertices[faces].transpose(2, 0, 1)  # (3, m, 3), axis by axis
    low, high = corners.min(axis=2), corners.max(axis=2)
    grid = _grid(low.T, high.T)
    cell = grid.cell
    last = np.searchsorted(cell, cell, side="right")
    after = last - np.arange(len(cell)) - 1  # in the same cell, after each
    found = []
    ends = np.cumsum(after)
    begin = 0
    while begin < len(cell):
        monitor.check()
        end = max(begin + 1, int(np.searchsorted(ends, (ends[begin - 1] if begin else 0) + _AT_ONCE)))
        some = np.arange(begin, min(end, len(cell)))
        first = np.repeat(some, after[some])
        second = first + 1 + np.arange(len(first)) - np.repeat(np.cumsum(after[some]) - after[some], after[some])
        one, two, here = grid.box[first], grid.box[second], cell[first]
        for lowest, highest in zip(low, high, strict=True):
            close = np.flatnonzero((lowest[one] <= highest[two]) & (lowest[two] <= highest[one]))
            one, two, here = one[close], two[close], here[close]
        x, y, z = np.maximum(grid.first[one], grid.first[two]).T
        counted = here == _cell(x, y, z, grid.extent)  # in one of their cells
        pairs = np.column_stack([one, two])[counted]
        apart = ~(faces[pairs[:, 0]][:, :, None] == faces[pairs[:, 1]][:, None]).any(axis=(1, 2))
        pairs = pairs[apart]
        found.append(pairs[np.unique(passes(vertices, faces, pairs).pairs)])
        begin = int(some[-1]) + 1
    return np.unique(np.concatenate([np.zeros((0, 2), dtype=np.int64), *found]), axis=0)


def passes(vertices: FloatArray, faces: IntArray, pairs: IntArray) -> Passes:
    """Find where the edges of triangles pass through other triangles.

    `vertices` (n, 3); `faces` (m, 3); `pairs` (c, 2).

    Examples
    --------
    >>> flat = [[0, 0, 0], [4, 0, 0], [0, 4, 0]]
    >>> upright = [[1, 1, -1], [1, 1, 1], [3, 3, 1]]
    >>> vertices, faces = np.array(flat + upright, dtype=float), np.array([[0, 1, 2], [3, 4, 5]])
    >>> found = passes(vertices, faces, np.array([[0, 1]]))
    >>> found.edges.tolist(), found.along.tolist(), found.faces.tolist(), found.weights.tolist()
    ([[3, 4]], [0.5], [0], [[0.5, 0.25, 0.25]])

    References
    ----------
    Möller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997, doi:10.1080/10867651.1997.10487468.
    """
    found = []
    for these, those in (pairs.T, pairs[:, ::-1].T):
        a, b, c = vertices[faces[those]].transpose(1, 0, 2)
        ends = vertices[faces[these]]
        heights = np.column_stack([_volume(ends[:, corner], a, b, c) for corner in range(3)])
        for start, end in _SIDES:
            some = np.flatnonzero(heights[:, start] * heights[:, end] < 0)  # on both sides of the plane
            p, q, u, v, w = ends[some, start], ends[some, end], a[some], b[some], c[some]
            turns = np.column_stack([_volume(p, q, v, w), _volume(p, q, w, u), _volume(p, q, u, v)])
            inside = (turns > 0).all(axis=1) | (turns < 0).all(axis=1)
            some, turns = some[inside], turns[inside]
            first, second = heights[some, start], heights[some, end]
            along, weights = first / (first - second), turns / turns.sum(axis=1, keepdims=True)
            edges = faces[these[some]][:, [start, end]]
            found.append(Passes(some, edges, along, those[some], weights))
    return Passes(*(np.concatenate(parts) for parts in zip(*found, strict=True)))


def _grid(low: FloatArray, high: FloatArray) -> _Grid:
    """Sort boxes into the cells of a grid."""
    size = float((high - low).max(axis=1).mean()) or 1.0
    while True:
        first = np.floor((low - low.min(axis=0)) / size).astype(np.int64)
        last = np.floor((high - low.min(axis=0)) / size).astype(np.int64)
        spans = last - first + 1
        counts = spans.prod(axis=1)
        if counts.sum() <= _CELLS * len(counts):
            break
        size *= 1.5
    box = np.repeat(np.arange(len(counts), dtype=np.int32), counts)
    step = np.arange(len(box), dtype=np.int32) - np.repeat((np.cumsum(counts) - counts).astype(np.int32), counts)
    height, depth = (spans[:, axis].astype(np.int32)[box] for axis in (1, 2))
    extent = last.max(axis=0) + 1
    x, y, z = first.T
    cell = _cell(x[box] + step // (height * depth), y[box] + step // depth % height, z[box] + step % depth, extent)
    order = np.lexsort((box, cell))
    return _Grid(cell[order], box[order], first, extent)


def _cell(x: IntArray, y: IntArray, z: IntArray, extent: IntArray) -> IntArray:
    """Assign each cell of a grid one number."""
    return (x * extent[1] + y) * extent[2] + z


def _volume(a: FloatArray, b: FloatArray, c: FloatArray, d: FloatArray) -> FloatArray:
    """Compute six times the signed volumes of tetrahedra."""
    return np.einsum("ij,ij->i", b - a, np.cross(c - a, d - a))
