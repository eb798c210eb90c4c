"""Whether left and right of a form lie on one side from limb to limb."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from ..numerics.arrays import FloatArray
from ..numerics.vectors import angle
from .limbs import Limbs

TWISTED = 60.0  # degrees; found forms of people and animals have 44 at most, those with crossed legs 70 and more


def trunk_twist(tips: FloatArray, limbs: Limbs) -> float:
    """Measure the largest angle between the directions from right to left of two pairs of limbs, in degrees.

    It is measured about the line from pair to pair; 0 for fewer than two pairs.

    `tips` (k, 3): positions of the feature points in a form; `limbs`: the limbs identified among them.

    Examples
    --------
    >>> from scipy.spatial.distance import cdist
    >>> from addon.core.symmetry.limbs import limbs_of
    >>> ends = np.array([[1.0, 2, 0], [-1, 2, 0], [1.1, -2, 0], [-1.1, -2, 0], [0, 4, 0]]) / 3
    >>> limbs = limbs_of(cdist(ends, ends), np.zeros((5, 5, 5)), np.array([2.0, 2, 2, 2, 1]), lambda: np.arange(5.0))
    >>> trunk_twist(ends, limbs), trunk_twist(ends[[1, 0, 2, 3, 4]], limbs)
    (0.0, 180.0)
    """
    left = np.flatnonzero(limbs.side == 1)
    right = limbs.partner[left]
    middle, across = (tips[left] + tips[right]) / 2, tips[left] - tips[right]
    twist = 0.0
    for one, other in combinations(range(len(left)), 2):
        axis = middle[one] - middle[other]
        axis = axis / max(float(np.linalg.norm(axis)), np.finfo(float).tiny)
        first, second = (each - (each @ axis) * axis for each in (across[one], across[other]))
        twist = max(twist, angle(first, second))
    return twist
