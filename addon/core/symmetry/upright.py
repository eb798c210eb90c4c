"""The upright orientation of a body: its left, head and front from the surface, aligned to the axes of the scene."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..numerics.arrays import FloatArray, IntArray
from .limbs import Limbs
from .mirror import mirror_plane

_UNDERNEATH = 0.12  # least mean offset of the limbs' ends towards the front, in sqrt(area), of a body on all fours
_TAIL = 0.25  # least distance from the middle to the tail's end, in sqrt(area): hair is no tail
_UNTOLD = 1e-3  # vectors that are shorter give no direction
_STANDS = 0.5  # cosine between an axis and that of the file, above which the body stands along it
_ENDS = 5  # of a body with head and four limbs: with fewer, the one in the middle may be any
_LEG = (0.1, 0.3)  # distance from the tip of a foot, in sqrt(area), where the leg is measured
_FEWEST = 8  # vertices of it
_POINT = 0.15  # cosine between slope and front, below which toes tell nothing
SURELY = 1 / _POINT  # what distances tell that no toes can gainsay
_NEAR_AN_END = 0.4  # distance from the ends of the limbs, in sqrt(area), within which a surface counts as low
# left, head and front of a body in axes with Z up and -Y towards the viewer of the front view
_STANDING = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
_ON_ALL_FOURS = np.array([[1.0, 0, 0], [0, -1, 0], [0, 0, -1]])


def upright_rotation(
    form: FloatArray,
    weights: FloatArray,
    limbs: Limbs,
    partner: IntArray | None,
    *,
    stance: str = "upright",
    posed: FloatArray | None = None,
) -> tuple[FloatArray, bool]:
    """Find the rotation that makes a form upright: Z up, its face or the front of its trunk towards -Y.

    Left and right come from the mirror plane of the form, the direction of the head from the whole surface: where the
    distance from the tail minus that from the head increases. A body with a tail, or with its limbs underneath, stands
    on all fours, with its head towards -Y; any other on two legs, with its head up. Limbs underneath level the body:
    head and tail lie as far along it, and the ends of the limbs as low, as possible. A surface without left and right
    stands along its longest axis, its broad side to the front; the first feature point and the order of the vertices
    determine the signs of its axes.

    Where the distances hardly tell front from back, as in people, or toes gainsay them, the toes do; what the surface
    does not tell at all, head from feet without a limb in the middle or with fewer than five, and front from back
    without toes, is taken from the file: a body that stands upright there stays so.

    `form` (n, 3); `weights` (n,); `limbs`: head, tail and sides among them; `partner` (n,); `stance`: the stance;
    'upright' lets the surface decide; `posed` (3, 3): the rotation to how the body lies in the file; gives (3, 3), and
    whether the file had a say.

    Examples
    --------
    >>> from addon.core.symmetry.limbs import limbs_of
    >>> body = np.array([[1.0, 0, 2], [-1, 0, 2], [1.1, 0, -2], [-1.1, 0, -2], [0, 0.1, 4]]) / 3
    >>> far = np.linalg.norm(body[:, None] - body, axis=2)
    >>> limbs = limbs_of(far, np.zeros((5, 5, 5)), np.array([2.0, 2, 2, 2, 1]), lambda: np.arange(5.0))
    >>> turned = body[:, [1, 2, 0]]
    >>> upright = turned @ upright_rotation(turned, np.ones(5), limbs, None)[0]
    >>> bool(np.allclose(upright[:2, 0], [1 / 3, -1 / 3])), bool(upright[4, 2] > 1)
    (True, True)
    """
    centred, share, ahead = placed = _placed(form, weights, limbs)
    left, headward, front = _axes(placed, limbs, partner)
    paired, by_file = limbs.side != 0, False
    up = np.zeros(3) if posed is None else posed[:, 2]
    headless = paired.all() or (paired.any() and len(paired) < _ENDS)  # what lies in the middle may be a tail or a hem
    if headless and abs(headward @ up) > _STANDS:
        by_file = True
        if headward @ up < 0:
            left, headward, ahead = -left, -headward, -ahead
    weak = bool(paired.any()) and not limbs.tell_sides
    if paired.any() and limbs.told < SURELY:
        toes = _toes(centred, limbs, headward, front)
        untold = weak and abs(toes) < _POINT
        if untold and posed is not None and headward @ up > _STANDS and abs(front @ posed[:, 1]) > _STANDS:
            by_file, toes = True, -float(front @ posed[:, 1])  # -Y is the front of a scene
        if toes < -_POINT * max(limbs.told, 1.0):
            left, front = -left, -front
    underneath = (centred[limbs.features[paired]] @ front).mean() if paired.any() else 0.0
    tailed = (limbs.along > 0).any() and (centred[limbs.features[np.argmax(limbs.along)]] @ headward) < -_TAIL
    if underneath > _UNDERNEATH and np.ptp(ahead) > _UNTOLD:
        low = np.exp(-limbs.to_features[:, paired].min(axis=1) / _NEAR_AN_END)
        headward, front = _levelled(centred, share, (headward, front), (ahead, low))
    if stance == "upright":
        stance = "all_fours" if tailed or underneath > _UNDERNEATH else "two_legs"
    if stance == "all_fours" and weak and front @ up > _STANDS:  # on its back
        by_file, left, front = True, -left, -front
    axes = np.column_stack([left, headward, front])
    return np.asarray(axes @ (_ON_ALL_FOURS if stance == "all_fours" else _STANDING)), by_file


def body_axes(form: FloatArray, weights: FloatArray, limbs: Limbs) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Find the directions of a form to its left, to its head and to its front; feature points determine the plane.

    Gives left, headward, front (3,).

    Examples
    --------
    >>> from addon.core.symmetry.limbs import limbs_of
    >>> body = np.array([[1.0, 0, 2], [-1, 0, 2], [1.1, 0, -2], [-1.1, 0, -2], [0, 0.1, 4]]) / 3
    >>> far = np.linalg.norm(body[:, None] - body, axis=2)
    >>> limbs = limbs_of(far, np.zeros((5, 5, 5)), np.array([2.0, 2, 2, 2, 1]), lambda: np.arange(5.0))
    >>> left, headward, front = body_axes(body, np.ones(5), limbs)
    >>> bool(left[0] > 0.99), bool(headward[2] > 0.99), bool(front[1] < -0.99)
    (True, True, True)
    """
    return _axes(_placed(form, weights, limbs), limbs, None)


