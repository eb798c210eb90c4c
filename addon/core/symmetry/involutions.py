"""Mirror symmetries of feature points: swaps that keep the distances between them and reverse handedness."""

from __future__ import annotations

import numpy as np

from ..numerics.arrays import FloatArray, IntArray
from ..run.monitor import Monitor

_ALIKE = np.log(1.6)  # maximum difference of the logarithms of the Auto Diffusion Function of a point and its image
_MISMATCH = 0.375  # maximum change of a single distance, over the mean distance
_HANDEDNESS = 2.0  # weight of a handedness that is not reversed, a cubed length, relative to the change of distances
_THICKNESS = 0.6  # weight of a change of the logarithm of the Auto Diffusion Function
_FULL = 0.08  # bonus for each further pair that is swapped: bodies are symmetric as a whole, not limb by limb
MOST_FEATURES = 40  # most feature points that are searched for swaps or assignments
_MOST_TRIED = 5_000  # partial swaps; only surfaces with dozens of similar limbs have more
_LOOKED_AT = 100  # complete swaps whose handedness is checked, those that keep distances best


def feature_involutions(
    distances: FloatArray, handedness: FloatArray, adf: FloatArray, most: int = 6, *, monitor: Monitor | None = None
) -> list[tuple[IntArray, float]]:
    """Find the pairwise swaps of feature points that keep their distances and reverse their handedness.

    Distances alone cannot distinguish a mirror image from a swap of the forelegs only.

    `distances` (k, k); `handedness` (k, k, k); `adf` (k,); `most`: maximum number of swaps to return.

    Examples
    --------
    >>> arms_and_head = np.array([[0.0, 2.0, 1.5], [2.0, 0.0, 1.5], [1.5, 1.5, 0.0]])
    >>> ways = feature_involutions(arms_and_head, np.zeros((3, 3, 3)), np.array([2.0, 2.0, 1.0]))
    >>> [image.tolist() for image, _ in ways]
    [[1, 0, 2]]

    References
    ----------
    The intrinsic view of symmetry: Ovsjanikov, Sun and Guibas, "Global Intrinsic Symmetries of Shapes", 2008,
    doi:10.1111/j.1467-8659.2008.01273.x.
    """
    count = len(distances)
    if not 2 <= count <= MOST_FEATURES:
        return []
    scale = distances[np.triu_indices(count, 1)].mean()
    alike = np.abs(np.subtract.outer(np.log(adf), np.log(adf))) <= _ALIKE
    unset = -1
    found: list[tuple[float, tuple[int, ...]]] = []
    waiting, tried = [(unset,) * count], 0
    while waiting and tried < _MOST_TRIED:
        image = waiting.pop()
        tried += 1
        if monitor is not None:
            monitor.check()
        if unset not in image:
            swapped = np.array(image)
            if (swapped != np.arange(count)).any():
                change = np.sqrt(((distances[np.ix_(swapped, swapped)] - distances) ** 2).mean()) / scale
                pairs = (swapped != np.arange(count)).sum() // 2
                found.append((float(change - _FULL * pairs), image))
            continue
        first = image.index(unset)
        for other in range(count - 1, first - 1, -1):
            if image[other] != unset or not alike[first, other]:
                continue
            longer = list(image)
            longer[first], longer[other] = other, first
            known = [at for at in range(count) if longer[at] != unset]
            images = [longer[at] for at in known]
            if np.abs(distances[np.ix_(images, images)] - distances[np.ix_(known, known)]).max() <= _MISMATCH * scale:
                waiting.append(tuple(longer))
    ways = []
    for mismatch, image in sorted(found)[:_LOOKED_AT]:
        swapped = np.array(image)
        kept = np.sqrt(((handedness[np.ix_(swapped, swapped, swapped)] + handedness) ** 2).mean())
        thicker = np.sqrt((np.log(adf[swapped] / adf) ** 2).mean())
        ways.append((mismatch + float(_HANDEDNESS * kept + _THICKNESS * thicker), image))
    return [(np.array(image), mismatch) for mismatch, image in sorted(ways)[:most]]
