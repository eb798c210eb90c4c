"""The points of a surface that are closest to given ones."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..numerics.arrays import FloatArray, IntArray
from ..run.monitor import Monitor

_CENTRES = 6  # nearest centres of triangles whose triangles are examined,
_CORNERS = 2  # and nearest vertices, with
_AROUND = 8  # as many triangles around each
_AT_ONCE = 4096  # points per batch: their triangles stay in the cache; cancellation is polled between batches
_AROUND_KNOWN = 12  # triangles around a vertex that is known to be the nearest


class SurfacePoints(NamedTuple):
    """Points on the triangles of a surface.

    Attributes
    ----------
    faces : (q,) ndarray of int
        The triangle of each.
    weights : (q, 3) ndarray of float
        Its barycentric coordinates there: not negative, their sum is 1.
    distances : (q,) ndarray of float
        Its distance from the query point.
    """

    faces: IntArray
    weights: FloatArray
    distances: FloatArray

    def on(self, values: FloatArray, faces: IntArray) -> FloatArray:
        """Interpolate values on the vertices of the surface, or of another with the same triangles, at the points.

        `values` (n, d); `faces` (m, 3); gives (q, d).

        Examples
        --------
        >>> points = SurfacePoints(np.array([0]), np.array([[0.5, 0.5, 0]]), np.zeros(1))
        >>> points.on(np.array([[0.0], [2], [9]]), np.array([[0, 1, 2]])).tolist()
        [[1.0]]
        """
        return np.einsum("ij,ijk->ik", self.weights, values[faces[self.faces]])

    def nearest_corners(self, faces: IntArray) -> IntArray:
        """Find the corner of its triangle that is nearest to each point.

        `faces` (m, 3); gives (q,).

        Examples
        --------
        >>> points = SurfacePoints(np.array([0]), np.array([[0.2, 0.7, 0.1]]), np.zeros(1))
        >>> points.nearest_corners(np.array([[4, 5, 6]])).tolist()
        [5]
        """
        return faces[self.faces, np.argmax(self.weights, axis=1)]


def closest_points(
    points: FloatArray, faces: IntArray, wanted: FloatArray, monitor: Monitor | None = None
) -> SurfacePoints:
    """Find the closest point of a surface to each query point.

    Only triangles near the closest vertices and centres are examined: a long, thin triangle whose corners and centre
    are farther away than those of several others may be missed.

    `points` (n, d); `faces` (m, 3); `wanted` (q, d).

    Examples
    --------
    >>> corner = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    >>> found = closest_points(corner, np.array([[0, 1, 2]]), np.array([[0.25, 0.25, 2.0], [-1, 0.5, 0]]))
    >>> found.weights.tolist(), found.distances.tolist()
    ([[0.5, 0.25, 0.25], [0.5, 0.0, 0.5]], [2.0, 1.0])

    References
    ----------
    Ericson, "Real-Time Collision Detection", 2005, section 5.1.5.
    """
    from scipy.spatial import cKDTree

    monitor = monitor or Monitor()
    used = np.unique(faces)
    centres = cKDTree(points[faces].mean(axis=1))
    monitor.check()
    corners = cKDTree(points[used])
    count, corner_count = min(_CENTRES, len(faces)), min(_CORNERS, len(used))
    around = triangles_around(faces, len(points), _AROUND)
    found = []
    for start in range(0, max(len(wanted), 1), _AT_ONCE):
        monitor.check()
        aim = wanted[start : start + _AT_ONCE]
        near = centres.query(aim, k=range(1, count + 1))[1]  # (q', k)
        beside = around[used[corners.query(aim, k=range(1, corner_count + 1))[1]]].reshape(
            len(aim), corner_count * _AROUND
        )
        found.append(closest_among(points, faces, aim, np.column_stack([near, beside])))
    return SurfacePoints(*(np.concatenate(parts) for parts in zip(*found, strict=True)))


def closest_around(points: FloatArray, faces: IntArray, wanted: FloatArray, nearest: IntArray) -> SurfacePoints:
    """Find the closest point to each query point on the triangles around a vertex.

    `points` (n, d); `faces` (m, 3); `wanted` (q, d); `nearest` (q,).

    Examples
    --------
    >>> corner = np.array([[0.0, 0], [1, 0], [0, 1]])
    >>> closest_around(corner, np.array([[0, 1, 2]]), np.array([[0.25, 0.5]]), np.array([0])).weights.tolist()
    [[0.25, 0.25, 0.5]]
    """
    return closest_among(points, faces, wanted, triangles_around(faces, len(points), _AROUND_KNOWN)[nearest])


def triangles_around(faces: IntArray, count: int, most: int) -> IntArray:
    """List triangles around every vertex.

    `faces` (m, 3); `count`: number n of vertices; `most`: number of triangles to list; if there are fewer, the last
    is repeated; if there is none, any is used; gives (n, most).

    Examples
    --------
    >>> triangles_around(np.array([[0, 1, 2], [2, 1, 3]]), 4, 2).tolist()
    [[0, 0], [0, 1], [0, 1], [1, 1]]
    """
    order = np.argsort(faces.ravel(), kind="stable")
    start = np.searchsorted(faces.ravel()[order], np.arange(count + 1))
    last = np.maximum(start[1:] - 1, start[:-1])
    at = np.minimum(start[:-1, None] + np.arange(most), last[:, None])
    return order[np.minimum(at, len(order) - 1)] // 3


def closest_among(points: FloatArray, faces: IntArray, wanted: FloatArray, candidates: IntArray) -> SurfacePoints:
    """Find the closest point to each query point on its candidate triangles.

    `points` (n, d); `faces` (m, 3); `wanted` (q, d); `candidates` (q, c).

    Examples
    --------
    >>> corner = np.array([[0.0, 0], [1, 0], [0, 1]])
    >>> faces, candidates = np.array([[0, 1, 2]]), np.array([[0]])
    >>> closest_among(corner, faces, np.array([[0.5, -1]]), candidates).weights.tolist()
    [[0.5, 0.5, 0.0]]
    """
    least = np.full(len(wanted), np.inf)
    face, weights = np.zeros(len(wanted), dtype=np.int64), np.zeros((len(wanted), 3))
    for own in candidates.T:
        corners = points[faces[own]]  # (q, 3, d)
        at = _barycentric(corners[:, 0], corners[:, 1], corners[:, 2], wanted)
        apart = np.einsum("qi,qij->qj", at, corners) - wanted
        square = _dot(apart, apart)
        closer = square < least
        least[closer], face[closer], weights[closer] = square[closer], own[closer], at[closer]
    return SurfacePoints(face, weights, np.sqrt(least))


def _barycentric(a: FloatArray, b: FloatArray, c: FloatArray, wanted: FloatArray) -> FloatArray:
    """Compute the barycentric coordinates of the closest points of triangles."""
    ab, ac, ap = b - a, c - a, wanted - a
    aa, cross, cc, first, second = (_dot(*pair) for pair in ((ab, ab), (ab, ac), (ac, ac), (ap, ab), (ap, ac)))
    area = aa * cc - cross * cross
    safe = np.where(area > 0, area, 1.0)
    v, w = (cc * first - cross * second) / safe, (aa * second - cross * first) / safe
    weights = np.stack([1 - v - w, v, w], axis=1)
    outside = (weights < 0).any(axis=1) | (area <= 0)
    if outside.any():
        weights[outside] = _on_edges([each[outside] for each in (a, b, c)], wanted[outside])
    return weights


def _on_edges(corners: list[FloatArray], wanted: FloatArray) -> FloatArray:
    """Compute the barycentric coordinates of the closest points on the edges of triangles."""
    least, weights = np.full(len(wanted), np.inf), np.zeros((len(wanted), 3))
    for first, second in ((0, 1), (1, 2), (2, 0)):
        start, way = corners[first], corners[second] - corners[first]
        length = _dot(way, way)
        along = np.clip(_dot(wanted - start, way) / np.where(length > 0, length, 1.0), 0.0, 1.0)
        apart = start + along[:, None] * way - wanted
        square = _dot(apart, apart)
        closer = square < least
        least[closer] = square[closer]
        weights[closer] = 0.0
        weights[closer, first], weights[closer, second] = 1 - along[closer], along[closer]
    return weights


def _dot(one: FloatArray, two: FloatArray) -> FloatArray:
    """Multiply vectors row by row."""
    return np.asarray(np.einsum("ij,ij->i", one, two))
