"""Rigid motions: least-squares fit, iterative closest points, and the choice between mirror images."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..deformation.elastic_body import ElasticBody
from ..numerics.arrays import FloatArray

if TYPE_CHECKING:
    from scipy.spatial import KDTree

_SCOUTS = 2000  # points of a cloud that are used from every start


def rigid_fit(
    source: FloatArray, target: FloatArray, weights: FloatArray | None = None, *, mirror: bool = False
) -> tuple[FloatArray, FloatArray]:
    """Compute the rigid motion that best aligns matching points.

    Parameters
    ----------
    source, target : (n, 3) ndarray of float
        Matching points.
    weights : (n,) ndarray of float, optional
        Weight of each match; 1 if omitted.
    mirror : bool
        Whether a mirror image is allowed too.

    Returns
    -------
    rotation : (3, 3) ndarray of float
        R, with determinant 1 unless `mirror`.
    shift : (3,) ndarray of float
        t; the motion is ``x ↦ x R + t``.

    Examples
    --------
    >>> points, quarter = np.diag([1.0, 2, 3]), np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]])
    >>> rotation, shift = rigid_fit(points, points @ quarter + 5)
    >>> np.allclose(rotation, quarter), np.allclose(shift, 5)
    (True, True)

    References
    ----------
    Kabsch, "A solution for the best rotation to relate two sets of vectors", 1976.
    """
    share = np.ones(len(source)) if weights is None else weights
    share = share / share.sum()
    source_centre, target_centre = share @ source, share @ target
    left, _, right = np.linalg.svd((source - source_centre).T @ (share[:, None] * (target - target_centre)))
    if not mirror and np.linalg.det(left @ right) < 0:
        left[:, -1] *= -1
    rotation = left @ right
    return rotation, target_centre - source_centre @ rotation


def closest_point_fit(
    source: FloatArray, target: FloatArray, *, max_iterations: int = 60, mirror: bool = False
) -> tuple[FloatArray, FloatArray]:
    """Align one point cloud rigidly to another without known matches (multi-start ICP).

    Starts from the given position and from every alignment of the principal axes; the one with the least mean squared
    distance wins. Of large clouds, a few thousand points are used first, and all points in the last steps.

    Parameters
    ----------
    source : (p, 3) ndarray of float
        Points to move.
    target : (q, 3) ndarray of float
        Points to move them to.
    max_iterations : int
        Maximum number of steps from each start.
    mirror : bool
        Whether mirror images are tried too.

    Returns
    -------
    rotation : (3, 3) ndarray of float
        R.
    shift : (3,) ndarray of float
        t; the motion is ``x ↦ x R + t``.

    Examples
    --------
    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 4], [1, 1, 5]])
    >>> target = (points @ np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]]) + 7)[::-1]
    >>> rotation, shift = closest_point_fit(points, target)
    >>> np.allclose((points @ rotation + shift)[::-1], target)
    True

    References
    ----------
    Besl and McKay, "A Method for Registration of 3-D Shapes", 1992.
    """
    from scipy.spatial import KDTree

    tree = KDTree(target)
    some = _scouts(source)
    source_centre, target_centre = source.mean(axis=0), target.mean(axis=0)
    source_axes = np.linalg.eigh(np.cov(source.T))[1]
    target_axes = np.linalg.eigh(np.cov(target.T))[1]
    starts = [(np.eye(3), np.zeros(3))]
    for signs in np.ndindex(2, 2, 2):
        rotation = source_axes @ np.diag(1.0 - 2.0 * np.array(signs)) @ target_axes.T
        if mirror or np.linalg.det(rotation) > 0:
            starts.append((rotation, target_centre - source_centre @ rotation))
    best, best_error = starts[0], np.inf
    for rotation, shift in starts:
        *closer, error = _closer(some, target, tree, rotation, shift, max_iterations, mirror)
        if error < best_error:
            best, best_error = (closer[0], closer[1]), error
    return best if some is source else _closer(source, target, tree, *best, max_iterations, mirror)[:2]


def closest_points_from(
    source: FloatArray, target: FloatArray, rotation: FloatArray, shift: FloatArray, *, max_iterations: int = 60
) -> tuple[FloatArray, FloatArray, float]:
    """Align one point cloud to another without known matches, from an approximate motion.

    Parameters
    ----------
    source : (p, 3) ndarray of float
        Points to move; of large clouds a few thousand are used.
    target : (q, 3) ndarray of float
        Points to move them to.
    rotation : (3, 3) ndarray of float
        R at the start, proper.
    shift : (3,) ndarray of float
        t at the start.
    max_iterations : int
        Maximum number of steps.

    Returns
    -------
    rotation : (3, 3) ndarray of float
        R.
    shift : (3,) ndarray of float
        t; the motion is ``x ↦ x R + t``.
    left : float
        Remaining root mean squared distance from the target.

    Examples
    --------
    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 4], [1, 1, 5]])
    >>> rotation, shift, left = closest_points_from(points, points + 0.1, np.eye(3), np.zeros(3))
    >>> np.allclose(shift, 0.1), round(left, 6)
    (True, 0.0)

    References
    ----------
    Besl and McKay, "A Method for Registration of 3-D Shapes", 1992.
    """
    from scipy.spatial import KDTree

    some = _scouts(source)
    *motion, error = _closer(some, target, KDTree(target), rotation, shift, max_iterations, False)
    return motion[0], motion[1], float(np.sqrt(error))


def _scouts(cloud: FloatArray) -> FloatArray:
    """Choose a few thousand points of a large cloud."""
    if len(cloud) <= _SCOUTS:
        return cloud
    return cloud[np.sort(np.random.default_rng(0).choice(len(cloud), _SCOUTS, replace=False))]


def _closer(
    source: FloatArray,
    target: FloatArray,
    tree: KDTree,
    rotation: FloatArray,
    shift: FloatArray,
    iterations: int,
    mirror: bool,
) -> tuple[FloatArray, FloatArray, float]:
    """Match each point with the nearest and fit, repeatedly; return the motion and the mean squared distance."""
    error = np.inf
    for _ in range(iterations):
        distance, match = tree.query(source @ rotation + shift)
        previous, error = error, float(np.mean(distance**2))
        if error >= (1 - 1e-9) * previous:
            break
        rotation, shift = rigid_fit(source, target[match], mirror=mirror)
    return rotation, shift, float(np.mean(tree.query(source @ rotation + shift)[0] ** 2))


def outside_out(body: ElasticBody, after: FloatArray) -> FloatArray:
    """Choose between an embedding and its mirror image, which distances cannot distinguish.

    If most of the surface would be turned inside out, the mirror image is the right one.

    Parameters
    ----------
    body : ElasticBody
        The input.
    after : (n, 3) ndarray of float
        The embedding.

    Returns
    -------
    (n, 3) ndarray of float
        The embedding, or its mirror image along the third axis.

    Examples
    --------
    >>> from addon.core.surface.triangulation import triangulated
    >>> points = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    >>> faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
    >>> body = ElasticBody(triangulated(points, faces), points, faces)
    >>> np.allclose(outside_out(body, points * [1, 1, -1]), points)
    True
    """
    covariance = body.covariances(after)
    thinnest = np.linalg.svd(covariance, compute_uv=False)[:, -1]
    kept = float((np.sign(np.linalg.det(covariance)) * thinnest) @ body.mass) >= 0
    return after if kept else after * [1.0, 1.0, -1.0]
