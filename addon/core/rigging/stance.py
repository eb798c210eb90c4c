"""Where the bones of a body stand in a T-pose or an A-pose: arms and legs straight, everything else as at rest."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..numerics.arrays import FloatArray
from ..numerics.vectors import angle
from .limb_bones import LimbBones
from .skeleton import BoneMotions, Skeleton

ARMS_LOWERED = {"T": 0.0, "A": 45.0}  # degrees
_NATURAL = {"arm": (5.0, 12.0), "leg": (15.0, 25.0)}  # degrees: a limb whose line is as near to the stance, and whose
# joint is bent no more, stands so by nature and keeps its shape
_LEANS = 30.0  # degrees from the axes of the file up to which the trunk of a body that lies leans by nature
_STANDING = 0.5  # how far down a leg reaches, over its length, of a body that stands on it
_SPREAD = 6.0  # degrees outward up to which legs keep their way to the ground
_STILL = 1.0  # degrees by which legs may stand too near or too far apart and stay as they are
_APART = 1.15  # widths of a foot, from the middle of one to that of the other
_FOLDED = 60.0  # degrees: a knee that rests as folded is an animal's


def stance(skeleton: Skeleton, limbs: Sequence[LimbBones], pose: str, foot_width: float = 0.0) -> BoneMotions:
    """Compute the motions that put a rig from its rest into a stance, facing -Y, Z up.

    Arms go straight out to the sides, or down by 45°, legs straight to the ground, each bone by the shortest turn, so
    that hands keep their roll; trunk, head and feet stay as at rest, turned with the whole body. A rig that rests in
    that stance is left as it is.

    `skeleton`: the bones at rest; `limbs`: both arms and legs; `pose`: 'T' or 'A'; `foot_width`: across a foot, for
    feet must not stand in each other.

    Examples
    --------
    >>> heads = np.array([[0, 0, 1.0], [0.2, 0, 2], [-0.2, 0, 2], [0.2, 0, 1], [-0.2, 0, 1]])
    >>> tails = heads + [[0, 0, 1.0], [1, 0, -1], [-1, 0, -1], [0, 0, -1], [0, 0, -1]]
    >>> rig = Skeleton(["hips", "a", "b", "c", "d"], np.array([-1, 0, 0, 0, 0]), heads, tails)
    >>> limbs = [LimbBones(kind, side, [bone], -1) for kind, side, bone in
    ...          (("arm", 1, 1), ("arm", -1, 2), ("leg", 1, 3), ("leg", -1, 4))]
    >>> motions = stance(rig, limbs, "T")
    >>> (motions.turns[1] @ [1, 0, -1]).round(3).tolist()
    [1.414, 0.0, 0.0]
    """
    facing = facing_of(skeleton, limbs)
    turns = np.broadcast_to(facing, (len(skeleton.names), 3, 3)).copy()
    ways = {(limb.kind, limb.side): _wanted(skeleton, limb, limbs, facing, pose, foot_width) for limb in limbs}
    parents, own = skeleton.parents.copy(), np.zeros(len(turns), dtype=bool)
    parts = [_segments(skeleton, limb) for limb in limbs]
    for limb, segments in zip(limbs, parts, strict=True):
        wanted, whole = ways[limb.kind, limb.side], facing @ sum(segments)
        bend = max(map(angle, segments, segments[1:]), default=0.0)
        near, straight = _NATURAL[limb.kind]
        level = np.array([1.0, 0, 1]) if limb.kind == "leg" else np.zeros(3)
        aside = level.any() and angle(whole * level, wanted) > _STILL
        turn = swing(whole * level, wanted) @ facing if aside else facing  # legs as far apart as wanted
        natural = angle(turn @ sum(segments), wanted) < near and bend < straight
        turn, before = turn if natural else facing, -1
        for bone, way in zip(limb.bones, segments, strict=True):
            if not natural and not (limb.kind == "leg" and bend > _FOLDED):
                turn = swing(turn @ way, wanted) @ turn
            turns[bone], own[bone] = turn, True
            if before >= 0 and before not in skeleton.ancestors(bone):
                parents[bone] = before  # bones that are moved by a target hang on nothing
            before = bone
        if limb.end >= 0:
            own[limb.end] = True
            turns[limb.end] = turn if limb.kind == "arm" else facing  # feet stay flat
            if before not in skeleton.ancestors(limb.end):
                parents[limb.end] = before
    heads = skeleton.heads @ facing.T
    for bone in skeleton._replace(parents=parents).downwards():
        above = int(parents[bone])
        if above < 0:
            continue
        if not own[bone]:
            turns[bone] = turns[above]
        heads[bone] = heads[above] + turns[above] @ (skeleton.heads[bone] - skeleton.heads[above])
    return BoneMotions(skeleton.heads, heads, turns)


def swing(one: FloatArray, two: FloatArray) -> FloatArray:
    """Compute the smallest rotation (3, 3) from one direction to another (3,).

    Examples
    --------
    >>> (swing(np.array([0.0, 2, 0]), np.array([0.0, 0, 1])) @ [0, 1, 0]).round(9).tolist()
    [0.0, 0.0, 1.0]
    """
    from scipy.spatial.transform import Rotation

    axis = np.cross(one, two)
    size = np.linalg.norm(axis)
    if size < 1e-12 * np.linalg.norm(one) * np.linalg.norm(two):  # about any axis across, if they are opposed
        axis = np.cross(one, np.eye(3)[np.argmin(np.abs(one))])
        size = np.linalg.norm(axis)
    return np.asarray(Rotation.from_rotvec(np.radians(angle(one, two)) * axis / size).as_matrix())


def leg_spread(foot_width: float, hips: float, leg: float) -> float:
    """Return the angle by which legs must be spread so that feet stand beside each other.

    `foot_width`: across a foot; `hips`: from hip to hip; `leg`: length of a leg.

    Examples
    --------
    >>> leg_spread(0.1, 0.2, 0.9)
    0.0
    """
    return float(np.arcsin(np.clip((_APART * foot_width - hips) / 2 / leg, 0.0, 0.5)))


def facing_of(skeleton: Skeleton, limbs: Sequence[LimbBones]) -> FloatArray:
    """Find the rotation (3, 3) of the whole body after which its left is +X and it stands along Z.

    A body that rests on its legs stands already, however its trunk lies: a dinosaur's is level.
    """
    at = {(limb.kind, limb.side): limb.joints(skeleton)[0] for limb in limbs}
    left = unit(at["arm", 1] - at["arm", -1]) + unit(at["leg", 1] - at["leg", -1])
    up = at["arm", 1] + at["arm", -1] - at["leg", 1] - at["leg", -1]
    legs = [limb.joints(skeleton) for limb in limbs if limb.kind == "leg"]
    drop = sum(leg[0, 2] - leg[-1, 2] for leg in legs)
    if drop > _STANDING * sum(np.linalg.norm(np.diff(leg, axis=0), axis=1).sum() for leg in legs):
        left = unit(left * [1.0, 1, 0])
        return np.array([left, np.cross([0.0, 0.0, 1.0], left), [0.0, 0.0, 1.0]])
    left = unit(left)
    up = unit(up - (up @ left) * left)
    axes = np.array([left, np.cross(up, left), up])
    nearest = np.round(axes)  # quarter turns, if the body leans no more than bodies do
    proper = (np.abs(nearest).sum(axis=0) == 1).all() and (np.abs(nearest).sum(axis=1) == 1).all()
    leans = np.degrees(np.arccos(np.clip((np.trace(nearest.T @ axes) - 1) / 2, -1, 1)))
    return nearest if proper and leans < _LEANS else axes


def _wanted(
    skeleton: Skeleton, limb: LimbBones, limbs: Sequence[LimbBones], facing: FloatArray, pose: str, foot_width: float
) -> FloatArray:
    """Return the direction of a limb in the stance."""
    if limb.kind == "arm":
        lowered = np.radians(ARMS_LOWERED[pose])
        return np.array([limb.side * np.cos(lowered), 0.0, -np.sin(lowered)])
    joints = limb.joints(skeleton) @ facing.T
    way = joints[-1] - joints[0]
    length = np.linalg.norm(np.diff(joints, axis=0), axis=1).sum()
    other = next(each for each in limbs if each.kind == "leg" and each.side == -limb.side).joints(skeleton) @ facing.T
    apart = limb.side * (joints[0] - other[0])[0]  # of the hips
    outward = float(np.arctan2(limb.side * way[0], max(-way[2], 1e-9)))
    least = leg_spread(foot_width, apart, length)
    most = np.radians(_SPREAD)
    spread = np.clip(outward, least, np.maximum(most, least))
    return np.array([limb.side * np.sin(spread), 0.0, -np.cos(spread)])


def _segments(skeleton: Skeleton, limb: LimbBones) -> list[FloatArray]:
    """List the directions of a limb's segments."""
    return list(np.diff(limb.joints(skeleton), axis=0))


def unit(vector: FloatArray) -> FloatArray:
    """Divide a vector by its length; a zero vector stays."""
    return np.asarray(vector / max(float(np.linalg.norm(vector)), float(np.finfo(float).tiny)))
