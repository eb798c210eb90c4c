"""Arms rolled about their own axes until the hands lie as they do in the form of any other pose."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..deformation.elastic_body import ElasticBody
from ..deformation.rotations import nearest_rotations
from ..numerics.arrays import FloatArray, IntArray
from ..numerics.ramps import ramp, smooth_ramp
from .limbs import Limbs
from .upright import body_axes

_HAND = 0.5  # length of a hand, as a share of the arm; longer ones bend at the wrist
_REACH = 0.8  # where the roll begins, likewise; complete at half of it: the skin of the shoulder takes no part
_FLAT = (0.25, 0.35)  # flatness of a hand: below, it has no direction; above, it surely has
_PALMAR = (0.03, 0.05)  # likewise skewness across its flat side, which tells palm from back
_FEWEST = 12  # vertices of a hand


class _Arm(NamedTuple):
    """An arm in a form: where it is, and by how much it is rolled."""

    share: FloatArray  # (n,) of the roll that each vertex takes: 0 in the trunk, 1 at the hand
    centre: FloatArray
    axis: FloatArray  # towards the hand
    angle: float


def arms_rolled(
    body: ElasticBody, form: FloatArray, features: IntArray, to_features: FloatArray, limbs: Limbs
) -> FloatArray:
    """Roll both arms about their own axes until the hands lie the same way, whatever the pose was.

    A twist of an arm hardly shears its skin, so neither the stress nor the push determines it: without this step, hands
    are rolled by up to half a turn in the forms of two poses. Arms are the pair of limbs nearest to the head. A hand
    lies with its broad direction towards the front of the body, and its skewness, fingers and thumb, away from the
    head: thumbs in front, palms down. Paws, hooves and stumps, which are not as flat or not as skew, stay.

    Parameters
    ----------
    body : ElasticBody
        The surface.
    form : (n, 3) ndarray of float
        The form, its arms straight.
    features, to_features, limbs
        As in `upright_rotation`.

    Returns
    -------
    (n, 3) ndarray of float
        The form with its arms rolled; as given if there is no head, or no pair of arms.

    Examples
    --------
    >>> from addon.core.surface.triangulation import triangulated
    >>> from addon.core.symmetry.limbs import limbs_of
    >>> points = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    >>> faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
    >>> body = ElasticBody(triangulated(points, faces), points, faces)
    >>> far = np.linalg.norm(points[:, None] - points, axis=2)
    >>> limbs = limbs_of(far, np.zeros((4, 4, 4)), np.array([1.0, 2, 3, 4]), lambda: np.arange(4.0))
    >>> np.array_equal(arms_rolled(body, points, np.arange(4), far, limbs), points)
    True
    """
    arms = _arms(limbs)
    if arms is None:
        return form
    _, headward, front = body_axes(form, body.mass, features, to_features, limbs)
    between = limbs.distances + np.diag(np.full(len(features), np.inf))
    rolled = form
    for index in arms:
        length = between[index].min() / 2
        arm = _rolled(body, form, to_features[:, index], length, headward, front)
        if arm is not None:
            rolled = _turned(rolled, arm)
    return rolled


def _arms(limbs: Limbs) -> tuple[int, int] | None:
    """Find the pair of limbs nearest to the head."""
    head, paired = int(np.argmin(limbs.along)), limbs.side != 0
    if paired[head] or not paired.any():
        return None
    far = limbs.distances[head] + limbs.distances[head, limbs.partner]
    first = int(np.argmin(np.where(paired, far, np.inf)))
    return first, int(limbs.partner[first])


def _rolled(
    body: ElasticBody, form: FloatArray, away: FloatArray, length: float, headward: FloatArray, front: FloatArray
) -> _Arm | None:
    """Measure an arm in a form and its hand in the body, and decide by how much it is rolled."""
    hand, whole = away < _HAND * length, away < length
    if hand.sum() < _FEWEST:
        return None
    across, skew, flatness = _shape(body.points[hand], body.mass[hand])
    mass = body.mass[hand] / body.mass[hand].sum()
    before, after = (each[hand] - mass @ each[hand] for each in (body.points, form))
    turn = nearest_rotations(((before * mass[:, None]).T @ after)[None])[0]
    centre, axis = _long_axis(form[whole], body.mass[whole])
    axis = axis if axis @ (form[np.argmin(away)] - centre) > 0 else -axis
    forward = front - (front @ axis) * axis
    broad = across @ turn - (across @ turn @ axis) * axis
    told = min(1.0, 2 * float(np.linalg.norm(forward)))  # 0 for an arm along the front itself
    upright = float(broad @ broad)  # of the hand along the arm
    if told == 0 or upright == 0:
        return None
    forward, broad = forward / np.linalg.norm(forward), broad / np.sqrt(upright)
    thick = np.cross(axis, broad)
    palmar = float(skew @ turn @ thick)
    if palmar * (np.cross(axis, forward) @ headward) > 0:
        broad, thick = -broad, -thick
    sure = told * float(ramp(flatness * upright, *_FLAT) * ramp(abs(palmar), *_PALMAR))
    if sure == 0:
        return None
    angle = float(np.arctan2(forward @ thick, forward @ broad))
    return _Arm(smooth_ramp(1 - away / (_REACH * length), 0.0, 0.5), centre, axis, sure * angle)


def _shape(points: FloatArray, mass: FloatArray) -> tuple[FloatArray, FloatArray, float]:
    """Compute the broad axis of a hand, its skewness about its long axis, and its flatness, 0 to 1."""
    centre, own = _long_axis(points, mass)
    around = points - centre
    around = around - np.outer(around @ own, own)
    spread, axes = np.linalg.eigh((around * mass[:, None]).T @ around)
    radius = np.linalg.norm(around, axis=1)
    tiny = np.finfo(float).tiny
    skew = (mass * radius**2) @ around / max(float(mass @ radius**3), tiny)
    return axes[:, 2], skew, float((spread[2] - spread[1]) / max(spread[2] + spread[1], tiny))


def _long_axis(points: FloatArray, mass: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Compute the centre and the longest axis of weighted points."""
    centre = mass @ points / mass.sum()
    away = points - centre
    return centre, np.linalg.eigh((away * mass[:, None]).T @ away)[1][:, 2]


def _turned(points: FloatArray, arm: _Arm) -> FloatArray:
    """Turn points about the axis of an arm, each by its share."""
    from scipy.spatial.transform import Rotation

    turn = Rotation.from_rotvec(np.outer(arm.share * arm.angle, arm.axis))
    return np.asarray(arm.centre + turn.apply(points - arm.centre))
