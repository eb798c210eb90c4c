"""Self-intersections of a surface: pairs of triangles that cross."""

from __future__ import annotations

import numpy as np

from ..numerics.arrays import FloatArray, IntArray
from ..run.monitor import Monitor

_CELLS = 8  # of the grid per triangle at most, on average
_AT_ONCE = 500_000  # pairs that are tested together
_SIDES = ((0, 1), (1, 2), (2, 0))


def crossings(vertices: FloatArray, faces: IntArray, monitor: Monitor | None = None) -> IntArray:
    """Find the pairs of triangles that cross and have no vertex in common.

    Triangles are sorted into the cells of a grid; two in one cell cross if an edge of one passes through the interior
    of the other. Triangles that only touch, or lie in one plane, do not cross.

    Parameters
    ----------
    vertices : (n, 3) ndarray of float
        Vertices.
    faces : (m, 3) ndarray of int
        Triangles.
    monitor : Monitor, optional
        Polled for cancellation.

    Returns
    -------
    (c, 2) ndarray of int
        Pairs of triangles, the lower number first, in ascending order.

    Raises
    ------
    CancelledError
        If the run is cancelled.

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
    corners = vertices[faces]  # (m, 3, 3)
    low, high = corners.min(axis=1), corners.max(axis=1)
    cell, inside = _in_cells(low, high)
    order = np.lexsort((inside, cell))
    cell, inside = cell[order], inside[order]
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
        pairs = np.column_stack([inside[first], inside[second]])
        one, two = pairs.T
        close = ((low[one] <= high[two]) & (low[two] <= high[one])).all(axis=1)
        pairs = np.unique(pairs[close], axis=0)
        apart = ~(faces[pairs[:, 0]][:, :, None] == faces[pairs[:, 1]][:, None]).any(axis=(1, 2))
        pairs = pairs[apart]
        found.append(pairs[_cross(corners[pairs[:, 0]], corners[pairs[:, 1]])])
        begin = int(some[-1]) + 1
    return np.unique(np.concatenate([np.zeros((0, 2), dtype=np.int64), *found]), axis=0)


def _in_cells(low: FloatArray, high: FloatArray) -> tuple[IntArray, IntArray]:
    """Sort boxes into the cells of a grid; return a cell and a box for each pair that overlaps."""
    size = float((high - low).max(axis=1).mean()) or 1.0
    while True:
        first = np.floor((low - low.min(axis=0)) / size).astype(np.int64)
        last = np.floor((high - low.min(axis=0)) / size).astype(np.int64)
        spans = last - first + 1
        counts = spans.prod(axis=1)
        if counts.sum() <= _CELLS * len(counts):
            break
        size *= 1.5
    box = np.repeat(np.arange(len(counts)), counts)
    step = np.arange(len(box)) - np.repeat(np.cumsum(counts) - counts, counts)
    _, height, depth = spans[box].T
    at = first[box] + np.column_stack([step // (height * depth), step // depth % height, step % depth])
    extent = last.max(axis=0) + 1
    return (at[:, 0] * extent[1] + at[:, 1]) * extent[2] + at[:, 2], box


def _cross(ones: FloatArray, others: FloatArray) -> np.ndarray:
    """Determine which pairs of triangles cross: an edge of either passes through the other."""
    crossing = np.zeros(len(ones), dtype=bool)
    for these, those in ((ones, others), (others, ones)):
        a, b, c = those.transpose(1, 0, 2)
        for start, end in _SIDES:
            crossing |= _passes(these[:, start], these[:, end], a, b, c)
    return crossing


def _passes(p: FloatArray, q: FloatArray, a: FloatArray, b: FloatArray, c: FloatArray) -> np.ndarray:
    """Determine which segments from p to q pass through the interior of their triangle."""
    above, below = _volume(p, a, b, c), _volume(q, a, b, c)
    turns = np.column_stack([_volume(p, q, a, b), _volume(p, q, b, c), _volume(p, q, c, a)])
    inside = (turns > 0).all(axis=1) | (turns < 0).all(axis=1)
    return np.asarray((above * below < 0) & inside)


def _volume(a: FloatArray, b: FloatArray, c: FloatArray, d: FloatArray) -> FloatArray:
    """Compute six times the signed volumes of tetrahedra."""
    return np.einsum("ij,ij->i", b - a, np.cross(c - a, d - a))
