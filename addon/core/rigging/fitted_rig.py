"""A skeleton that was fitted to a body, made ready to move it: sides equal, bones with a bend, weights everywhere."""

from __future__ import annotations

import numpy as np

from ..numerics.arrays import FloatArray
from ..numerics.factoring import factored
from ..numerics.ramps import ramp
from .bone_fit import BoneFit
from .evidence import turned_by
from .reference_rig import ReferenceRig
from .skeleton import Skeleton

_FOOT, _HAND = 60.0, 100.0  # degrees beyond which an end goes with its limb
_STRAIGHT, _BENT = 12.0, 35.0  # degrees: a joint bent less tells no hinge, one bent more tells it alone
_SOFT = 2e-4  # share of the skin's area: diffusion time of weights, about a finger's breadth
_FORGOTTEN = 1e-6  # trust that every vertex keeps, so that a body without any is not lost
_LIMBS = (("upper_arm", "forearm"), ("thigh", "shin"))


def settled_turns(rig: ReferenceRig, fit: BoneFit) -> FloatArray:
    """Return the turns of the bones, where feet, toes and hands beyond their limits go with their limbs, (b, 3, 3)."""
    number, turns = rig.skeleton.names.index, fit.turns.copy()
    for side in "LR" if rig.is_human else "":
        for end, limb, most in (("foot", "shin", _FOOT), ("hand", "forearm", _HAND), ("toe", "foot", _FOOT)):
            bone, above = number(f"{end}.{side}"), number(f"{limb}.{side}")
            if turned_by(turns[above].T @ turns[bone]) > most:
                turns[bone] = turns[above]
    return turns


def with_equal_sides(rig: ReferenceRig, fit: BoneFit) -> BoneFit:
    """Give bones of both sides the mean of their lengths; they stay joined, and keep their directions."""
    bones, mates = rig.skeleton, rig.mates
    ways = fit.tails - fit.heads
    long = np.linalg.norm(ways, axis=1)
    ways *= ((long + long[mates]) / 2 / np.maximum(long, 1e-12))[:, None]
    heads, tails = fit.heads.copy(), fit.heads + ways
    for bone in bones.downwards():
        above = bones.parents[bone]
        if above >= 0:
            joined = np.allclose(bones.heads[bone], bones.tails[above])
            heads[bone] = tails[above] if joined else heads[above] + fit.heads[bone] - fit.heads[above]
            tails[bone] = heads[bone] + ways[bone]
    return fit._replace(heads=heads, tails=tails)


def bend_axes(rig: ReferenceRig, fit: BoneFit) -> FloatArray:
    """Find the axis about which each bone bends: across it, to its left where it points up or down, (b, 3).

    Elbows and knees that are bent tell theirs; a straight leg takes that of its foot, and all else follows the skin.
    """
    number, sides = rig.skeleton.names.index, "LR" if rig.is_human else ""
    found = np.einsum("bij,bj->bi", fit.turns, rest_bends(rig))
    ways = _unit(fit.tails - fit.heads)
    for side in sides:
        foot = ways[number(f"foot.{side}")]
        for upper, lower in _LIMBS:
            pair = [number(f"{name}.{side}") for name in (upper, lower)]
            hinge = np.cross(*ways[pair])
            bend = np.degrees(np.arcsin(min(float(np.linalg.norm(hinge)), 1.0)))
            share = float(ramp(np.array([bend]), _STRAIGHT, _BENT)[0])
            for bone in pair:
                straight = found[bone] if lower == "forearm" else _unit(np.cross(foot, ways[bone]))
                found[bone] = (1 - share) * straight + share * _unit(hinge)
    return _across(found, ways)


def moved_bend_axes(rig: ReferenceRig, bends: FloatArray, turns: FloatArray, rest: Skeleton) -> FloatArray:
    """Turn the axes about which bones bend along with them to another rest, (b, 3); knees bend where feet point there.

    `bends` (b, 3): axes before; `turns` (b, 3, 3): to the other rest; `rest`: the bones there.
    """
    found, number = np.einsum("bij,bj->bi", turns, bends), rest.names.index
    ways = _unit(rest.tails - rest.heads)
    for side in "LR" if rig.is_human else "":
        for bone in (number(f"{name}.{side}") for name in ("thigh", "shin")):
            found[bone] = np.cross(ways[number(f"foot.{side}")], ways[bone])
    return _across(found, ways)


def rest_bends(rig: ReferenceRig) -> FloatArray:
    """Choose the axis across each bone of a reference about which it bends at rest, (b, 3)."""
    front = np.array([0.0, -1, 0])
    rest = np.cross(rig.axes, front)
    rest[np.linalg.norm(rest, axis=1) < 0.5] = [1.0, 0, 0]  # feet point to the front
    for name in ("thigh", "shin"):
        for side in "LR" if rig.is_human else "":
            rest[rig.skeleton.names.index(f"{name}.{side}")] *= -1
    return _across(rest, rig.axes)


def _across(axes: FloatArray, ways: FloatArray) -> FloatArray:
    """Make axes perpendicular to directions."""
    return _unit(axes - np.einsum("bi,bi->b", axes, ways)[:, None] * ways)


def filled_in(weights: FloatArray, trust: FloatArray, stiffness: object, mass: FloatArray) -> FloatArray:
    """Keep weights where they are trusted, and let them flow over the skin to where they are not.

    So what a match misses, such as the inside of a mouth, moves with what is around it.

    `weights` (n, b); `trust` (n,): 0 to 1; `stiffness` (n, n), `mass` (n,): of a surface of unit area.

    References
    ----------
    Abdrashitov and others, "Robust Skin Weights Transfer via Weight Inpainting", 2023, doi:10.1145/3610543.3626180.
    """
    from scipy.sparse import diags

    held = mass * np.maximum(trust, _FORGOTTEN)
    found = factored(diags(held) + _SOFT * mass.sum() * stiffness).solve(held[:, None] * weights)
    found = np.maximum(found, 0.0)
    return np.asarray(found / found.sum(axis=1, keepdims=True))


def _unit(ways: FloatArray) -> FloatArray:
    return np.asarray(ways / np.maximum(np.linalg.norm(ways, axis=-1, keepdims=True), 1e-12))
