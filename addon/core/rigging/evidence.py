"""What a fitted skeleton says about itself: joints bent the wrong way, sides unlike each other, where the toes are."""

from __future__ import annotations

import numpy as np

from ..numerics.arrays import FloatArray
from ..numerics.vectors import angle
from .bone_fit import BoneFit
from .reference_rig import ReferenceRig, hinges
from .stance import unit

_HINGES = {  # degrees: flexion from and to, sideways, twist; of anatomy, wide
    "shin": (-15.0, 155.0, 25.0, 40.0),
    "forearm": (-15.0, 155.0, 35.0, 110.0),
}
_TURNS = {  # degrees: the whole turn of a bone against another
    "foot": ("shin", 60.0),
    "hand": ("forearm", 100.0),
    "upper_arm": ("spine.003", 120.0),
}
_WAIST, _NECK = 60.0, 80.0
_HIP = ((-130.0, 40.0), (-75.0, 40.0), 60.0)  # forward and back, out and in, twist
_LIMBS = ("upper_arm", "forearm", "thigh", "shin")
_BESIDE, _FEET = 0.6, 1.2  # how far from a shin its foot reaches, in shins or in feet of the build


def beyond_limits(rig: ReferenceRig, fit: BoneFit) -> dict[str, float]:
    """Measure by how many degrees each joint is turned beyond what bodies can; 0 where it is not."""
    number, axes, bends = rig.skeleton.names.index, rig.axes, hinges(rig)
    turns = fit.turns
    found = {}

    def between(bone: str, other: str) -> FloatArray:
        return turns[number(other)].T @ turns[number(bone)]

    for side in "LR":
        for name, upper in (("shin", "thigh"), ("forearm", "upper_arm")):
            least, most, sideways, twist = _HINGES[name]
            bone = f"{name}.{side}"
            swing, roll = _swing_and_twist(between(bone, f"{upper}.{side}"), axes[number(bone)])
            flexion = float(swing @ bends[bone])
            aside = float(np.linalg.norm(swing - flexion * bends[bone]))
            found[bone] = _over(flexion, least, most) + _over(aside, 0, sideways) + _over(roll, -twist, twist)
        thigh = f"thigh.{side}"
        swing, roll = _swing_and_twist(between(thigh, "spine"), axes[number(thigh)])
        outward = swing[1] * (1 if side == "L" else -1)
        forward, out, twist = _HIP
        found[thigh] = _over(swing[0], *forward) + _over(outward, *out) + _over(roll, -twist, twist)
        for name, (other, most) in _TURNS.items():
            other = other if other.startswith("spine") else f"{other}.{side}"
            turn = between(f"{name}.{side}", other)
            if name == "upper_arm":
                found[f"{name}.{side}"] = _over(
                    float(np.linalg.norm(_swing_and_twist(turn, axes[number(f"{name}.{side}")])[0])), 0, most
                )
            else:
                found[f"{name}.{side}"] = _over(turned_by(turn), 0, most)
    found["spine.003"] = _over(turned_by(between("spine.003", "spine")), 0, _WAIST)
    found["spine.006"] = _over(turned_by(between("spine.006", "spine.003")), 0, _NECK)
    return found


def unlike_sides(rig: ReferenceRig, fit: BoneFit) -> float:
    """Measure how different the bones of the left and right limbs are: mean difference of the logarithms of lengths."""
    number = rig.skeleton.names.index
    long = np.log(np.maximum(np.linalg.norm(fit.tails - fit.heads, axis=1), 1e-12))
    return float(np.mean([abs(long[number(f"{name}.L")] - long[number(f"{name}.R")]) for name in _LIMBS]))


def skin_alike(rig: ReferenceRig, areas: FloatArray, weights: FloatArray) -> float:
    """Return the least ratio of the skin of a limb's bone to that of its partner; 0 where a limb has lost a bone.

    `areas` (n,); `weights` (n, b).
    """
    number, skin = rig.skeleton.names.index, areas @ weights
    pairs = [[skin[number(f"{name}.{side}")] for side in "LR"] for name in (*_LIMBS, "hand")]
    return float(min(min(pair) / max(*pair, 1e-30) for pair in pairs))