def facing(form: FloatArray, weights: FloatArray, limbs: Limbs) -> float:
    """Tell how surely the left limbs are those on the left of the body: from 1 on they are, to -1 those on its right.

    By the distances on the surface, and by toes, which point to the front. `form` (n, 3); `weights` (n,).

    Examples
    --------
    >>> from addon.core.symmetry.limbs import limbs_of
    >>> body = np.array([[1.0, 0, 2], [-1, 0, 2], [1.1, 0, -2], [-1.1, 0, -2], [0, 0.1, 4]]) / 3
    >>> far = np.linalg.norm(body[:, None] - body, axis=2)
    >>> limbs = limbs_of(far, np.zeros((5, 5, 5)), np.array([2.0, 2, 2, 2, 1]), lambda: np.arange(5.0))
    >>> facing(body, np.ones(5), limbs)
    0.0
    """
    if not limbs.side.any():
        return 0.0
    if limbs.told >= SURELY:
        return limbs.told
    placed = _placed(form, weights, limbs)
    _, headward, front = _axes(placed, limbs, None)
    toes = _toes(placed.points, limbs, headward, front)
    return limbs.told + (toes / _POINT if abs(toes) >= _POINT else 0.0)


class _Placed(NamedTuple):
    """A form about its centre, and which way its head is."""

    points: FloatArray  # (n, 3)
    share: FloatArray  # (n,) of the area, of each vertex
    ahead: FloatArray  # (n,) increases from tail to head


def _placed(form: FloatArray, weights: FloatArray, limbs: Limbs) -> _Placed:
    """Centre a form, and weigh its distances from the feature points."""
    share = weights / weights.sum()
    return _Placed(form - share @ form, share, limbs.to_features @ _poles(limbs))


