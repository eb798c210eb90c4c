"""The push: far pairs want more than the body can give, near pairs their lengths, and every limb is pulled straight."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..numerics.arrays import FloatArray, IntArray
from ..stress.pairs import Pairs, WantedPairs, length

_FAR = 10.0  # distance that far pairs want, in sqrt(area): only their direction counts


def far_pairs(landmarks: IntArray, ends: Sequence[IntArray], ends_share: float, strength: float, count: int) -> Pairs:
    """Pair all landmarks, and those with the vertices at the ends of limbs, which get a share of the total force.

    Without a force at its end a limb has no tension there, and stays bent.

    Examples
    --------
    >>> pairs = far_pairs(np.arange(3), [np.array([0])], 0.4, 1.0, 4)
    >>> pairs.ends.tolist()
    [[0, 1], [0, 2], [1, 2], [0, 1], [0, 2]]
    >>> (pairs.weight * 10).round(6).tolist()
    [0.2, 0.2, 0.2, 0.2, 0.2]
    """
    groups = [np.column_stack([landmarks[each] for each in np.triu_indices(len(landmarks), 1)])]
    for end in ends:
        others = np.setdiff1d(landmarks, end)
        groups.append(np.column_stack([np.repeat(end, len(others)), np.tile(others, len(end))]))
    share = [1 - ends_share, *[ends_share / len(ends)] * len(ends)] if ends else [1.0]
    weight = [
        np.full(len(pairs), part * strength / (_FAR * max(len(pairs), 1)))
        for pairs, part in zip(groups, share, strict=True)
    ]
    return Pairs(np.concatenate(groups), np.concatenate(weight), count)


def wanting_far(pairs: Pairs, depth: float = 1.0) -> WantedPairs:
    """Let pairs want a distance that no body reaches; along the third axis only as much as it is worth."""
    axes = np.array([1.0, 1.0, depth])  # a tie must not be broken by the pose

    def wants(apart: FloatArray, _: FloatArray) -> FloatArray:
        seen = axes * apart
        return _FAR * axes * seen / length(seen)[:, None] + (1 - axes) * apart

    return pairs.wanting(wants)
