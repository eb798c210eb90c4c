"""Bones laid by an assignment of one skin to another: every piece of it goes to one of its own, and none is left."""

from __future__ import annotations

import numpy as np

from ..mesh.geometry import vertex_areas, vertex_normals
from ..numerics.arrays import FloatArray
from ..numerics.shares import spread
from ..run.monitor import Monitor
from .bone_fit import BoneFit, fitted_bones
from .reference_rig import ReferenceRig

_SAMPLES = 500  # of each skin, all of the same area
_FACING = 0.1  # weight of normals, in sqrt(area)
_ROUNDS = 4


def transported_bones(
    rig: ReferenceRig,
    bones: BoneFit,
    points: FloatArray,
    normals: FloatArray,
    areas: FloatArray,
    monitor: Monitor,
) -> tuple[BoneFit, float]:
    """Lay the bones of a body onto another of the same size that may stand otherwise, wherever its limbs are.

    By closest points two legs come to lie on one of the other body. Here equal areas of both skins are assigned to each
    other so that the sum of the squared ways is least, round by round.

    `rig`, `bones`: the body as it lies so far; `points` (n, 3), `normals` (n, 3), `areas` (n,): the other, of unit
    area. Also gives the root of the mean square of the last ways, with normals, in sqrt(area).

    References
    ----------
    Shen and others, "Accurate point cloud registration with robust optimal transport", 2021, arXiv:2111.00648.
    """
    from scipy.optimize import linear_sum_assignment

    own = vertex_areas(rig.vertices, rig.faces)
    here, there = spread(own / own.sum(), _SAMPLES), spread(areas / areas.sum(), _SAMPLES)
    wanted, equal, left = np.column_stack([points, _FACING * normals])[there], np.ones(_SAMPLES), np.inf
    for _ in range(_ROUNDS):
        monitor.check()
        laid = bones.posed(rig, rig.vertices, rig.weights)
        lies = np.column_stack([laid, _FACING * vertex_normals(laid, rig.faces)])[here]
        ways = ((wanted[:, None] - lies) ** 2).sum(axis=2)
        one, two = linear_sum_assignment(ways)
        left = float(np.sqrt(ways[one, two].mean()))
        samples = here[two]
        bones = fitted_bones(rig, points[there[one]], equal, rig.vertices[samples], rig.weights[samples], equal)
    return bones, left
