"""The bones of arms and legs: by their names, else by the shape of the skeleton."""

from __future__ import annotations

from itertools import combinations
from typing import NamedTuple

import numpy as np

from ..numerics.arrays import FloatArray, IntArray
from .bone_names import BoneName, roles_of
from .skeleton import Skeleton

_SEGMENTS = {"arm": ("upper arm", "forearm", "hand"), "leg": ("thigh", "shin", "foot")}
_SHORT = 0.03  # of a limb: shorter bones have no direction of their own
_PARTNERS = 0.03  # of the height: distance of a mirrored bone from its partner
_DOWN = 0.5  # of its length: how far down a leg reaches
_COLLAR = 0.6  # of the next bone: a shorter one at a limb's root is a collarbone, or a hip


class LimbBones(NamedTuple):
    """The bones of a limb.

    Attributes
    ----------
    kind : {'arm', 'leg'}
        Which limb.
    side : int
        1 for the left one, -1 for the right one.
    bones : list of int
        Its segments, from the shoulder or hip to the elbow or knee, and on.
    end : int
        The hand or foot; -1 if the last segment holds it.
    """

    kind: str
    side: int
    bones: list[int]
    end: int

    def joints(self, skeleton: Skeleton) -> FloatArray:
        """List where its segments begin, and where the last ends, (s + 1, 3)."""
        last = skeleton.tails[self.bones[-1]] if self.end < 0 else skeleton.heads[self.end]
        return np.vstack([skeleton.heads[self.bones], last])


def limb_bones(skeleton: Skeleton, weights: FloatArray) -> list[LimbBones]:
    """Find both arms and both legs of a rig; empty if it has none, or more.

    `skeleton`: the bones at rest, left of the body at +X if the names do not tell; `weights` (n, b): the skin, as
    control bones have none.

    Examples
    --------
    >>> limb_bones(Skeleton(["root"], np.array([-1]), np.zeros((1, 3)), np.eye(3)[2:]), np.ones((1, 1)))
    []
    """
    skin = weights.sum(axis=0)
    named = _by_names(skeleton, skin)
    return _by_shape(skeleton, skin) if named is None else named


def _by_names(skeleton: Skeleton, skin: FloatArray) -> list[LimbBones] | None:
    """Find the limbs by the names of their bones; None if these do not tell, empty if a limb runs to the trunk."""
    named = roles_of(skeleton.names)
    depth = [len(skeleton.ancestors(bone)) for bone in range(len(named))]
    below = _skin_below(skeleton, skin)
    found = []
    for kind, roles in _SEGMENTS.items():
        for side in (1, -1):
            upper, lower = (_first(named, BoneName(side, role), depth, below) for role in roles[:2])
            end = _nearest(skeleton, named, BoneName(side, roles[2]), lower, depth, below)
            if upper < 0 and end >= 0:  # an arm without a name of its own
                upper = next((each for each in reversed(skeleton.ancestors(end)) if named[each].side == side), -1)
            if upper < 0:
                return None
            way = [lower, *skeleton.ancestors(lower)] if lower >= 0 else []
            bones = way[way.index(upper) :: -1] if upper in way else [upper, *([lower] if lower >= 0 else [])]
            if end >= 0 and end in bones:
                end = -1
            if any(later in skeleton.ancestors(earlier) for earlier, later in combinations([*bones, end], 2)):
                return []
            limb = LimbBones(kind, side, bones, end)
            found.append(limb._replace(bones=_long(skeleton, limb)))
    return found


def _first(named: list[BoneName], wanted: BoneName, depth: list[int], skin: FloatArray) -> int:
    """Find the bone of a name that is nearest to the root, of those that hold or carry skin; -1 for none."""
    known = [bone for bone, name in enumerate(named) if name == wanted and skin[bone] > 0]
    return min(known, key=lambda bone: (depth[bone], bone), default=-1)


def _nearest(
    skeleton: Skeleton, named: list[BoneName], wanted: BoneName, lower: int, depth: list[int], skin: FloatArray
) -> int:
    """Find the bone of a name that begins where a segment ends, for palms and wrists may be several; -1 for none."""
    if lower < 0:
        return _first(named, wanted, depth, skin)
    known = [bone for bone, name in enumerate(named) if name == wanted and skin[bone] > 0]
    far = [float(np.linalg.norm(skeleton.heads[bone] - skeleton.tails[lower])) for bone in known]
    return known[int(np.argmin(far))] if known else -1