def _axes(placed: _Placed, limbs: Limbs, partner: IntArray | None) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Find left, head and front; the mirror partners of all vertices, or the feature points, determine the plane."""
    (centred, share, ahead), features = placed, limbs.features
    headward = centred.T @ (share * (ahead - share @ ahead))
    covariance = (centred * share[:, None]).T @ centred
    place = share * (np.arange(len(share)) - share @ np.arange(len(share)))  # the order of the vertices
    if limbs.side.any():
        other = centred[features[limbs.partner]] if partner is None else centred[partner]
        some, per = (centred[features], np.ones(len(features))) if partner is None else (centred, share)
        left = mirror_plane(some, other, per).normal
        left = left * _sign(float(limbs.side @ (centred[features] @ left)))
        headward = headward - (headward @ left) * left
        if np.linalg.norm(headward) < _UNTOLD:  # a tube with two similar ends
            within = np.eye(3) - np.outer(left, left)
            headward = np.linalg.eigh(within @ covariance @ within)[1][:, 2]
            headward = headward * _sign(float(place @ centred @ headward))
        headward = headward / np.linalg.norm(headward)
    else:
        axes = np.linalg.eigh(covariance)[1]
        end = float(centred[features[0]] @ axes[:, 2])
        headward = axes[:, 2] * _sign(end if abs(end) > _UNTOLD else float(place @ centred @ axes[:, 2]))
        left = axes[:, 1] * _sign(float(place @ centred @ axes[:, 1]))
    return left, headward, np.cross(left, headward)


def _toes(centred: FloatArray, limbs: Limbs, headward: FloatArray, front: FloatArray) -> float:
    """Tell how far the toes of the lowest two limbs point to the front, -1 to 1: the shin is nearer to them there."""
    paired = np.flatnonzero(limbs.side != 0)
    height = centred[limbs.features] @ headward
    foot = int(paired[np.argmin((height + height[limbs.partner])[paired])])
    nearest, cosines = np.argmin(limbs.to_features, axis=1), []
    for limb in (foot, int(limbs.partner[foot])):
        away = limbs.to_features[:, limb]
        leg = (nearest == limb) & (away > _LEG[0]) & (away < _LEG[1])
        if np.count_nonzero(leg) < _FEWEST:
            return 0.0
        places = centred[leg] - centred[leg].mean(axis=0)
        slope = np.linalg.lstsq(places, away[leg] - away[leg].mean(), rcond=None)[0]
        cosines.append(-float(slope @ front) / (float(np.linalg.norm(slope)) or 1.0))
    return float(np.mean(cosines))


def _levelled(
    centred: FloatArray, share: FloatArray, axes: tuple[FloatArray, FloatArray], wanted: tuple[FloatArray, FloatArray]
) -> list[FloatArray]:
    """Rotate two axes in their plane so that positions along both fit two functions best, each as wide as these."""
    along = [centred @ axis for axis in axes]
    target = [each - share @ each for each in wanted]
    wide = [np.sqrt((share @ place**2) / (share @ each**2)) for each, place in zip(target, along, strict=True)]
    target = [each * width for each, width in zip(target, wide, strict=True)]
    across = share @ (target[0] * along[1] - target[1] * along[0])
    angle = np.arctan2(across, share @ (target[0] * along[0] + target[1] * along[1]))
    return [
        np.cos(angle) * axes[0] + np.sin(angle) * axes[1],
        np.cos(angle) * axes[1] - np.sin(angle) * axes[0],
    ]


def _poles(limbs: Limbs) -> FloatArray:
    """Weigh distances so that their sum increases from tail to head, or from the hindmost limbs if there is no tail."""
    weights = limbs.along.copy()
    paired = limbs.side != 0
    if paired.any() and not (weights > 0).any():
        far = np.where(paired, limbs.distances @ -weights, -np.inf)
        last = int(np.argmax(far + far[limbs.partner]))
        weights[[last, limbs.partner[last]]] += -weights.sum() / 2
    return weights


def _sign(value: float) -> float:
    """Return -1 for values below 0, and 1 otherwise."""
    return -1.0 if value < 0 else 1.0
