"""Where the arms or the legs of a body lie, by search: what the rest of the body leaves of its skin is theirs.

A match puts an arm that has grown together with the trunk anywhere; a search over directions needs no match.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..mesh.closest_points import closest_points
from ..mesh.geometry import vertex_normals
from ..numerics.arrays import FloatArray, IntArray
from ..numerics.shares import spread
from ..run.monitor import Monitor
from .bone_fit import BoneFit
from .reference_rig import ReferenceRig
from .stance import swing

_CHAINS = {"arm": ("upper_arm", "forearm", "hand"), "leg": ("thigh", "shin")}
_ABOVE = {"arm": "spine.003", "leg": "spine"}  # what each hangs on
_OWN = {"arm": _CHAINS["arm"], "leg": ("thigh", "shin", "foot", "toe")}  # bones whose skin it has to explain
_MEASURED = {"arm": ("thigh", "shin", "spine.00"), "leg": ("spine.00",)}  # bones that tell the body's scale
# All lengths are in sqrt(area) of the body.
_FACING, _REACH = 0.03, 0.03  # weight of normals; distance at which skin is hardly explained
_SAMPLES, _FREE = 500, 0.3  # of the skin; how badly it must be explained to be one
_NEAR = 0.06  # a fitted shoulder, or hip, within that of the trunk's own is believed by half
_UPPER, _LOWER = 250, 140  # directions of the upper arm and of the forearm
_LONG = (0.85, 0.95, 1.05, 1.15)  # factors on the length
_FOLDED = -0.85  # cosine between both beyond which no elbow folds
_MOST = 6000  # chains that are ranked: a stout body has room for many more
_INSIDE = (0.015, 0.03)  # how far out of the skin an upper arm and a forearm may reach: the grid is coarse
_ROUND = 0.45  # of the radius: how far skin may be off it
_BEYOND = (0.15, 0.35)  # of the length: how far skin goes with a bone before its head; after the tip of the last
_STARTS, _TRIES = 8, 60  # chains that are refined, and how many are tried of each in a round
_OTHER = 0.05  # elbows or wrists that lie that far apart are another way to lie
_STEPS = (0.2, 0.14, 0.1, 0.07, 0.05, 0.035, 0.025)  # of directions, round by round
_OUT, _STRETCH, _SHIFT = 160.0, 20.0, 0.02  # penalties: of bones outside, of the length's logarithm, of the shoulder
_SHARED = 0.9  # how much of what the other arm explains is taken


class _Skin(NamedTuple):
    """Samples of the skin that the limbs have to explain, and the whole skin, which they must not leave."""

    points: FloatArray  # (s, 3)
    normals: FloatArray  # (s, 3)
    free: FloatArray  # (s,) how badly each is explained without them
    whole: FloatArray  # (n, 3)
    outward: FloatArray  # (n, 3) its normals

    def outside(self, places: FloatArray) -> FloatArray:
        """How far places lie outside of the skin, negative within. `places` (..., 3); gives (...)."""
        from scipy.spatial import cKDTree

        flat = places.reshape(-1, 3)
        distance, near = cKDTree(self.whole).query(flat)
        beyond = np.einsum("ij,ij->i", flat - self.whole[near], self.outward[near])
        return np.asarray(np.where(beyond < 0, -distance, distance).reshape(places.shape[:-1]))


class _Limb(NamedTuple):
    """What is known of a limb before its direction."""

    bones: list[int]  # of the chain, k
    root: FloatArray  # (3,)
    lengths: FloatArray  # (k,)
    radii: FloatArray  # (k, 2) at head and tail


class _Chain(NamedTuple):
    """A way in which a limb may lie."""

    gain: float
    cover: FloatArray  # (s,) how well it explains each sample
    penalty: float
    joints: FloatArray  # (k + 1, 3) from the shoulder, or hip, to the end


def searched_limbs(
    rig: ReferenceRig,
    bones: BoneFit,
    kind: str,
    points: FloatArray,
    faces: IntArray,
    areas: FloatArray,
    monitor: Monitor,
) -> BoneFit | None:
    """Lay both arms, or both legs, of a human skeleton anew, the rest of which lies right.

    Directions of upper arm and forearm are tried on a sphere, in the frame of the chest; bones have to lie inside, and
    to explain, as cones, what skin the rest of the body does not. The best are refined, and chosen as a pair.

    `rig`: the mannequin; `kind`: "arm" or "leg"; `points` (n, 3), `faces` (m, 3), `areas` (n,): the body, of unit area;
    gives None if no limb finds room.
    """
    skin = _skin(rig, bones, kind, points, faces, areas, monitor)
    if len(skin.points) == 0:
        return None
    larger = _larger(rig, bones, kind)
    limbs = {side: _limb(rig, bones, kind, side, larger) for side in "LR"}
    trunk = bones.turns[rig.skeleton.names.index(_ABOVE[kind])]
    found = {side: _ways(limb, skin, skin.free, trunk, monitor) for side, limb in limbs.items()}
    if not all(found.values()):
        return None
    for side, other in ("LR", "RL"):  # what one explains the other need not
        left = skin.free * (1 - _SHARED * found[other][0].cover)
        found[side] += _ways(limbs[side], skin, left, trunk, monitor)
    pairs = [(one, two) for one in found["L"] for two in found["R"]]
    best = max(pairs, key=lambda pair: _together(pair[0], pair[1], skin.free))
    for side, chain in zip("LR", best, strict=True):
        bones = _laid(rig, bones, limbs[side], chain, larger, trunk)
    return bones


def _together(one: _Chain, two: _Chain, free: FloatArray) -> float:
    """Measure how much of the skin two limbs explain."""
    return float(np.maximum(one.cover, two.cover) @ free) - one.penalty - two.penalty


def _skin(
    rig: ReferenceRig,
    bones: BoneFit,
    kind: str,
    points: FloatArray,
    faces: IntArray,
    areas: FloatArray,
    monitor: Monitor,
) -> _Skin:
    """Find the skin that nothing but these limbs explains."""
    normals = vertex_normals(points, faces)
    own = [name.partition(".")[0] in _OWN[kind] for name in rig.skeleton.names]
    others = rig.weights[:, own].sum(axis=1) < 0.5
    kept = rig.faces[others[rig.faces].all(axis=1)]
    laid = bones.posed(rig, rig.vertices, rig.weights)
    there = np.column_stack([laid, _FACING * vertex_normals(laid, rig.faces)])
    apart = closest_points(there, kept, np.column_stack([points, _FACING * normals]), monitor).distances
    free = 1 - np.exp(-((apart / _REACH) ** 2))
    share = np.where(free > _FREE, areas, 0.0)
    rows = np.unique(spread(share / share.sum(), _SAMPLES)) if share.any() else np.empty(0, dtype=np.int64)
    return _Skin(points[rows], normals[rows], free[rows], points, normals)


def _larger(rig: ReferenceRig, bones: BoneFit, kind: str) -> float:
    """Return how much larger the body is than the reference, by bones that lie right."""
    names = rig.skeleton.names
    return float(np.median([bones.scales[b, 0] for b, n in enumerate(names) if n.startswith(_MEASURED[kind])]))


def _limb(rig: ReferenceRig, bones: BoneFit, kind: str, side: str, larger: float) -> _Limb:
    """Gather what is known of a limb. `larger`: the body's scale."""
    number, heads, tails = rig.skeleton.names.index, rig.skeleton.heads, rig.skeleton.tails
    own, above = [number(f"{name}.{side}") for name in _CHAINS[kind]], number(_ABOVE[kind])
    way, axis = heads[own[0]] - heads[above], rig.axes[above]
    along, across = bones.scales[above]
    root = bones.heads[above] + bones.turns[above] @ (across * way + (along - across) * (way @ axis) * axis)
    if np.linalg.norm(root - bones.heads[own[0]]) < _NEAR:
        root = (root + bones.heads[own[0]]) / 2
    lengths = larger * np.linalg.norm(tails[own] - heads[own], axis=1)
    return _Limb(own, root, lengths, larger * np.array([_cone(rig, bone) for bone in own]))


