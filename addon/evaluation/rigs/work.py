"""The task of a worker: rig a character in one pose, remeshed, and measure joints, weights and new poses."""

from __future__ import annotations

import time
from typing import Any, NamedTuple

import numpy as np

from ...core import Skeleton, rig
from ...core.measures.alignment import rigid_fit
from ...core.numerics.arrays import FloatArray, IntArray
from ...core.rigging.limb_bones import limb_bones
from ...core.rigging.reference_rig import ReferenceRig
from ...core.rigging.skeleton import BoneMotions, moved_skeleton, skinned
from ..remeshing import thinned
from ..work import one_thread
from .automatic import automatic_weights
from .characters import Character, rotations

_LEAST = 0.004  # share of the skin below which a bone holds none
_TOUCHED = 1e-3  # weight below which a bone does not hold a vertex


class _Truth(NamedTuple):
    """The character in one pose, remeshed, and the same vertices in others."""

    vertices: FloatArray  # (n, 3)
    faces: IntArray
    weights: FloatArray  # (n, b)
    skeleton: Skeleton
    turns: FloatArray  # (b, 3, 3) from rest
    size: float


class _Later(NamedTuple):
    """The character in another pose."""

    vertices: FloatArray  # (n, 3)
    turns: FloatArray  # (b, 3, 3) from the pose that was rigged
    heads: FloatArray  # (b, 3)
    shifts: FloatArray  # (b, 3) of bones that move against their parents, as those of clips may