def _by_shape(skeleton: Skeleton, skin: FloatArray) -> list[LimbBones]:
    """Find the limbs as pairs of chains that mirror each other: the lowest are legs, the longest others arms."""
    used = np.flatnonzero(_skin_below(skeleton, skin) > 0)
    if len(used) < len(_SEGMENTS):
        return []
    middle = float(skeleton.heads[used, 0].mean())
    partner = _partners(skeleton, used, middle)
    size = float(np.ptp(skeleton.heads[used], axis=0).max())
    chains = []
    for bone in used[partner[used] >= 0]:
        above = skeleton.parents[bone]
        if skeleton.heads[bone, 0] > middle and (above < 0 or partner[above] < 0):
            chain = _longest_chain(skeleton, int(bone), set(used.tolist()))
            length = np.linalg.norm(skeleton.tails[chain[-1]] - skeleton.heads[chain[0]])
            if len(chain) > 1 and length > 0.2 * size:
                chains.append((chain, float(length), float(skeleton.tails[chain[-1], 2])))
    if len(chains) < len(_SEGMENTS):
        return []
    downward = [each for each in chains if skeleton.heads[each[0][0], 2] - each[2] > _DOWN * each[1]]
    if not downward:
        return []
    leg = min(downward, key=lambda each: each[2])
    arm = max((each for each in chains if each is not leg), key=lambda each: each[1])
    found = []
    for kind, chain in (("arm", arm[0]), ("leg", leg[0])):
        left = _segments(skeleton, chain)
        if (partner[left] < 0).any():
            return []
        for side, bones in ((1, left), (-1, [int(partner[bone]) for bone in left])):
            found.append(
                LimbBones(kind, side, bones[:-1] if len(bones) > 2 else bones, bones[-1] if len(bones) > 2 else -1)
            )
    return found


def _skin_below(skeleton: Skeleton, skin: FloatArray) -> FloatArray:
    """Sum the skin of each bone and of all that hang on it."""
    total = skin.copy()
    for bone in reversed(skeleton.downwards()):
        if skeleton.parents[bone] >= 0:
            total[skeleton.parents[bone]] += total[bone]
    return total


def _partners(skeleton: Skeleton, used: IntArray, middle: float) -> IntArray:
    """Find the mirror image of each bone across a plane of X; -1 for none and for bones in the middle."""
    height = float(np.ptp(skeleton.heads[used], axis=0).max())
    image = skeleton.heads * [-1.0, 1, 1] + [2 * middle, 0, 0]
    far = np.linalg.norm(image[used][:, None] - skeleton.heads[used], axis=2)
    far[np.abs(skeleton.heads[used, 0] - middle) < _PARTNERS * height / 2] = np.inf
    partner = np.full(len(skeleton.names), -1)
    nearest = far.argmin(axis=1)
    mutual = (nearest[nearest] == np.arange(len(used))) & (far.min(axis=1) < _PARTNERS * height)
    partner[used[mutual]] = used[nearest[mutual]]
    return partner


def _longest_chain(skeleton: Skeleton, bone: int, used: set[int]) -> list[int]:
    """Follow the bones to the farthest end, of fingers the longest."""
    ways = [
        _longest_chain(skeleton, int(child), used)
        for child in np.flatnonzero(skeleton.parents == bone)
        if child in used
    ]
    reach = lambda way: float(np.linalg.norm(skeleton.tails[way[-1]] - skeleton.heads[bone]))  # noqa: E731
    return [bone, *max(ways, key=reach, default=[])]


def _segments(skeleton: Skeleton, chain: list[int]) -> list[int]:
    """Cut a chain at the elbow and the wrist: two segments of about one length, and the end."""
    heads = skeleton.heads[chain]
    length = np.linalg.norm(np.diff(np.vstack([heads, skeleton.tails[chain[-1]]]), axis=0), axis=1)
    first = 1 if len(chain) > 3 and length[0] < _COLLAR * length[1] else 0
    if len(chain) - first < 3:
        return chain[first:]
    pairs = [(a, b) for a in range(first + 1, len(chain) - 1) for b in range(a + 1, len(chain))]
    even = [
        abs(np.log(length[first:a].sum() / max(length[a:b].sum(), 1e-9))) - length[first:b].sum() / length.sum()
        for a, b in pairs
    ]
    elbow, wrist = pairs[int(np.argmin(even))]
    return [chain[first], chain[elbow], chain[wrist]]


def _long(skeleton: Skeleton, limb: LimbBones) -> list[int]:
    """Leave out bones of a limb that are too short to have a direction; they follow."""
    joints = limb.joints(skeleton)
    length = np.linalg.norm(np.diff(joints, axis=0), axis=1)
    kept = [bone for bone, own in zip(limb.bones, length, strict=True) if own > _SHORT * length.sum()]
    return kept or limb.bones[:1]