def _cone(rig: ReferenceRig, bone: int) -> tuple[float, float]:
    """Return the radii of the skin of a bone at its head and at its tail."""
    skin = rig.vertices[rig.weights[:, bone] > 0.5] - rig.skeleton.heads[bone]
    along = skin @ rig.axes[bone]
    away = np.linalg.norm(skin - along[:, None] * rig.axes[bone], axis=1)
    slope, start = np.polyfit(along, away, 1)
    return start, start + slope * float(np.linalg.norm(rig.skeleton.tails[bone] - rig.skeleton.heads[bone]))


def _sphere(count: int) -> FloatArray:
    """Spread directions evenly, (count, 3)."""
    up = 1 - (2 * np.arange(count) + 1) / count
    turn = np.pi * (1 + np.sqrt(5.0)) * (np.arange(count) + 0.5)
    wide = np.sqrt(1 - up**2)
    return np.column_stack([wide * np.cos(turn), wide * np.sin(turn), up])


def _unit(ways: FloatArray) -> FloatArray:
    """Divide vectors by their lengths. `ways` (c, 3)."""
    return np.asarray(ways / np.maximum(np.linalg.norm(ways, axis=1, keepdims=True), 1e-9))


def _joints(root: FloatArray, upper: FloatArray, lower: FloatArray, lengths: FloatArray) -> FloatArray:
    """Return the joints of chains, (c, k + 1, 3); a third bone goes straight on.

    `root` (c, 3); `upper`, `lower` (c, 3): directions; `lengths` (c, k).
    """
    elbow = root + lengths[:, :1] * upper
    return np.stack([root, elbow, *(elbow + long[:, None] * lower for long in np.cumsum(lengths[:, 1:], axis=1).T)], 1)


