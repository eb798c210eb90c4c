"""Struts: pairs of vertices that face each other through the interior, which preserve the interior."""

from __future__ import annotations

import numpy as np

from ..mesh.edges import is_closed
from ..mesh.geometry import area_vectors, signed_volume, vertex_normals
from ..numerics.arrays import FloatArray, IntArray
from ..numerics.products import product
from ..run.monitor import Monitor

_REACH = 0.3  # radius of the widest ball, in units of sqrt(area)
_WAY, _DETOUR = 0.13, 2.0  # longest path on the surface: this, plus so many times the strut
_FACING = 0.5  # least cosine between a strut and the normals at its ends
_TOUCH = 0.02  # share of the radius within which a ball touches a vertex
_TIE = 1e-6  # share within which vertices are equally far, the lower index first
_ROWS = 128
_OPENNESS, _VOLUME = 0.1, 0.002  # open meshes above the first or below the second, over area and area^1.5, are sheets


def struts_through(
    points: FloatArray, faces: IntArray, to_features: FloatArray, monitor: Monitor | None = None
) -> IntArray:
    """Pair vertices with those that face them through the body, where the body is thin.

    At each vertex the largest ball inside the body that contains no other vertex is found. The vertex that it touches,
    the farthest if there are several, is the other end. These pairs contain what a surface alone does not, that a mouth
    is a hole in a head and not a pouch on it, and they change little with the pose. Pairs that are far from each other
    on the surface, according to their distances from the feature points, are left out: they join limbs that the pose
    pushed into each other. A sheet has no interior and no struts.

    `points` (n, 3); `faces` (m, 3); `to_features` (n, k); gives (s, 2).

    Examples
    --------
    >>> rim = [[0.5, 0, 0], [0, 0.5, 0], [-0.5, 0, 0], [0, -0.5, 0]]
    >>> lens = np.array([*rim, [0, 0, 0.05], [0, 0, -0.05]])
    >>> faces = np.array([[i, (i + 1) % 4, 4] for i in range(4)] + [[(i + 1) % 4, i, 5] for i in range(4)])
    >>> struts_through(lens, faces, np.zeros((6, 1))).tolist()
    [[4, 5]]

    References
    ----------
    The balls: Ma, Bae and Choi, "3D medial axis point approximation using nearest neighbors and the normal field",
    2012.
    """
    if not _has_inside(points, faces):
        return np.empty((0, 2), dtype=np.int64)
    normals = np.sign(signed_volume(points, faces)) * vertex_normals(points, faces)
    other = np.arange(len(points))
    square = (points**2).sum(axis=1)
    for start in range(0, len(points), _ROWS):
        if monitor is not None:
            monitor.check()
        rows = slice(start, start + _ROWS)
        apart = np.maximum(square[rows, None] + square - 2 * product(points[rows], points.T), 0.0)  # squared
        depth = np.einsum("ij,ij->i", points[rows], normals[rows])[:, None] - product(normals[rows], points.T)
        inside = depth > 1e-9
        radius = np.divide(apart, 2 * depth, out=np.full_like(apart, np.inf), where=inside)  # of the ball through both
        widest = radius.min(axis=1, keepdims=True)
        apart[radius > (1 + _TOUCH) * widest] = -1.0
        farthest = apart.max(axis=1, keepdims=True)
        found = np.argmax(apart >= (1 - _TIE) * farthest, axis=1)
        other[rows] = np.where(widest[:, 0] < _REACH, found, other[rows])
    here = np.flatnonzero(other != np.arange(len(points)))
    other = other[here]
    away = points[here] - points[other]
    length = np.linalg.norm(away, axis=1)
    away /= np.maximum(length, np.finfo(float).tiny)[:, None]
    faces_it = np.einsum("ij,ij->i", away, normals[here]) > _FACING
    faces_it &= np.einsum("ij,ij->i", away, normals[other]) < -_FACING
    faces_it &= np.abs(to_features[here] - to_features[other]).max(axis=1) < _WAY + _DETOUR * length
    pairs = np.sort(np.column_stack([here, other])[faces_it], axis=1)
    return np.unique(pairs, axis=0)


def _has_inside(points: FloatArray, faces: IntArray) -> bool:
    """Distinguish a body, possibly with holes, from a sheet."""
    if is_closed(faces):
        return True
    openness = float(np.linalg.norm(area_vectors(points, faces).sum(axis=0)))
    return openness < _OPENNESS and abs(signed_volume(points, faces)) > _VOLUME
