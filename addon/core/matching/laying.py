"""Alignment of one form to another: the proper motion, and the corresponding feature points."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..measures.alignment import closest_point_fit, closest_points_from, rigid_fit
from ..numerics.arrays import FloatArray, IntArray
from ..symmetry.limbs import Limbs
from .assignments import feature_assignments

_NEAR = 0.25  # sqrt(area): feature points that are farther apart do not correspond
_TURNED = 2.0  # trace of the rotation between two alignments that lie differently: more than 60 degrees
CLOSE = 0.02  # difference of mismatches below which the form may as well lie the other way round
_UP_MOST = np.array([1.0, 1.0, 2.0])  # weights of the axes: a body that faces away is better than one on its head
_RESIDUAL = 2.0  # weight of the remaining distance, in sqrt(area), relative to the mismatch of an assignment


class Laying(NamedTuple):
    """The alignment of a form to another.

    Attributes
    ----------
    rotation : (3, 3) ndarray of float
        R, proper.
    shift : (3,) ndarray of float
        t; the motion is ``x ↦ x R + t``.
    image : (k,) ndarray of int
        For each feature point the corresponding one of the other form; -1 for none.
    mismatch : float
        Dissimilarity of the two, without unit: below 0.2 for poses of a body, above 0.3 for bodies of different kinds.
    rival : float
        By how much more the best alternative that lies the other way round, such as back to front, mismatches; inf if
        there is none.
    """

    rotation: FloatArray
    shift: FloatArray
    image: IntArray
    mismatch: float
    rival: float = float("inf")


def laid_by_vertices(
    form: FloatArray, other: FloatArray, weights: FloatArray, tips: IntArray, others: IntArray
) -> Laying:
    """Align a form to that of another pose of the same mesh, vertex to vertex.

    `form, other` (n, 3); `weights` (n,); `tips` (k,); `others` (k',).

    Examples
    --------
    >>> points = np.diag([1.0, 2, 3])
    >>> laying = laid_by_vertices(points + 5, points, np.ones(3), np.array([2, 0]), np.array([0, 1, 2]))
    >>> np.round(laying.shift, 6).tolist(), laying.image.tolist()
    ([-5.0, -5.0, -5.0], [2, 0])
    """
    rotation, shift = rigid_fit(form, other, weights)
    image = completed(np.full(len(tips), -1), other[tips], other[others])
    apart = ((form @ rotation + shift - other) ** 2).sum(axis=1)
    return Laying(rotation, shift, image, float(np.sqrt(weights @ apart / weights.sum())))


def laid_by_limbs(
    form: FloatArray,
    other: FloatArray,
    tips: IntArray,
    others: IntArray,
    limbs: Limbs,
    other_limbs: Limbs,
    *,
    upright: FloatArray | None = None,
) -> Laying:
    """Align a form to that of another mesh of a similar body.

    Every assignment of the feature points gives a start for iterative closest points; the best result, by the mismatch
    of the assignment and the remaining distance, is taken; of results that are about as good, the one that lies most
    as the form would by itself. If no feature points correspond, closest points start from the principal axes.

    `form` (n, 3); `other` (n', 3); `tips` (k,); `others` (k',); `limbs, other_limbs`: the limbs identified among
    them; `upright` (3, 3): the rotation that the form would have by itself, if the other stands upright.

    Examples
    --------
    >>> body = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]]) / 3
    >>> from addon.core.symmetry.limbs import limbs_of
    >>> far = np.linalg.norm(body[:, None] - body, axis=2)
    >>> limbs = limbs_of(far, np.zeros((4, 4, 4)), np.ones(4), lambda: np.arange(4.0))
    >>> turned = body @ np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]]) + 1
    >>> laying = laid_by_limbs(turned, body, np.arange(4), np.arange(4), limbs, limbs)
    >>> bool(np.allclose(turned @ laying.rotation + laying.shift, body)), laying.image.tolist()
    (True, [0, 1, 2, 3])

    References
    ----------
    Besl and McKay, "A Method for Registration of 3-D Shapes", 1992.
    """
    tried: list[Laying] = []
    for image, mismatch in feature_assignments(limbs, other_limbs):
        known = np.flatnonzero(image >= 0)
        if len(known) < 3:
            continue
        start = rigid_fit(form[tips[known]], other[others[image[known]]])
        rotation, shift, left = closest_points_from(form, other, *start)
        tried.append(Laying(rotation, shift, image, mismatch + _RESIDUAL * left))
    if not tried:
        *motion, left = closest_points_from(form, other, *closest_point_fit(form, other))
        tried.append(Laying(motion[0], motion[1], np.full(len(tips), -1), _RESIDUAL * left))
    best = min(tried, key=lambda each: each.mismatch)
    turned = [each.mismatch for each in tried if np.trace(best.rotation.T @ each.rotation) < _TURNED]
    rival = min(turned, default=np.inf) - best.mismatch
    if upright is not None:
        alike = [each for each in tried if each.mismatch < best.mismatch + CLOSE]
        best = max(alike, key=lambda each: float(np.diag(upright.T @ each.rotation) @ _UP_MOST))
    placed = form[tips] @ best.rotation + best.shift
    image = completed(best.image, placed, other[others])
    return best._replace(image=image, rival=rival)


def completed(image: IntArray, tips: FloatArray, others: FloatArray) -> IntArray:
    """Assign feature points without a counterpart to the nearest unassigned ones.

    `image` (k,); `tips` (k, 3); `others` (k', 3); gives (k,).

    Examples
    --------
    >>> completed(np.array([-1, -1]), np.zeros((2, 3)) + [[0.0], [9.0]], np.array([[0.1, 0, 0]])).tolist()
    [0, -1]
    """
    from scipy.optimize import linear_sum_assignment

    image = image.copy()
    alone, left = np.flatnonzero(image < 0), np.setdiff1d(np.arange(len(others)), image)
    far = np.linalg.norm(tips[alone][:, None] - others[left], axis=2)
    rows, columns = linear_sum_assignment(np.minimum(far, _NEAR))
    near = far[rows, columns] < _NEAR
    image[alone[rows[near]]] = left[columns[near]]
    return image