def _ways(limb: _Limb, skin: _Skin, free: FloatArray, trunk: FloatArray, monitor: Monitor) -> list[_Chain]:
    """List the likeliest ways in which a limb may lie. `free` (s,): what it is to explain; `trunk` (3, 3): its turn."""
    upper, lower = _sphere(_UPPER) @ trunk.T, _sphere(_LOWER) @ trunk.T
    tried, gains = [], []
    for factor in _LONG:
        monitor.check()
        lengths = factor * limb.lengths
        inner = limb.root + np.linspace(0.3, 1.0, 4)[:, None] * lengths[0] * upper[:, None]
        fits = upper[skin.outside(inner).max(axis=1) < _INSIDE[0]]
        first, second = np.repeat(fits, len(lower), axis=0), np.tile(lower, (len(fits), 1))
        bends = np.einsum("ij,ij->i", first, second) > _FOLDED
        first, second = first[bends], second[bends]
        elbow = limb.root + lengths[0] * first
        inner = elbow[:, None] + np.linspace(0.25, 1.2, 5)[:, None] * lengths[1] * second[:, None]
        fits = skin.outside(inner).max(axis=1) < _INSIDE[1]
        state = np.column_stack([first, second, np.full(len(first), factor), np.zeros((len(first), 3))])[fits]
        tried.append(state)
    states = np.concatenate(tried)
    if len(states) == 0:
        return []
    states = states[np.unique(np.linspace(0, len(states) - 1, _MOST).astype(int))]
    for start in range(0, len(states), 400):
        monitor.check()
        cover, penalty, _ = _explained(limb, skin, states[start : start + 400])
        gains.append(cover @ free - penalty)
    joints = _joints(limb.root + states[:, 7:], states[:, :3], states[:, 3:6], states[:, 6:7] * limb.lengths)
    ends = joints[:, 1:3]  # (c, 2, 3) elbows and wrists
    chosen: list[int] = []
    for number in np.argsort(-np.concatenate(gains), kind="stable"):
        if all(np.abs(ends[number] - ends[other]).max() > _OTHER for other in chosen):
            chosen.append(int(number))
        if len(chosen) == _STARTS:
            break
    return _refined(limb, skin, free, states[chosen], monitor)


