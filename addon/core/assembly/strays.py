"""Stray vertices: single vertices that were drawn far away from all their neighbours, such as into a body."""

from __future__ import annotations

import numpy as np

from ..deformation.rotations import nearest_rotations
from ..numerics.arrays import FloatArray, IntArray

_LONGER = 4.0  # least length of the edges of a stray vertex, in those between its neighbours
_FAN = 3  # least triangles around a stray vertex: fewer are a fin
_FAR = 20.0  # its least distance, in the width of the ring of its neighbours; the tip of a horn or a hair has 10


def stray_vertices(points: FloatArray, faces: IntArray) -> IntArray:
    """Find vertices that lie far from all neighbours, which lie near each other.

    `points` (n, 3); `faces` (m, 3); gives (s,).

    Examples
    --------
    >>> points = np.array([[0.0, 0, 50], [1, 0, 0], [0, 1, 0], [-1, -1, 0]])
    >>> stray_vertices(points, np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])).tolist()
    [0]
    """
    squared = np.zeros(faces.shape)  # lengths of the sides, each across a corner
    for coordinate in points.T:
        corners = coordinate[faces]
        squared += (np.roll(corners, 1, axis=1) - np.roll(corners, -1, axis=1)) ** 2
    least = squared.min(axis=1, keepdims=True)
    thin = np.flatnonzero((squared > _LONGER**2 * least).sum(axis=1) == 2)
    if not len(thin):
        return thin
    shortest = np.argmin(squared[thin], axis=1)
    far = np.bincount(faces[thin, shortest], minlength=len(points))
    apart = np.flatnonzero((far >= _FAN) & (far == np.bincount(faces.ravel(), minlength=len(points))))
    fans = _fans(faces[thin], apart)
    return np.array([each for each in apart.tolist() if _is_far(points, fans, each)], dtype=np.int64)


def drawn_in(points: FloatArray, faces: IntArray, strays: IntArray) -> FloatArray:
    """Move stray vertices to the middle of their neighbours. `points` (n, 3); `faces` (m, 3); `strays` (s,)."""
    moved, fans = points.copy(), _fans(faces, strays)
    for each in strays.tolist():
        moved[each] = points[_around(fans, each)].mean(axis=0)
    return moved


def followed(before: FloatArray, after: FloatArray, faces: IntArray, strays: IntArray) -> FloatArray:
    """Move stray vertices rigidly with their neighbours.

    `before` (n, 3); `after` (n, 3); `faces` (m, 3); `strays` (s,); gives their positions (s, 3).
    """
    moved, fans = np.empty((len(strays), 3)), _fans(faces, strays)
    for number, each in enumerate(strays.tolist()):
        ring = _around(fans, each)
        old, new = before[ring].mean(axis=0), after[ring].mean(axis=0)
        turn = nearest_rotations(((before[ring] - old).T @ (after[ring] - new))[None])[0]
        moved[number] = new + (before[each] - old) @ turn
    return moved


def _fans(faces: IntArray, vertices: IntArray) -> IntArray:
    """Find the triangles at some vertices, (f, 3): all that is searched for the neighbours of each."""
    return faces[np.isin(faces, vertices).any(axis=1)]


def _around(fans: IntArray, vertex: int) -> IntArray:
    """Find the neighbours of a vertex, (r,)."""
    ring = np.unique(fans[(fans == vertex).any(axis=1)])
    return ring[ring != vertex]


def _is_far(points: FloatArray, fans: IntArray, vertex: int) -> bool:
    """Check whether a vertex lies far from the ring of its neighbours."""
    ring = points[_around(fans, vertex)]
    middle = ring.mean(axis=0)
    width = np.linalg.norm(ring - middle, axis=1).max()
    return bool(np.linalg.norm(points[vertex] - middle) > _FAR * width)
