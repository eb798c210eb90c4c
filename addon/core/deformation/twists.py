"""Twists of limbs about their own axes, measured section by section against the body, and taken back."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..numerics.arrays import FloatArray, IntArray
from ..numerics.nearest import nearest_others
from ..numerics.ramps import ramp
from .elastic_body import ElasticBody
from .rotations import nearest_rotations

_SECTIONS = 16  # of a limb at most
_LONG = 2.0  # length of a section at least, in mean distances between vertices
_FEWEST = 6  # vertices of a section
_LEAST = 0.01  # of that distance: shorter limbs have no sections
_MISFIT = (0.25, 0.4)  # of a section after its best rotation: below, the rotation is sure; above, it says nothing


class _Sections(NamedTuple):
    """The sections of all limbs, numbered from the tip; one more lies beyond the root."""

    rotation: FloatArray  # (k, s + 1, 3, 3), from the body to the form
    centre: FloatArray  # (k, s + 1, 3) in the form
    sure: FloatArray  # (k, s + 1), 0 to 1


def untwisted(body: ElasticBody, form: FloatArray, features: IntArray, to_features: FloatArray) -> FloatArray:
    """Turn every limb of a form about its own axis until it is not twisted against the body.

    A twist of a thin limb hardly changes distances, so the stress does not determine it: the two halves of a tube that
    is bent like an S come out rolled by half a turn, their inner sides on the same side of an arc. Once such a limb is
    pulled, it closes at its twist like the wrapper of a sweet.

    Parameters
    ----------
    body : ElasticBody
        The surface as posed.
    form : (n, 3) ndarray of float
        The form.
    features : (k,) ndarray of int
        Feature points, the tips of the limbs. A limb reaches half way to the next of them.
    to_features : (n, k) ndarray of float
        Distances of all vertices from them.

    Returns
    -------
    (n, 3) ndarray of float
        The form with each limb turned, from its root to its tip, by the sum of the twists on the way. Sections that fit
        no rotation, such as a hand with crumpled fingers, count as not twisted. Trunk and roots stay.

    Examples
    --------
    >>> from addon.core.surface.triangulation import triangulated
    >>> points = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    >>> faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
    >>> body = ElasticBody(triangulated(points, faces), points, faces)
    >>> far = np.linalg.norm(points[:, None] - points, axis=2)
    >>> np.allclose(untwisted(body, points, np.arange(4), far), points)
    True
    """
    length = nearest_others(to_features[features]) / 2  # (k,)
    spacing = np.sqrt(body.mass.sum() / len(form))
    count = np.clip((length / (_LONG * spacing)).astype(np.int64), 1, _SECTIONS)
    place = np.full(to_features.shape, np.inf)  # (n, k): in sections from the tip
    np.divide(to_features * count, length, out=place, where=length > spacing * _LEAST)
    sections = _sections(body, form, place, count)
    twist, axis = _twists(sections, count)
    return body.turned(form, _turns(place, np.argmin(to_features, axis=1), count, twist, axis))


def _sections(body: ElasticBody, form: FloatArray, place: FloatArray, count: IntArray) -> _Sections:
    """Fit a rotation to each section and half of its neighbours on both sides."""
    from scipy.sparse import csr_matrix

    limbs, halves = len(count), 2 * _SECTIONS + 4  # half sections; the first lies before the tip
    vertex, limb = np.nonzero(place < count + 1.5)
    half = np.maximum((2 * place[vertex, limb]).astype(np.int64) + 1, 0)  # on spikes, distances can be below 0
    before, after = body.points - body.points.mean(axis=0), form - form.mean(axis=0)
    squares = np.column_stack([(before**2).sum(axis=1), (after**2).sum(axis=1)])
    products = (before[:, :, None] * after[:, None, :]).reshape(-1, 9)
    moments = body.mass[:, None] * np.column_stack([np.ones(len(form)), before, after, squares, products])
    within = csr_matrix((np.ones(len(vertex)), (limb * halves + half, vertex)), shape=(limbs * halves, len(form)))
    sums = within @ np.column_stack([np.ones(len(form)), moments])
    pair = sums.reshape(limbs, halves // 2, 2, -1).sum(axis=2)
    window = pair[:, :-1] + pair[:, 1:]  # (k, s + 1, 19), of four half sections each
    number, mass = window[..., 0], np.maximum(window[..., 1], np.finfo(float).tiny)
    first, then = window[..., 2:5], window[..., 5:8]
    spread, spread_then = (window[..., 8 + at] - (each**2).sum(axis=-1) / mass for at, each in enumerate((first, then)))
    covariance = window[..., 10:].reshape(*mass.shape, 3, 3)
    covariance = covariance - first[..., :, None] * then[..., None, :] / mass[..., None, None]
    rotation = nearest_rotations(covariance.reshape(-1, 3, 3)).reshape(covariance.shape)
    left = np.maximum(spread + spread_then - 2 * (rotation * covariance).sum(axis=(-2, -1)), 0.0)
    misfit = np.sqrt(left / np.maximum(np.maximum(spread, left), np.finfo(float).tiny))
    sure = np.where(number < _FEWEST, 0.0, 1 - ramp(misfit, *_MISFIT))
    return _Sections(rotation, then / mass[..., None], sure)


def _twists(sections: _Sections, count: IntArray) -> tuple[FloatArray, FloatArray]:
    """Measure between each section and the next how far they are turned about the line of their centres."""
    rotation, centre, sure = sections
    axis = np.diff(centre, axis=1)  # (k, s, 3), towards the root
    axis = axis / np.maximum(np.linalg.norm(axis, axis=-1, keepdims=True), np.finfo(float).tiny)
    turn = np.einsum("...ji,...jk->...ik", rotation[:, :-1], rotation[:, 1:])
    vector = np.stack([turn[..., i, j] - turn[..., j, i] for i, j in ((1, 2), (2, 0), (0, 1))], axis=-1)
    # half the angle about an axis: the tangent of the quaternion's part along it
    twist = 2 * np.arctan2((vector * axis).sum(axis=-1), 1 + np.trace(turn, axis1=-2, axis2=-1))
    number = np.arange(_SECTIONS)
    border = count[:, None] - 1  # the limb on the other side takes the other half
    share = np.where(number < border, 1.0, np.where(number == border, 0.5, 0.0))
    return share * np.minimum(sure[:, :-1], sure[:, 1:]) * twist, axis


def _turns(place: FloatArray, limb: IntArray, count: IntArray, twist: FloatArray, axis: FloatArray) -> FloatArray:
    """Add the twists up from root to tip: a rotation for every vertex, applied from the right."""
    from scipy.spatial.transform import Rotation

    limbs = len(count)
    steps = Rotation.from_rotvec((-twist[..., None] * axis).reshape(-1, 3)).as_matrix().reshape(limbs, -1, 3, 3)
    total = np.tile(np.eye(3), (limbs, _SECTIONS + 1, 1, 1))
    for number in reversed(range(_SECTIONS)):
        total[:, number] = steps[:, number] @ total[:, number + 1]
    at = place[np.arange(len(place)), limb]
    number = np.clip(at - 0.5, 0, _SECTIONS - 1).astype(np.int64)
    end = np.minimum(number + 1.5, count[limb])
    share = np.clip((end - at) / np.maximum(end - number - 0.5, 0.5), 0.0, 1.0)
    own = Rotation.from_rotvec(-(share * twist[limb, number])[:, None] * axis[limb, number]).as_matrix()
    return np.asarray(own @ total[limb, number + 1])
