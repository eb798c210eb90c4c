"""A body in a stance by its fitted skeleton: the bones of the reference, in its own lengths, equal left and right."""

from __future__ import annotations

import numpy as np

from ..numerics.arrays import FloatArray
from .bone_fit import BoneFit
from .fitted_rig import settled_turns
from .reference_rig import ReferenceRig
from .skeleton import BoneMotions, skinned
from .stance import leg_spread

_LEAST_HIPS = 0.02  # of the body's size: half the distance between the hips
_FEW = 3  # vertices of a foot, below which its width is not known


def fitted_stance(
    rig: ReferenceRig, fit: BoneFit, points: FloatArray, weights: FloatArray, turns: FloatArray | None = None
) -> FloatArray:
    """Move points of a body with its fitted bones into the pose of the reference, or one given by turns of its bones.

    `points` (n, 3); `weights` (n, b); `turns` (b, 3, 3): of the reference's bones from its rest; gives (n, 3).
    """
    parents, axes = rig.skeleton.parents, rig.axes
    own = settled_turns(rig, fit)
    size, mates = float(np.ptp(points, axis=0).max()), rig.mates
    offset = np.zeros((len(parents), 3))
    for bone, parent in enumerate(parents):
        if parent >= 0:
            offset[bone] = own[parent].T @ (fit.heads[bone] - fit.heads[parent])
    offset = (offset + offset[mates] * [-1.0, 1, 1]) / 2
    there = np.zeros((len(parents), 3))
    goal = np.broadcast_to(np.eye(3), (len(parents), 3, 3)).copy() if turns is None else turns.copy()
    _spread_legs(rig, fit, own, offset, goal, points, weights)
    for bone, parent in enumerate(parents):
        if parent < 0:
            continue
        if np.allclose(rig.skeleton.heads[bone], rig.skeleton.tails[parent]):
            long = np.linalg.norm(fit.tails - fit.heads, axis=1)[[parent, mates[parent]]].mean()
            offset[bone] = long * axes[parent]
        elif rig.skeleton.names[bone].startswith("thigh"):
            side = np.sign(rig.skeleton.heads[bone, 0])
            offset[bone, 0] = side * max(abs(offset[bone, 0]), _LEAST_HIPS * size)
        there[bone] = there[parent] + goal[parent] @ offset[bone]
    return skinned(points, weights, BoneMotions(fit.heads, there, goal @ own.transpose(0, 2, 1)))


def _spread_legs(
    rig: ReferenceRig,
    fit: BoneFit,
    own: FloatArray,
    offset: FloatArray,
    goal: FloatArray,
    points: FloatArray,
    weights: FloatArray,
) -> None:
    """Turn the legs outward as far as feet that are wider than the hips need to stand beside each other."""
    number, most = rig.skeleton.names.index, weights.argmax(axis=1)
    widths = []
    for side in "LR":
        foot = number(f"foot.{side}")
        across = (points[np.isin(most, [foot, number(f"toe.{side}")])] - fit.heads[foot]) @ own[foot][:, 0]
        widths += [float(np.ptp(across))] if len(across) > _FEW else []
    long = np.linalg.norm(fit.tails - fit.heads, axis=1)
    leg = sum(long[number(f"{name}.{side}")] for name in ("thigh", "shin") for side in "LR") / 2
    hips = offset[number("thigh.L"), 0] - offset[number("thigh.R"), 0]
    spread = leg_spread(min(widths, default=0.0), hips, leg)
    for side, sign in (("L", -1.0), ("R", 1.0)):
        for name in ("thigh", "shin"):
            goal[number(f"{name}.{side}")] = about_y(sign * spread)


def arm_turns(rig: ReferenceRig, lowered: float) -> FloatArray:
    """Return the turns of the reference's bones that lower its arms by some degrees, (b, 3, 3)."""
    turns = np.broadcast_to(np.eye(3), (len(rig.skeleton.names), 3, 3)).copy()
    for bone, name in enumerate(rig.skeleton.names):
        if name.startswith(("upper_arm", "forearm", "hand")):
            side = 1.0 if name.endswith(".L") else -1.0
            turns[bone] = about_y(side * np.radians(lowered))
    return turns


def about_y(angle: float) -> FloatArray:
    """Return the rotation about Y by an angle, (3, 3)."""
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array([[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]])