def judged(
    character: Character, pose: str, reference: ReferenceRig | None, automatic: bool
) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Rig a character in one of its poses, and measure the rig.

    Parameters
    ----------
    character : Character
        The character.
    pose : str
        Name of the pose.
    reference : ReferenceRig or None
        What lends its bones; None for the mannequin.
    automatic : bool
        Whether to measure Blender's automatic weights, too, on the bones that were found and on the true ones.

    Returns
    -------
    figures : dict
        In % of the size of the character: ``joints`` and ``joint_most``, ``mean``, ``most`` (of 95 % of the vertices)
        and ``aligned`` of new poses, the same as ``found_`` and ``true_`` by automatic weights; ``weights`` (share that
        is on another bone) and ``axes`` (degrees) where bones have the same names; ``told``, ``seconds``.
    arrays : dict of str to ndarray
        None.

    Raises
    ------
    CanonicalFormError
        If it cannot be rigged.
    """
    truth, rows = _remeshed(character, pose)
    with one_thread():
        began = time.perf_counter()
        found = rig(truth.vertices, truth.faces, reference, anyway=True)
        seconds = time.perf_counter() - began
    own, names = found.skeleton, truth.skeleton.names
    same = [names.index(name) if name in names else -1 for name in own.names]
    overlap = found.weights.T @ truth.weights
    moved_by = np.where(np.array(same) >= 0, same, overlap.argmax(axis=1))
    for bone in own.downwards():  # what holds no skin goes with its parent
        if same[bone] < 0 and not overlap[bone].any() and own.parents[bone] >= 0:
            moved_by[bone] = moved_by[own.parents[bone]]
    figures: dict[str, Any] = {"told": ", ".join(each.kind for each in found.warnings), "seconds": seconds}
    figures |= _joints(own, found.weights, truth, same)
    heads = character.rig.skeleton.heads
    rest = BoneMotions(heads, heads, np.broadcast_to(np.eye(3), truth.turns.shape))
    others = [rest, *(motions for name, motions in character.poses.items() if name != pose)]
    later = [_later(character, truth, each, rows) for each in others]
    figures |= _new_poses("", truth, own, found.weights, moved_by, later)
    if automatic:
        figures |= _automatic("found", truth, own, moved_by, later)
        figures |= _automatic("true", truth, truth.skeleton, np.arange(len(names)), later)
    return figures, {}


def _remeshed(character: Character, pose: str) -> tuple[_Truth, IntArray]:
    """Reduce a pose and shuffle its vertices; return also which vertices are kept, in their new order."""
    motions, whole = character.poses[pose], character.rig
    points = skinned(whole.vertices, whole.weights, motions)
    at, triangles = _merged(whole.vertices, whole.faces)
    some, faces = thinned(points[at], triangles)
    rows = at[some]
    size = float(np.ptp(whole.vertices, axis=0).max())
    skeleton = moved_skeleton(whole.skeleton, motions)
    truth = _Truth(points[rows], faces, whole.weights[rows], skeleton, rotations(motions), size)
    return truth, rows


def _merged(points: FloatArray, faces: IntArray) -> tuple[IntArray, IntArray]:
    """Merge vertices at one place, as files split them at seams; return which are kept, and triangles of these."""
    _, kept, same = np.unique(points, axis=0, return_index=True, return_inverse=True)
    triangles = same.ravel()[faces]
    first, second, third = triangles.T
    return kept, triangles[(first != second) & (second != third) & (third != first)]


def _later(character: Character, truth: _Truth, motions: BoneMotions, rows: IntArray) -> _Later:
    """Put the same vertices into another pose."""
    bones = truth.skeleton
    points = skinned(character.rig.vertices[rows], character.rig.weights[rows], motions)
    turns = rotations(motions) @ truth.turns.transpose(0, 2, 1)
    above = np.where(bones.parents < 0, np.arange(len(turns)), bones.parents)
    carried = np.einsum("bij,bj->bi", turns[above], bones.heads - bones.heads[above])
    return _Later(points, turns, motions.heads, motions.heads - motions.heads[above] - carried)


def _joints(own: Skeleton, weights: FloatArray, truth: _Truth, same: list[int]) -> dict[str, Any]:
    """Measure how far joints are off: those of the same names, else those of arms and legs."""
    skin = truth.weights.sum(axis=0)
    pairs = [(bone, to) for bone, to in enumerate(same) if to >= 0 and skin[to] > _LEAST * skin.sum()]
    figures: dict[str, Any] = {"joints": None, "joint_most": None, "weights": None, "axes": None}
    if pairs:
        here, there = np.array(pairs).T
        axes = np.einsum("bi,bi->b", own.axes[here], truth.skeleton.axes[there])
        figures["axes"] = float(np.degrees(np.arccos(np.clip(axes, -1, 1))).mean())
        placed = np.zeros_like(truth.weights)
        known = np.array(same) >= 0
        placed[:, np.array(same)[known]] = weights[:, known]
        figures["weights"] = float(np.abs(placed - truth.weights).sum(axis=1).mean() / 2)
    else:
        mine, true = (
            {(each.kind, each.side): each for each in limb_bones(bones, held)}
            for bones, held in ((own, weights), (truth.skeleton, truth.weights))
        )
        ends = [
            (bone, other)
            for limb in mine.keys() & true.keys()
            for bone, other in zip(
                [*mine[limb].bones, mine[limb].end], [*true[limb].bones, true[limb].end], strict=False
            )
            if bone >= 0 and other >= 0
        ]
        here, there = np.array(ends).T if ends else np.empty((2, 0), dtype=np.int64)
    if len(here):
        off = np.linalg.norm(own.heads[here] - truth.skeleton.heads[there], axis=1) / truth.size
        figures |= {"joints": 100 * float(off.mean()), "joint_most": 100 * float(off.max())}
    return figures


def _new_poses(
    prefix: str,
    truth: _Truth,
    bones: Skeleton,
    weights: FloatArray,
    moved_by: IntArray,
    later: list[_Later],
) -> dict[str, Any]:
    """Turn the bones as the true ones turn, and measure how far vertices are from where the character has them."""
    errors, aligned = [], []
    for wanted, turns, heads, shifts in later:
        own = turns[moved_by]
        places = np.empty_like(bones.heads)
        for bone in bones.downwards():
            above, by = bones.parents[bone], moved_by[bone]
            if above < 0:
                places[bone] = heads[by] + own[bone] @ (bones.heads[bone] - truth.skeleton.heads[by])
            else:
                places[bone] = places[above] + own[above] @ (bones.heads[bone] - bones.heads[above])
                places[bone] += shifts[by] * (by != moved_by[above])
        posed = skinned(truth.vertices, weights, BoneMotions(bones.heads, places, own))
        errors.append(np.linalg.norm(posed - wanted, axis=1))
        rotation, shift = rigid_fit(posed, wanted)
        aligned.append(np.linalg.norm(posed @ rotation + shift - wanted, axis=1))
    of_all, of_aligned = (100 * np.array(each) / truth.size for each in (errors, aligned))
    return {
        f"{prefix}mean": float(of_all.mean()),
        f"{prefix}most": float(np.percentile(of_all, 95, axis=1).mean()),
        f"{prefix}aligned": float(of_aligned.mean()),
    }


def _automatic(
    name: str,
    truth: _Truth,
    bones: Skeleton,
    moved_by: IntArray,
    later: list[_Later],
) -> dict[str, Any]:
    """Measure Blender's automatic weights on some bones."""
    weights = automatic_weights(truth.vertices, truth.faces, bones)
    held = weights > _TOUCHED
    weights[~held.any(axis=1), 0] = 1.0  # Blender leaves them where they are; with the root they go along
    weights /= weights.sum(axis=1, keepdims=True)
    lost = {f"{name}_lost": float((~held.any(axis=1)).mean())}
    return lost | _new_poses(f"{name}_", truth, bones, weights, moved_by, later)
