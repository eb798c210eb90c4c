"""A body in a stance by its fitted skeleton: the bones of the reference, in its own lengths, equal left and right."""

from __future__ import annotations

import numpy as np

from ..numerics.arrays import FloatArray
from ..run.errors import InvalidMeshError
from .bone_fit import BoneFit
from .fitted_rig import settled_turns
from .limb_bones import limb_bones
from .reference_rig import ReferenceRig
from .skeleton import BoneMotions
from .stance import ARMS_LOWERED, leg_spread, stance

_LEAST_HIPS = 0.02  # of the body's size: half the distance between the hips
_SOLE, _ROUNDS = 6, 3  # parts of a foot from heel to toe
_STRAIGHT, _TIPPED = 0.03, 50.0  # lengths of a foot, and degrees, beyond which it is no sole that was found
_FEW = 3  # vertices of a foot, below which its width is not known


def fitted_stance(
    rig: ReferenceRig, fit: BoneFit, points: FloatArray, weights: FloatArray, turns: FloatArray
) -> BoneMotions:
    """Compute how the fitted bones of a body move into a pose that is given by turns of the reference's.

    A human body comes to stand on flat soles, feet beside each other, left and right equal.

    `points` (n, 3), `weights` (n, b): of the body; `turns` (b, 3, 3): of the reference's bones from its rest, as
    `goal_turns` gives them.
    """
    parents, axes = rig.skeleton.parents, rig.axes  # parents come before their children
    own = settled_turns(rig, fit)
    if rig.is_human:
        _level_soles(rig, fit, own, points, weights)
    size, mates = float(np.ptp(points, axis=0).max()), rig.mates
    offset = np.zeros((len(parents), 3))
    above = np.where(parents < 0, 0, parents)  # other roots keep their place beside the first
    for bone, parent in enumerate(above):
        offset[bone] = own[parent].T @ (fit.heads[bone] - fit.heads[parent])
    if rig.is_human:
        offset = (offset + offset[mates] * [-1.0, 1, 1]) / 2
    there = np.zeros((len(parents), 3))
    goal = turns.copy()
    if rig.is_human:
        _spread_legs(rig, fit, own, offset, goal, points, weights)
    for bone, parent in enumerate(above):
        if bone == 0:
            continue
        name = rig.skeleton.names[bone]
        if np.allclose(rig.skeleton.heads[bone], rig.skeleton.tails[parent]) and not name.startswith("toe"):
            long = np.linalg.norm(fit.tails - fit.heads, axis=1)[[parent, mates[parent]]].mean()
            offset[bone] = long * axes[parent]
        elif rig.is_human and name.startswith("thigh"):
            side = np.sign(rig.skeleton.heads[bone, 0])
            offset[bone, 0] = side * max(abs(offset[bone, 0]), _LEAST_HIPS * size)
        there[bone] = there[parent] + goal[parent] @ offset[bone]
    return BoneMotions(fit.heads, there, goal @ own.transpose(0, 2, 1))


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


def _level_soles(rig: ReferenceRig, fit: BoneFit, own: FloatArray, points: FloatArray, weights: FloatArray) -> None:
    """Lay the soles flat: hems and shoes hide what tells how a foot is turned, and its bone is often tipped."""
    number, most = rig.skeleton.names.index, weights.argmax(axis=1)
    for side in "LR":
        foot, toe = number(f"foot.{side}"), number(f"toe.{side}")
        skin = points[np.isin(most, [foot, toe])] - fit.heads[foot]
        if len(skin) < _SOLE * _FEW:
            continue
        limb = own[number(f"shin.{side}")]
        for guess, tip in ((own[foot], own[toe]), (limb, limb)):  # as it was found, or as it is at rest
            pitch, uneven = 0.0, np.inf
            for _ in range(_ROUNDS):  # the parts that are lowest change as it is turned
                more, uneven = _slope(skin @ guess @ about_x(-pitch).T)
                pitch += more
            if uneven < _STRAIGHT and abs(pitch) < np.radians(_TIPPED):
                own[foot], own[toe] = guess @ about_x(pitch), tip @ about_x(pitch)
                break


def _slope(skin: FloatArray) -> tuple[float, float]:
    """Measure how a sole is tipped, in radians, and how far it is from straight, in lengths. `skin` (s, 3)."""
    along = skin[:, 1] - skin[:, 1].min()
    long = max(float(np.ptp(along)), 1e-12)
    part = np.minimum((along / long * _SOLE).astype(int), _SOLE - 1)
    lowest = np.array([skin[part == each][skin[part == each, 2].argmin()] for each in np.unique(part)])
    line = np.polyfit(lowest[:, 1], lowest[:, 2], 1)
    off = np.polyval(line, lowest[:, 1]) - lowest[:, 2]
    return float(np.arctan(line[0])), float(np.sqrt((off**2).mean())) / long


def goal_turns(rig: ReferenceRig, pose: str) -> FloatArray:
    """Return the turns of the reference's bones from its rest to a pose, (b, 3, 3). `pose`: 'T', 'A' or 'rest'."""
    turns = np.broadcast_to(np.eye(3), (len(rig.skeleton.names), 3, 3)).copy()
    if pose == "rest":
        return turns
    if not rig.is_human:
        limbs = limb_bones(rig.skeleton, rig.weights)
        if not limbs:
            raise InvalidMeshError("stance_limbs")
        return stance(rig.skeleton, limbs, pose).turns
    for bone, name in enumerate(rig.skeleton.names):
        if name.startswith(("upper_arm", "forearm", "hand")):
            side = 1.0 if name.endswith(".L") else -1.0
            turns[bone] = about_y(side * np.radians(ARMS_LOWERED[pose]))
    return turns


def about_x(angle: float) -> FloatArray:
    """Return the rotation about X by an angle, (3, 3)."""
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, cos, -sin], [0.0, sin, cos]])


def about_y(angle: float) -> FloatArray:
    """Return the rotation about Y by an angle, (3, 3)."""
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array([[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]])