def strayed(rig: ReferenceRig, points: FloatArray, areas: FloatArray, weights: FloatArray, lowered: float) -> float:
    """Return by how many degrees the skin of a limb at most lies off its way in a stance.

    `points` (n, 3) in the stance; `areas` (n,); `weights` (n, b); `lowered`: degrees by which arms hang.
    """
    number, down = rig.skeleton.names.index, np.radians(lowered)
    skin = areas[:, None] * weights
    middle = skin.T @ points / np.maximum(skin.sum(axis=0), 1e-30)[:, None]
    found = []
    for side, sign in (("L", 1.0), ("R", -1.0)):
        arm = np.array([sign * np.cos(down), 0.0, -np.sin(down)])
        for upper, end, wanted in (("upper_arm", "hand", arm), ("thigh", "foot", np.array([0.0, 0, -1]))):
            found.append(angle(middle[number(f"{end}.{side}")] - middle[number(f"{upper}.{side}")], wanted))
    return max(found)


def trunk_axes(rig: ReferenceRig, fit: BoneFit) -> tuple[FloatArray, FloatArray]:
    """Find the left and the upward direction of a body, from hips and shoulders."""
    at = {
        name: fit.heads[rig.skeleton.names.index(name)] for name in ("upper_arm.L", "upper_arm.R", "thigh.L", "thigh.R")
    }
    up = unit(at["upper_arm.L"] + at["upper_arm.R"] - at["thigh.L"] - at["thigh.R"])
    left = at["upper_arm.L"] - at["upper_arm.R"] + at["thigh.L"] - at["thigh.R"]
    return unit(left - (left @ up) * up), up


def toes_forward(rig: ReferenceRig, fit: BoneFit, points: FloatArray) -> float:
    """Measure how far the skin at the soles reaches out to the front, beyond that of the shins, in lengths of a shin.

    `points` (n, 3): samples spread evenly over the skin.
    """
    left, up = trunk_axes(rig, fit)
    front = np.cross(left, up)
    number, total = rig.skeleton.names.index, 0.0
    lengths = np.linalg.norm(rig.skeleton.tails - rig.skeleton.heads, axis=1)
    shin, foot, toe = (lengths[number(f"{name}.L")] for name in ("shin", "foot", "toe"))
    beside = max(_BESIDE, _FEET * (foot + toe) / shin)  # feet of short legs are as long as the shins
    shins = {side: (fit.heads[number(f"shin.{side}")], fit.tails[number(f"shin.{side}")]) for side in "LR"}
    away = {side: _from_segment(points, knee, ankle + 0.3 * (ankle - knee)) for side, (knee, ankle) in shins.items()}
    for side, other in ("LR", "RL"):
        knee, ankle = shins[side]
        size = float(np.linalg.norm(ankle - knee))
        along = (ankle - knee) / max(size, 1e-12)
        down = (points - knee) @ along / max(size, 1e-12)
        near = (away[side] < beside * size) & (away[side] < away[other]) & (down > 0.1)
        if np.count_nonzero(near) < 40:
            continue
        sole = np.percentile(down[near], 99.5)
        low, mid = near & (down > sole - 0.22), near & (down > sole - 0.75) & (down < sole - 0.3)
        if min(np.count_nonzero(low), np.count_nonzero(mid)) < 15:
            continue
        ahead = points @ unit(front - (front @ along) * along) / size
        reach = [np.percentile(ahead[part], [5, 95]).mean() for part in (low, mid)]
        total += float(np.clip(reach[0] - reach[1], -0.3, 0.3))
    return total


def _from_segment(points: FloatArray, start: FloatArray, end: FloatArray) -> FloatArray:
    way = end - start
    share = np.clip((points - start) @ way / max(float(way @ way), 1e-24), 0, 1)
    return np.asarray(np.linalg.norm(points - start - share[:, None] * way, axis=1))


def _over(value: float, least: float, most: float) -> float:
    return max(0.0, least - value, value - most)


def turned_by(turn: FloatArray) -> float:
    """Return the angle of a rotation (3, 3) in degrees."""
    return float(np.degrees(np.arccos(np.clip((np.trace(turn) - 1) / 2, -1, 1))))


def _swing_and_twist(turn: FloatArray, axis: FloatArray) -> tuple[FloatArray, float]:
    """Split a rotation into one across an axis, as a vector in degrees, after one about it, in degrees."""
    from scipy.spatial.transform import Rotation

    whole = Rotation.from_matrix(turn)
    quaternion = whole.as_quat()
    twist = 2 * np.arctan2(quaternion[:3] @ axis, quaternion[3])
    twist = (twist + np.pi) % (2 * np.pi) - np.pi
    swing = whole * Rotation.from_rotvec(-twist * axis)
    return np.degrees(swing.as_rotvec()), float(np.degrees(twist))
