"""Names of limbs: head, hands, feet and tail among the feature points, as the surface tells or as given by hand."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..numerics.arrays import FloatArray, IntArray
from ..run.errors import InvalidSettingsError
from .limbs import Limbs

NAMES = ("head", "left_hand", "right_hand", "left_foot", "right_foot", "tail")  # of four legs, hands are the front ones
_SIDES = {"left": 1, "right": -1}
_MATES = {each: each.replace("left", "none").replace("right", "left").replace("none", "right") for each in NAMES}
_AHEAD = {"head": -1.0, "tail": 1.0}  # weights of distances that fall towards the head
_LIMBS = {
    "spine.004": "head",
    "spine.006": "head",
    "forearm": "hand",
    "hand": "hand",
    "shin": "foot",
    "foot": "foot",
    "toe": "foot",
}
_PAIRS = 2  # of hands and feet
_CERTAIN = 1.0  # margin of what is known


def checked_names(names: object, count: int) -> tuple[str, ...] | None:
    """Check names of `count` chosen feature points; None for none, and for empty ones only.

    Examples
    --------
    >>> checked_names(["head", ""], 2), checked_names(["", ""], 2)
    (('head', ''), None)
    """
    if names is None:
        return None
    given = tuple(names) if isinstance(names, Sequence) and not isinstance(names, str) else (None,)
    known = [each for each in given if each != ""]
    if len(given) != count or not all(each in NAMES for each in known):
        raise InvalidSettingsError("feature_names", names=", ".join(NAMES))
    if len(set(known)) < len(known):
        raise InvalidSettingsError("feature_name_twice")
    return given if known else None


def names_in(text: str) -> list[str] | None:
    """Split names that are separated by commas; None if there are none.

    Examples
    --------
    >>> names_in("head, ,left_hand"), names_in("")
    (['head', '', 'left_hand'], None)
    """
    return [each.strip() for each in text.split(",")] if text.strip() else None


def side_of(name: str) -> int:
    """Return 1 for a limb on the left, -1 for one on the right, 0 for another.

    Examples
    --------
    >>> [side_of(each) for each in ("left_hand", "right_foot", "head")]
    [1, -1, 0]
    """
    return _SIDES.get(name.partition("_")[0], 0)


def mate_of(name: str) -> str:
    """Return the name of the same limb on the other side; a head stays one.

    Examples
    --------
    >>> mate_of("left_hand"), mate_of("tail"), mate_of("")
    ('right_hand', 'tail', '')
    """
    return _MATES.get(name, name)


def limb_names(limbs: Limbs, leftward: FloatArray | None = None) -> list[str]:
    """Name the feature points: as given by hand, else from the head to the tail; "" for those without a name.

    What lies in the middle is the head, and of several the last the tail; of two pairs those nearer the head are hands.

    `leftward` (k,): how far left each lies, where that is known better than by the distances on the surface.

    Examples
    --------
    >>> from scipy.spatial.distance import cdist
    >>> from addon.core.symmetry.limbs import limbs_of
    >>> body = np.array([[1.0, 2, 0], [-1, 2, 0], [1.1, -2, 0], [-1.1, -2, 0], [0, 4, 0]]) / 3
    >>> limbs = limbs_of(cdist(body, body), np.zeros((5, 5, 5)), np.array([2.0, 2, 2, 2, 1]), lambda: np.arange(5.0))
    >>> limb_names(limbs)
    ['left_hand', 'right_hand', 'left_foot', 'right_foot', 'head']
    >>> limb_names(limbs, -body[:, 0])[:2]
    ['right_hand', 'left_hand']
    """
    if any(limbs.named):
        return list(limbs.named)
    names = [""] * len(limbs.partner)
    if not limbs.side.any():
        return names
    for point in np.flatnonzero((limbs.side == 0) & (limbs.along != 0)):
        names[point] = "head" if limbs.along[point] < 0 else "tail"
    ahead = limbs.distances @ limbs.along
    swapped = leftward is not None and limbs.side @ leftward < 0
    left = np.flatnonzero(limbs.side == (-1 if swapped else 1))
    if len(left) == _PAIRS and "head" in names:
        for point, limb in zip(left[np.argsort(-(ahead + ahead[limbs.partner])[left])], ("hand", "foot"), strict=True):
            names[point], names[limbs.partner[point]] = f"left_{limb}", f"right_{limb}"
    return names


def names_by_bones(bones: Sequence[str]) -> list[str]:
    """Name feature points by the bones that move them, in Rigify's names; the first of several of a limb has its name.

    Examples
    --------
    >>> names_by_bones(["spine.006", "hand.L", "toe.R", "spine.006", "spine"])
    ['head', 'left_hand', 'right_foot', '', '']
    """
    names: list[str] = []
    for bone in bones:
        limb = _LIMBS.get(bone.removesuffix(".L").removesuffix(".R"), "")
        side = {".L": "left_", ".R": "right_"}.get(bone[-2:], "")
        names.append("" if not limb or side + limb in names else side + limb)
    return names


def with_names(limbs: Limbs, names: Sequence[str]) -> Limbs:
    """Take head, tail and sides from names given by hand; limbs without a name keep theirs where that agrees.

    `names`: one for each feature point, "" for none.
    """
    if not any(names):
        return limbs
    place = {name: point for point, name in enumerate(names) if name}
    partner = _partners(limbs, place)
    told = np.array([side_of(name) for name in names])
    alone = (told != 0) & ~told[partner].astype(bool)  # its mate has no name
    told[partner[alone]] = -told[alone]
    told[partner == np.arange(len(names))] = 0
    agree = float(told @ limbs.side)
    side = np.where(told != 0, told, -limbs.side if agree < 0 else limbs.side)
    side[partner == np.arange(len(names))] = 0
    return limbs._replace(
        partner=partner, side=side, along=_along(limbs, names, place), margin=_CERTAIN, named=tuple(names)
    )


def _partners(limbs: Limbs, place: dict[str, int]) -> IntArray:
    """Pair what is named with its mate; one whose mate has no name keeps a partner without a name."""
    partner, named = limbs.partner.copy(), set(place.values())
    for name, point in place.items():
        old = int(partner[point])
        if side_of(name) and _MATES[name] not in place and old != point and old not in named:
            continue
        partner[old], partner[point] = old, point
    for name, point in place.items():
        if _MATES[name] in place:
            partner[point] = place[_MATES[name]]
    return partner


def _along(limbs: Limbs, names: Sequence[str], place: dict[str, int]) -> FloatArray:
    """Weigh distances so that their sum rises towards what is named head, or from feet to hands."""
    weights = np.zeros(len(names))
    for name, weight in _AHEAD.items():
        if name in place:
            weights[place[name]] = weight
    if "head" in place:
        return weights
    for point, name in enumerate(names):
        weights[point] += {"hand": -0.5, "foot": 0.5}.get(name[-4:], 0.0)
    return weights if (weights < 0).any() else limbs.along


def named_images(one: Limbs, other: Limbs) -> list[IntArray]:
    """For each feature point named by hand that of the same name on another surface, (k,), -1 for all others.

    Where names of the other are none that were given, its left and right may be swapped: two images then.
    """
    given = one.named or ("",) * len(one.partner)
    there = {name: point for point, name in enumerate(limb_names(other)) if name}
    images = [[there.get(name, -1) for name in given]]
    if not any(other.named) and any(map(side_of, given)):
        images.append([there.get(_MATES.get(name, ""), -1) for name in given])
    return [np.array(image, dtype=np.int64) for image in images]
