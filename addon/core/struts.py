"""Struts: pairs of vertices that face each other through the flesh, so that what is inside stays inside."""

from __future__ import annotations

import numpy as np

from .monitor import Monitor
from .stress import PairSet
from .surface import FloatArray, IntArray, area_vectors, signed_volume

_REACH = 0.3  # radius of the widest ball, in units of sqrt(area)
_WAY, _DETOUR = 0.13, 2.0  # longest way on the surface: this, and so many times the strut
_FACING = 0.5  # least cosine between a strut and the normals at its ends
_ROUNDS = 12  # balls settle in about 6
_CONTACTS, _TOUCH = 4, 1e-6  # most vertices that a ball rests on, and how nearly
_SHARE = 0.5  # weight of a strut in the stress, over all the weight of one of its ends


def struts_through(
    points: FloatArray, faces: IntArray, to_features: FloatArray, monitor: Monitor | None = None
) -> IntArray:
    """Pair vertices with those that face them through the body, where the body is thin.

    From each vertex a ball is let into the body, as wide as it can be without another vertex inside. The vertices that
    it rests on, more than one where the body is symmetric, are the other ends. What a surface alone does not know, that
    a mouth is a hole in a head and no pouch on it, is in these pairs; and they change little with the pose. Pairs that
    are far from each other on the surface are left out: they join limbs that the pose pushed into each other.

    Parameters
    ----------
    points : (n, 3) ndarray of float
        Vertices, of unit area.
    faces : (m, 3) ndarray of int
        Triangles, all outwards or all inwards.
    to_features : (n, k) ndarray of float
        Geodesic distance of every vertex from each feature point.
    monitor : Monitor, optional
        Asked whether to stop.

    Returns
    -------
    (s, 2) ndarray of int
        Pairs of vertices.

    Raises
    ------
    CancelledError
        If the monitor says so.

    References
    ----------
    The balls: Ma, Bae and Choi, "3D medial axis point approximation using nearest neighbors and the normal field",
    2012.
    """
    from scipy.spatial import KDTree

    normals = np.zeros_like(points)
    outward = np.repeat(np.sign(signed_volume(points, faces)) * area_vectors(points, faces), 3, axis=0)
    for axis in range(3):
        normals[:, axis] = np.bincount(faces.ravel(), outward[:, axis], minlength=len(points))
    normals /= np.maximum(np.linalg.norm(normals, axis=1), np.finfo(float).tiny)[:, None]
    tree = KDTree(points)
    here = np.arange(len(points))
    radius = np.full(len(points), _REACH)
    for _ in range(_ROUNDS):
        if monitor is not None:
            monitor.check()
        _, nearest = tree.query(points - radius[:, None] * normals)
        away = points - points[nearest]
        depth = 2 * np.einsum("ij,ij->i", normals, away)
        smaller = np.einsum("ij,ij->i", away, away) / np.maximum(depth, 1e-12)  # the ball through both
        shrinks = (nearest != here) & (smaller < radius * (1 - 1e-3))
        if not shrinks.any():
            break
        radius[shrinks] = smaller[shrinks]
    rests = tree.query(points - radius[:, None] * normals, k=min(_CONTACTS, len(points)))
    distance, other = (np.reshape(part, (len(points), -1)) for part in rests)
    touches = (distance <= radius[:, None] * (1 + _TOUCH)) & (other != here[:, None]) & (radius[:, None] < _REACH)
    here, other = np.nonzero(touches)[0], other[touches]
    away = points[here] - points[other]
    length = np.linalg.norm(away, axis=1)
    away /= np.maximum(length, np.finfo(float).tiny)[:, None]
    faces_it = np.einsum("ij,ij->i", away, normals[here]) > _FACING
    faces_it &= np.einsum("ij,ij->i", away, normals[other]) < -_FACING
    faces_it &= np.abs(to_features[here] - to_features[other]).max(axis=1) < _WAY + _DETOUR * length
    pairs = np.sort(np.column_stack([here, other])[faces_it], axis=1)
    return np.unique(pairs, axis=0)


def braced(patch: PairSet, points: FloatArray, struts: IntArray, monitor: Monitor | None = None) -> PairSet:
    """Ask the stress for the lengths of struts instead of the way round on the surface.

    Geodesics alone would rather have a mouth outside its head, where straight distances come nearer to the way over
    the lips.

    Parameters
    ----------
    patch : PairSet
        Pairs inside a patch.
    points : (n, 3) ndarray of float
        Vertices.
    struts : (s, 2) ndarray of int
        Pairs of vertices; those that leave the patch are left out.
    monitor : Monitor, optional
        Asked whether to stop.

    Returns
    -------
    PairSet
        The pairs, with those of the struts at their lengths and of half the weight of everything else at their ends.
    """
    place = np.full(len(points), -1)
    place[patch.vertices] = np.arange(len(patch.vertices))
    pairs = np.sort(place[struts], axis=1)
    inside = pairs[:, 0] >= 0
    length = np.linalg.norm(points[struts[inside, 0]] - points[struts[inside, 1]], axis=1)
    weights = _SHARE * patch.total_weights()[pairs[inside]].mean(axis=1)
    return patch.replaced(pairs[inside], length, weights, monitor)
