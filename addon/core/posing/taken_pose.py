"""A body that takes the pose of another: it moves to corresponding points, and keeps its own shape."""

from __future__ import annotations

import numpy as np

from ..deformation.elastic_body import ElasticBody
from ..numerics.arrays import FloatArray

_EVEN = 1e-5  # diffusion time over which the positions are averaged by confidence, as a share of the area,
_TURNS = 5e-4  # over which the rotations of edges are,
_LENGTHS = 4e-3  # and their lengths
_LEAST = 0.02  # minimum confidence of a position
_PULL = 320.0  # 1/area, where lengths agree
_ALIKE = 0.1  # difference of the logarithms of lengths above which a position is hardly followed
_HARDLY = 1e-3  # share of the pull that is left there


def taken_pose(body: ElasticBody, places: FloatArray, confidence: FloatArray) -> FloatArray:
    """Deform a body from its pose to the positions that its vertices have in another.

    Where lengths agree, up to one factor for the whole body, vertices move to their positions. Where they do not,
    because the other body is fatter, or has longer arms, edges only rotate as they do there.

    `body`: the body, in its own pose; `places` (n, 3); `confidence` (n,); gives (n, 3).

    References
    ----------
    Sumner and Popović, "Deformation Transfer for Triangle Meshes", 2004, doi:10.1145/1015706.1015736; Sorkine and
    Alexa, "As-Rigid-As-Possible Surface Modeling", 2007, doi:10.2312/SGP/SGP07/109-116.
    """
    sure = np.maximum(confidence, _LEAST) * body.mass
    known = body.smoothed(np.column_stack([sure[:, None] * places, sure]), _EVEN)
    target = known[:, :3] / known[:, 3:]
    longer = body.stretch(target, _LENGTHS)
    factor = _median(longer, body.mass)
    alike = np.exp(-(((longer - factor) / _ALIKE) ** 2))
    target *= np.exp(-factor)
    rotation = body.rotations(target, _TURNS)
    return body.turned_towards(rotation, target, _PULL * np.maximum(alike, _HARDLY))


def _median(values: FloatArray, weights: FloatArray) -> float:
    """Compute the weighted median."""
    order = np.argsort(values, kind="stable")
    middle = np.searchsorted(np.cumsum(weights[order]), weights.sum() / 2)
    return float(values[order[min(middle, len(order) - 1)]])
