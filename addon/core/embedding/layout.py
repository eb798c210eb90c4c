"""The layout: where the limbs lie by distances alone, in three dimensions, or two where the third would be a tie."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..mesh.geometry import signed_volume
from ..numerics.arrays import FloatArray, IntArray
from ..symmetry.limbs import Limbs
from .classical_scaling import landmark_scaling

_TOLD = 0.04  # by how much the misfits of mirror and half turn differ at least: below, the ends lie in a plane
_SURE = 0.01  # margin of the swap of left and right over the next best below which it says nothing
_DEEP = 1.2  # handedness above which the third axis of a body without left and right is real


class Layout(NamedTuple):
    """A surface laid out by distances alone."""

    points: FloatArray  # (n, 3)
    depth: float  # 1 if the third axis is real, 0 if it is a tie


def laid_out(distances: FloatArray, landmarks: IntArray, body: FloatArray, faces: IntArray, limbs: Limbs) -> Layout:
    """Lay a surface out by its distances (n, l) from landmarks, outside out as the body's points (n, 3) are.

    Distances do not know left from right. A layout in which a mirror exchanges the limbs of both sides is a bowl: the
    sign of its volume tells it from its mirror image (animals). One in which a half turn does is twisted as well to
    one side as to the other (people): a tie that nothing but chance or the pose could break. Then the third axis is
    dropped, and the flat layout is its own mirror image. Where left and right are not sure, or only one pair of limbs
    says it, the volume alone decides. The landmarks begin with the feature points.
    """
    layout = landmark_scaling(distances, landmarks)
    layout -= layout.mean(axis=0)
    handed = handedness(layout, faces) * np.sign(signed_volume(body, faces))
    ends = layout[landmarks[: len(limbs.partner)]]
    mirror, half_turn = _misfits(ends, ends[limbs.partner])
    several = np.count_nonzero(limbs.partner != np.arange(len(ends))) > 2  # a plane mirrors any one pair
    told = several and limbs.margin > _SURE and abs(mirror - half_turn) > _TOLD
    real = mirror < half_turn if told else abs(handed) > _DEEP
    return Layout(layout * [1.0, 1.0, float(real) * np.sign(handed)], float(real))


def _misfits(ends: FloatArray, images: FloatArray) -> tuple[float, float]:
    """Compute how far the best reflection and the best rotation of points are from images, squared, over their size."""
    left, stretch, right = np.linalg.svd(ends.T @ images)
    size = max(float((ends**2).sum()), 1e-300)
    best = 2 * (size - float(stretch.sum())) / size  # of the two
    other = best + 4 * float(stretch[2]) / size
    return (best, other) if np.linalg.det(left @ right) < 0 else (other, best)


def handedness(layout: FloatArray, faces: IntArray) -> float:
    """Compute the signed volume of a layout over the product of its deviations along the three axes; 0 if it is flat.

    A solid ball has 4.2 (4π/3), a body whose limbs are thin below 1.
    """
    spread = float(np.prod(layout.std(axis=0)))
    return signed_volume(layout, faces) / spread if spread > 0 else 0.0
