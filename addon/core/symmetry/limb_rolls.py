"""Arms and legs rolled about their own axes until hands and feet lie as they do in the form of any other pose."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..deformation.elastic_body import ElasticBody
from ..deformation.rotations import nearest_rotations
from ..numerics.arrays import FloatArray, IntArray
from ..numerics.nearest import nearest_others
from ..numerics.ramps import ramp, smooth_ramp
from .limbs import Limbs
from .upright import body_axes

_HAND = 0.5  # length of a hand, as a share of the arm; longer ones bend at the wrist
_REACH = 0.8  # where the roll begins, likewise; complete at half of it: the skin of the shoulder takes no part
_FLAT = (0.25, 0.35)  # flatness of a hand: below, it has no direction; above, it surely has
_PALMAR = (0.03, 0.05)  # likewise skewness across its flat side, which tells palm from back
_FEWEST = 12  # vertices of a hand, of a foot and of a shin
_FOOT, _SHIN = 0.25, (0.3, 0.5)  # where they lie, as shares of the leg from its tip
_TOES = (0.1, 0.2)  # how far a foot reaches out from the line of the shin, over the square root of its area
_SAME_SIDE = (0.1, 0.3)  # mean cosine between toes and front: below, the feet do not tell where the front is


class _Roll(NamedTuple):
    """A limb in a form: where it is, and by how much it is rolled."""

    share: FloatArray  # (n,) of the roll that each vertex takes: 0 in the trunk, 1 at the hand or foot
    centre: FloatArray
    axis: FloatArray  # towards the tip
    angle: float
    sure: float  # 0 to 1


def limbs_rolled(body: ElasticBody, form: FloatArray, limbs: Limbs, depth: float) -> FloatArray:
    """Roll arms and legs of a form about their own axes until hands and feet lie the same way, whatever the pose was.

    The palm of a hand faces the feet, as far as its shape tells palm from back. Toes point to the front, or to the
    back where they do so more: it does not matter which side counts as left. Legs are rolled in flat layouts only
    (depth below 1).
    """
    to_features = limbs.to_features
    pairs = _arms_and_legs(limbs)
    if pairs is None:
        return form
    arms, legs = pairs
    _, headward, front = body_axes(form, body.mass, limbs)
    length = nearest_others(limbs.distances) / 2
    rolls = [_arm(body, form, to_features[:, index], length[index], headward, front) for index in arms]
    if depth < 1:
        both = [_leg(body, form, to_features[:, index], length[index], front) for index in legs]
        rolls += _to_one_side([each._replace(sure=each.sure * (1 - depth)) for each in both if each is not None])
    rolled = form
    for roll in rolls:
        if roll is not None and roll.sure > 0:
            rolled = _turned(rolled, roll)
    return rolled


def _arms_and_legs(limbs: Limbs) -> tuple[list[int], list[int]] | None:
    """Find the pair of limbs nearest to the head, and that farthest from it if it is another."""
    head, paired = int(np.argmin(limbs.along)), limbs.side != 0
    if paired[head] or not paired.any():
        return None
    far = limbs.distances[head] + limbs.distances[head, limbs.partner]
    nearest, farthest = int(np.argmin(np.where(paired, far, np.inf))), int(np.argmax(np.where(paired, far, -np.inf)))
    arms, legs = ([index, int(limbs.partner[index])] for index in (nearest, farthest))
    return arms, [] if farthest in arms else legs


def _arm(
    body: ElasticBody, form: FloatArray, away: FloatArray, length: float, headward: FloatArray, front: FloatArray
) -> _Roll | None:
    """Measure an arm in a form and its hand in the body, and decide by how much it is rolled."""
    hand = np.flatnonzero(away < _HAND * length)
    if len(hand) < _FEWEST:
        return None
    across, skew, flatness = _shape(body.points[hand], body.mass[hand])
    turn = _turn(body, form, hand)
    centre, axis = _line(body, form, away, length)
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
    return _Roll(_share(away, length), centre, axis, float(np.arctan2(forward @ thick, forward @ broad)), sure)


def _leg(body: ElasticBody, form: FloatArray, away: FloatArray, length: float, front: FloatArray) -> _Roll | None:
    """Measure where the toes point in the body, off the line of the shin, and by how much they miss the front."""
    foot = np.flatnonzero(away < _FOOT * length)
    shin = np.flatnonzero((away > _SHIN[0] * length) & (away < _SHIN[1] * length))
    if min(len(foot), len(shin)) < _FEWEST:
        return None
    middle, own = _long_axis(body.points[shin], body.mass[shin])
    toes = body.mass[foot] @ body.points[foot] / body.mass[foot].sum() - middle
    toes = toes - (toes @ own) * own
    reach = float(np.linalg.norm(toes) / np.sqrt(body.mass[foot].sum()))
    centre, axis = _line(body, form, away, length)
    forward, ahead = (each - (each @ axis) * axis for each in (front, toes @ _turn(body, form, shin)))
    sure = min(1.0, 2 * float(np.linalg.norm(forward))) * float(ramp(reach, *_TOES))
    angle = float(np.arctan2(np.cross(ahead, forward) @ axis, ahead @ forward))
    return _Roll(_share(away, length), centre, axis, angle, sure)


def _to_one_side(legs: list[_Roll]) -> list[_Roll]:
    """Turn the toes to the back if they point there more, so that it does not matter which side counts as left."""
    told = sum(leg.sure * np.cos(leg.angle) for leg in legs) / max(sum(leg.sure for leg in legs), 1e-9)
    sure = float(ramp(abs(told), *_SAME_SIDE))
    half = 0.0 if told > 0 else np.pi
    return [leg._replace(angle=(leg.angle + half + np.pi) % (2 * np.pi) - np.pi, sure=leg.sure * sure) for leg in legs]


def _turn(body: ElasticBody, form: FloatArray, chosen: IntArray) -> FloatArray:
    """Compute the rotation of some vertices from the body to the form."""
    mass = body.mass[chosen] / body.mass[chosen].sum()
    before, after = (each[chosen] - mass @ each[chosen] for each in (body.points, form))
    return np.asarray(nearest_rotations(((before * mass[:, None]).T @ after)[None])[0])


def _line(body: ElasticBody, form: FloatArray, away: FloatArray, length: float) -> tuple[FloatArray, FloatArray]:
    """Compute the centre of a limb in a form and its axis, towards the tip."""
    whole = away < length
    centre, axis = _long_axis(form[whole], body.mass[whole])
    return centre, axis if axis @ (form[np.argmin(away)] - centre) > 0 else -axis


def _share(away: FloatArray, length: float) -> FloatArray:
    """Compute the share of a roll that each vertex takes: all near the tip, nothing at the root."""
    return smooth_ramp(1 - away / (_REACH * length), 0.0, 0.5)


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


def _turned(points: FloatArray, roll: _Roll) -> FloatArray:
    """Turn points about the axis of a limb, each by its share."""
    from scipy.spatial.transform import Rotation

    turn = Rotation.from_rotvec(np.outer(roll.share * (roll.sure * roll.angle), roll.axis))
    return np.asarray(roll.centre + turn.apply(points - roll.centre))
