"""Rigid motions: least-squares fit, iterative closest points, and the choice between mirror images."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..deformation.elastic_body import ElasticBody
from ..numerics.arrays import FloatArray

if TYPE_CHECKING:
    from scipy.spatial import KDTree

_HALF_TURNS = ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1))  # about the principal axes
_SCOUTS = 2000  # points of a cloud that are used from every start


def rigid_fit(
    source: FloatArray, target: FloatArray, weights: FloatArray | None = None, *, mirror: bool = False
) -> tuple[FloatArray, FloatArray]:
    """Compute the rigid motion that best aligns matching points.

    `source, target` (n, 3); `weights` (n,); `mirror`: whether a mirror image is allowed too; gives rotation (3, 3),
    shift (3,).

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


def half_turns(
    source: FloatArray, shares: FloatArray, target: FloatArray, target_shares: FloatArray
) -> list[tuple[FloatArray, FloatArray]]:
    """Align the principal axes of a surface to those of another, by the four proper rotations.

    `source` (n, 3), `target` (n', 3); `shares` (n,), `target_shares` (n',): of the area, which sum to 1; gives the
    motions, ``x ↦ x R + t``.

    Examples
    --------
    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 4]])
    >>> even = np.full(4, 0.25)
    >>> ways = half_turns(points, even, points, even)
    >>> bool(min(np.abs(points @ turn + shift - points).max() for turn, shift in ways) < 1e-9)
    True
    """
    (centre, axes), (there, others) = _principal_axes(source, shares), _principal_axes(target, target_shares)
    turns = [axes.T @ (np.array(signs)[:, None] * others) for signs in _HALF_TURNS]
    return [(rotation, there - centre @ rotation) for rotation in turns]


def _principal_axes(points: FloatArray, shares: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Compute the centre and the principal axes of a surface, longest first, as rows of a proper rotation."""
    centre = shares @ points
    apart = points - centre
    axes = np.linalg.eigh((apart * shares[:, None]).T @ apart)[1].T[::-1].copy()
    axes[2] *= np.sign(np.linalg.det(axes))
    return centre, axes


def closest_point_fit(
    source: FloatArray, target: FloatArray, *, max_iterations: int = 60, mirror: bool = False
) -> tuple[FloatArray, FloatArray]:
    """Align one point cloud rigidly to another without known matches (multi-start ICP).

    Starts from the given position and from every alignment of the principal axes; the one with the least mean squared
    distance wins. Of large clouds, a few thousand points are used first, and all points in the last steps.

    `source` (p, 3); `target` (q, 3); `max_iterations`: maximum number of steps from each start; `mirror`: whether
    mirror images are tried too; gives rotation (3, 3), shift (3,).

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

    `source` (p, 3); `target` (q, 3); `rotation` (3, 3); `shift` (3,); `max_iterations`: maximum number of steps;
    gives rotation (3, 3), shift (3,), left.

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

    `body`: the input; `after` (n, 3); gives (n, 3).
    """
    covariance = body.covariances(after)
    thinnest = np.linalg.svd(covariance, compute_uv=False)[:, -1]
    kept = float((np.sign(np.linalg.det(covariance)) * thinnest) @ body.mass) >= 0
    return after if kept else after * [1.0, 1.0, -1.0]
