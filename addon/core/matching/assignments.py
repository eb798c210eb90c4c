"""Assignments of the feature points of one surface to those of another that keep distances and handedness."""

from __future__ import annotations

import numpy as np

from ..numerics.arrays import IntArray
from ..symmetry.chirality import sided
from ..symmetry.involutions import MOST_FEATURES
from ..symmetry.limbs import Limbs

_ALIKE = np.log(2.5)  # maximum difference of the logarithms of the Auto Diffusion Function of two assigned points
_MISMATCH = 0.5  # maximum change of a single distance, over the mean distance
_HANDEDNESS = 4.0  # weight of a change of handedness, a cubed length, relative to the change of distances
_SIDES = 1.5  # weight of a change of the handedness of all pairs of limbs together, which poses disturb less
_WITHOUT = 0.15  # mismatch of a feature point without a counterpart, over the number of feature points
_BEAM = 500  # partial assignments that are kept (beam width)


def feature_assignments(limbs: Limbs, others: Limbs, most: int = 6) -> list[tuple[IntArray, float]]:
    """Find the best assignments of the feature points of one surface to those of another.

    `limbs, others`: the limbs identified among the feature points of each surface; `most`: maximum number of
    assignments to return.

    Examples
    --------
    >>> from addon.core.symmetry.limbs import limbs_of
    >>> def limbs(points):
    ...     far = np.linalg.norm(points[:, None] - points, axis=2)
    ...     return limbs_of(far, np.zeros((3, 3, 3)), np.ones(3), lambda: np.arange(3.0))
    >>> corner = np.array([[0.0, 0], [1, 0], [0, 2]])
    >>> feature_assignments(limbs(corner), limbs(corner[[2, 0, 1]]))[0][0].tolist()
    [1, 2, 0]
    """
    count, total = len(limbs.adf), len(others.adf)
    if not 0 < count <= MOST_FEATURES or not 0 < total <= MOST_FEATURES:
        return []
    scale = (limbs.distances.mean() + others.distances.mean()) / 2 or 1.0
    alike = np.abs(np.log(limbs.adf)[:, None] - np.log(others.adf)) <= _ALIKE
    fewest = (min(count, total) + 1) // 2
    beam: list[tuple[float, tuple[int, ...]]] = [(0.0, ())]
    for at in range(count):
        longer = []
        for cost, image in beam:
            known = [number for number in range(at) if image[number] >= 0]
            given = [image[number] for number in known]
            if len(known) + count - at > fewest:
                longer.append((cost + _WITHOUT**2, (*image, -1)))
            change = np.abs(others.distances[:, given] - limbs.distances[at, known]) / scale  # (k', a)
            fits = alike[at] & (change <= _MISMATCH).all(axis=1)
            fits[given] = False
            more = (change**2).sum(axis=1)
            longer += [(cost + float(more[other]), (*image, int(other))) for other in np.flatnonzero(fits)]
        beam = sorted(longer)[:_BEAM]
    found = sorted((_mismatch(limbs, others, np.array(image), scale), image) for _, image in beam)
    return [(np.array(image), mismatch) for mismatch, image in found[:most]]


def _mismatch(limbs: Limbs, others: Limbs, image: IntArray, scale: float) -> float:
    """Measure by how much an assignment changes distances, handedness and thickness."""
    known = np.flatnonzero(image >= 0)
    there = image[known]
    change = others.distances[np.ix_(there, there)] - limbs.distances[np.ix_(known, known)]
    own, other = (each.handedness[np.ix_(at, at, at)] for each, at in ((limbs, known), (others, there)))
    side, along = limbs.side[known], limbs.along[known]
    sides = sided(own, side, along) - sided(other, side, along)
    thicker = np.log(others.adf[there] / limbs.adf[known])
    without = (len(image) - len(known) + len(others.adf) - len(known)) / (len(image) + len(others.adf))
    return float(
        np.sqrt((change**2).mean()) / scale
        + _HANDEDNESS * np.sqrt(((other - own) ** 2).mean())
        + _SIDES * abs(sides)
        + 0.1 * np.sqrt((thicker**2).mean())
        + _WITHOUT * 2 * without
    )