def _explained(limb: _Limb, skin: _Skin, states: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Measure how well chains explain each sample, (c, s), what speaks against them, (c,), and their joints.

    `states` (c, 10): directions of both bones, factor on the length, shift of the shoulder.
    """
    factor, shift = np.clip(states[:, 6], 0.7, 1.3), states[:, 7:]
    joints = _joints(limb.root + shift, _unit(states[:, :3]), _unit(states[:, 3:6]), factor[:, None] * limb.lengths)
    cover = np.zeros((len(states), len(skin.points)))
    for bone, (start, end) in enumerate(limb.radii):
        way = joints[:, bone + 1] - joints[:, bone]
        apart = skin.points - joints[:, bone, None]  # (c, s, 3)
        along = np.einsum("csi,ci->cs", apart, way) / (way**2).sum(axis=1)[:, None]
        held = np.clip(along, 0.0, 1.0)
        away = apart - held[..., None] * way[:, None]
        distance = np.sqrt((away**2).sum(axis=2)) + 1e-9
        radius = start + (end - start) * held
        facing = np.clip(np.einsum("csi,si->cs", away, skin.normals) / distance, 0.0, 1.0)
        own = np.exp(-(((distance - radius) / (_ROUND * radius)) ** 2)) * facing
        tip = _BEYOND[1] if bone == len(limb.radii) - 1 else 0.0
        cover = np.maximum(cover, np.where((along < -_BEYOND[0]) | (along > 1 + tip), 0.0, own))
    inner = np.linspace(0.2, 1.0, 3)[:, None, None] * (joints[:, 1:3] - joints[:, :2])[:, None] + joints[:, :2][:, None]
    out = np.clip(skin.outside(inner), 0.0, None).sum(axis=(1, 2))
    moved = (np.linalg.norm(shift, axis=1) / _SHIFT) ** 2
    return cover, _OUT * out + _STRETCH * np.abs(np.log(factor)) + 2 * moved, joints


def _refined(limb: _Limb, skin: _Skin, free: FloatArray, states: FloatArray, monitor: Monitor) -> list[_Chain]:
    """Improve chains by random steps that grow smaller, each on its own; the best comes first."""
    random = np.random.default_rng(0)
    best = states
    size = np.array([1.0] * 6 + [0.5] + [0.08] * 3)
    gain = np.full(len(states), -np.inf)
    for step in (0.0, *_STEPS):
        monitor.check()
        tries = best[:, None] + step * size * random.normal(size=(len(best), _TRIES if step else 1, best.shape[1]))
        cover, penalty, _ = _explained(limb, skin, tries.reshape(-1, best.shape[1]))
        value = (cover @ free - penalty).reshape(len(best), -1)
        top = value.argmax(axis=1)
        better = value.max(axis=1) > gain
        best = np.where(better[:, None], tries[np.arange(len(best)), top], best)
        gain = np.maximum(gain, value.max(axis=1))
    cover, penalty, joints = _explained(limb, skin, best)
    order = np.argsort(-gain, kind="stable")
    return [_Chain(float(gain[k]), cover[k], float(penalty[k]), joints[k]) for k in order]


def _laid(rig: ReferenceRig, bones: BoneFit, limb: _Limb, chain: _Chain, larger: float, trunk: FloatArray) -> BoneFit:
    """Lay the bones of a limb along a chain, each turned from the one above by the shortest way; what hangs on it goes.

    `trunk` (3, 3): the turn of what the limb hangs on.
    """
    heads, tails, turns, scales = (each.copy() for each in bones)
    above = trunk
    for bone, start, end in zip(limb.bones, chain.joints, chain.joints[1:], strict=False):
        way = end - start
        own = np.linalg.norm(rig.skeleton.tails[bone] - rig.skeleton.heads[bone])
        above = swing(above @ rig.axes[bone], way) @ above
        heads[bone], tails[bone], turns[bone] = start, end, above
        scales[bone] = np.linalg.norm(way) / own, larger
    last = limb.bones[-1]
    turn = turns[last] @ bones.turns[last].T
    for bone in range(len(heads)):
        if last in rig.skeleton.ancestors(bone) and bone != last:
            heads[bone], tails[bone] = (
                tails[last] + turn @ (each[bone] - bones.tails[last]) for each in (bones.heads, bones.tails)
            )
            turns[bone] = turn @ bones.turns[bone]
    return BoneFit(heads, tails, turns, scales)
