"""The bones of a rig, and how the skin follows them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..numerics.arrays import FloatArray, IntArray

_DAMPED = 1e-4  # of the squared change of lengths by skinning: below a hundredth it is not undone


class Skeleton(NamedTuple):
    """The bones of a rig in one pose.

    Attributes
    ----------
    names : list of str
        The name of each bone.
    parents : (b,) ndarray of int
        The parent of each bone; -1 for none.
    heads, tails : (b, 3) ndarray of float
        Where each bone begins and ends.
    """

    names: list[str]
    parents: IntArray
    heads: FloatArray
    tails: FloatArray

    @property
    def axes(self) -> FloatArray:
        """Directions of the bones, (b, 3)."""
        ways = self.tails - self.heads
        long = np.linalg.norm(ways, axis=1, keepdims=True)
        return np.where(long > 0, ways / np.maximum(long, np.finfo(float).tiny), [0.0, 0, 1])

    def ancestors(self, bone: int) -> list[int]:
        """List the parent of a bone, its parent, and so on; of a circle, each once."""
        found: list[int] = []
        while (bone := int(self.parents[bone])) >= 0 and bone not in found:
            found.append(bone)
        return found

    def downwards(self) -> list[int]:
        """List the bones, each after its parent."""
        depth = [len(self.ancestors(bone)) for bone in range(len(self.names))]
        return np.argsort(depth, kind="stable").tolist()


class BoneMotions(NamedTuple):
    """How each bone moves: a point x of the skin goes to ``heads + turns (x - from)``.

    Attributes
    ----------
    starts, heads : (b, 3) ndarray of float
        Where each bone begins, before and after.
    turns : (b, 3, 3) ndarray of float
        Linear map of each bone, for column vectors: a rotation, perhaps after a stretch.
    """

    starts: FloatArray
    heads: FloatArray
    turns: FloatArray


def skinned(points: FloatArray, weights: FloatArray, motions: BoneMotions) -> FloatArray:
    """Move points with bones, each with the weighted mean of their motions (linear blend skinning).

    `points` (n, 3); `weights` (n, b), rows sum to 1; gives (n, 3).

    Examples
    --------
    >>> turn = np.array([[[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]])
    >>> motions = BoneMotions(np.zeros((1, 3)), np.array([[0.0, 0, 5]]), turn)
    >>> skinned(np.array([[1.0, 0, 0]]), np.ones((1, 1)), motions).tolist()
    [[0.0, 1.0, 5.0]]
    """
    moved = np.zeros_like(points)
    for bone in np.flatnonzero(weights.any(axis=0)):
        held = np.flatnonzero(weights[:, bone])
        places = (points[held] - motions.starts[bone]) @ motions.turns[bone].T + motions.heads[bone]
        moved[held] += weights[held, bone, None] * places
    return moved


def inverted(motions: BoneMotions) -> BoneMotions:
    """Return the motions back, of bones that turn and do not stretch.

    Examples
    --------
    >>> turn = np.array([[[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]])
    >>> back = inverted(BoneMotions(np.zeros((1, 3)), np.array([[0.0, 0, 5]]), turn))
    >>> skinned(np.array([[0.0, 1, 5]]), np.ones((1, 1)), back).tolist()
    [[1.0, 0.0, 0.0]]
    """
    return BoneMotions(motions.heads, motions.starts, motions.turns.transpose(0, 2, 1))


def unskinned(points: FloatArray, rest: FloatArray, weights: FloatArray, motions: BoneMotions) -> FloatArray:
    """Find what skinning must start from to reach given places: the correction that a shape key holds at rest.

    Where bones that turn against each other leave hardly any volume, it keeps close to the skin at rest.

    `points` (n, 3): where to; `rest` (n, 3): the skin at rest; `weights` (n, b), rows sum to 1; gives (n, 3).

    Examples
    --------
    >>> turn = np.array([[[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]])
    >>> motions = BoneMotions(np.zeros((1, 3)), np.zeros((1, 3)), turn)
    >>> unskinned(np.array([[0.0, 2, 0]]), np.array([[1.0, 0, 0]]), np.ones((1, 1)), motions).round(3).tolist()
    [[2.0, 0.0, 0.0]]
    """
    off = points - skinned(rest, weights, motions)
    linear = np.einsum("nb,bij->nij", weights, motions.turns)
    square = linear.transpose(0, 2, 1) @ linear + _DAMPED * np.eye(3)
    wanted = np.einsum("nji,nj->ni", linear, off)
    return np.asarray(rest + np.linalg.solve(square, wanted[:, :, None])[:, :, 0])


def moved_skeleton(skeleton: Skeleton, motions: BoneMotions) -> Skeleton:
    """Return a skeleton after its bones have moved; those that meet still do.

    Examples
    --------
    >>> bone = Skeleton(["a"], np.array([-1]), np.zeros((1, 3)), np.array([[0.0, 0, 2]]))
    >>> up = BoneMotions(bone.heads, np.array([[0.0, 0, 5]]), np.eye(3)[None])
    >>> moved_skeleton(bone, up).tails.tolist()
    [[0.0, 0.0, 7.0]]
    """
    tails = motions.heads + np.einsum("bij,bj->bi", motions.turns, skeleton.tails - motions.starts)
    for bone, parent in enumerate(skeleton.parents):
        if parent >= 0 and np.allclose(skeleton.heads[bone], skeleton.tails[parent]):
            tails[parent] = motions.heads[bone]
    return Skeleton(skeleton.names, skeleton.parents, motions.heads, tails)


def mirror_name(name: str) -> str:
    """Return the name of the same bone of the other side, by Blender's endings; the name itself if it has none.

    Examples
    --------
    >>> mirror_name("hand.L"), mirror_name("spine")
    ('hand.R', 'spine')
    """
    other = {".L": ".R", ".R": ".L"}.get(name[-2:])
    return name if other is None else name[:-2] + other
