"""The bones of a reference moved so that the skin that they carry lies on another body, and slides along it freely."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..numerics.arrays import FloatArray, IntArray
from ..numerics.factoring import factored
from .bone_fit import BoneFit, growth, known_bones, movers, stretches, turns_and_scales
from .reference_rig import ReferenceRig

_SLIDING = 0.1  # weight of what lies along the skin: closest points tell nothing of it
_RIGID = 0.1  # of its skin's weight: how much each bone keeps its rotation, and scales like its partner's
_JOINED = 1.0  # of its skin's weight: how much each bone keeps to its joint
_LEAST_SKIN = 1e-4  # of the body's: weight of a joint whose bones hold less
_HELD = 1e-7  # of the body's: how much each joint stays where it is
_LEAST_SPREAD = 1e-6  # of the largest bone's: so that bones of no extent keep their rotation


class _Equations(NamedTuple):
    """Normal equations for the motions of bones: ``x ↦ M (x - head) + p``, stacked as rows (Mᵀ, p)."""

    matrix: FloatArray  # (3, 4 b, 3, 4 b)
    right: FloatArray  # (3, 4 b)

    def solved(self) -> FloatArray:
        """Solve for the motions, (b, 4, 3)."""
        count = self.right.size
        found = factored(self.matrix.reshape(count, count)).solve(self.right.ravel())
        return np.asarray(found.reshape(3, -1, 4).transpose(1, 2, 0))


def laid_bones(
    rig: ReferenceRig,
    bones: BoneFit,
    points: FloatArray,
    normals: FloatArray,
    at: FloatArray,
    weights: FloatArray,
    mass: FloatArray,
) -> BoneFit:
    """Move the bones of a reference by one step, so that its skin comes to lie on another body.

    All bones are solved for together, as linear blend skinning combines them: distances along the normals count, and
    the skin may slide; bones meet at their joints, and keep their turns and the scales of both sides, softly. A body
    that is the reference in another pose is met exactly; bones fitted one by one err wherever the skin blends them.

    `bones`: as they lie so far; `points` (n, 3), `normals` (n, 3): the body; `at` (n, 3), `weights` (n, b): the points
    of the reference that are closest; `mass` (n,): area of each point, as far as it is believed.

    References
    ----------
    Chen and Medioni, "Object modelling by registration of multiple range images", 1992,
    doi:10.1016/0262-8856(92)90066-C; Le and Deng, "Smooth Skinning Decomposition with Rigid Bones", 2012,
    doi:10.1145/2366145.2366218 (bones solved from what they move).
    """
    mass = mass / max(float(mass.sum()), 1e-30)
    skins = mass[:, None] * weights
    some = np.flatnonzero(known_bones(skins))
    if len(some) == 0:
        return bones
    held, heads, axes = weights[:, some], rig.skeleton.heads[some], rig.axes[some]
    apart = at[:, None] - heads  # (n, s, 3)
    carried = np.concatenate([held[:, :, None] * apart, held[:, :, None]], axis=2).reshape(len(at), -1)  # (n, 4 s)
    alike = (bones.scales + bones.scales[rig.mates]) / 2
    motions = (bones.turns @ stretches(rig.axes, alike))[some]
    before = np.concatenate([motions.transpose(0, 2, 1), bones.heads[some, None]], axis=1).reshape(-1, 3)  # (4 s, 3)
    system = _skin(carried, points, normals, mass)
    _join(system, _nearest_ancestors(rig, some), heads, skins.sum(axis=0)[some])
    spread = np.einsum("n,nb,nbi->b", mass, held**2, apart**2)
    spread = np.maximum(spread, _LEAST_SPREAD * spread.max())
    keep = np.column_stack([*(_RIGID * spread,) * 3, np.full(len(some), _HELD)]).ravel()
    for axis in range(3):
        system.matrix[axis, :, axis] += np.diag(keep)
        system.right[axis] += keep * before[:, axis]
    found = system.solved()
    turns, scales = turns_and_scales(found[:, :3].transpose(0, 2, 1), axes, growth(at, points))
    source = movers(rig.skeleton, skins)
    number = np.searchsorted(some, source)  # among those that were found
    maps = (turns @ stretches(axes, scales))[number]  # (b, 3, 3)
    starts, ends = (
        found[number, 3] + np.einsum("bij,bj->bi", maps, each - rig.skeleton.heads[source])
        for each in (rig.skeleton.heads, rig.skeleton.tails)
    )
    return BoneFit(starts, ends, turns[number], scales[number])


def _skin(carried: FloatArray, points: FloatArray, normals: FloatArray, mass: FloatArray) -> _Equations:
    """Ask that what the bones carry lies on the points, along their normals. `carried` (n, 4 s)."""
    metric = (1 - _SLIDING) * normals[:, :, None] * normals[:, None, :] + _SLIDING * np.eye(3)  # (n, 3, 3)
    count = carried.shape[1]
    matrix = np.empty((3, count, 3, count))
    for one in range(3):
        for two in range(one, 3):
            block = carried.T @ ((mass * metric[:, one, two])[:, None] * carried)
            matrix[one, :, two] = matrix[two, :, one] = block
    return _Equations(matrix, (mass[:, None] * np.einsum("nij,nj->ni", metric, points)).T @ carried)


def _join(system: _Equations, above: IntArray, heads: FloatArray, skin: FloatArray) -> None:
    """Ask that every bone begins where the one above it carries its head. `above` (s,): -1 for none."""
    count = len(heads)
    rows = np.zeros((count, 4 * count))
    lower = np.flatnonzero(above >= 0)
    upper = above[lower]
    rows[lower, 4 * lower + 3] = 1.0
    rows[lower, 4 * upper + 3] = -1.0
    for axis in range(3):
        rows[lower, 4 * upper + axis] = heads[upper, axis] - heads[lower, axis]
    strength = _JOINED * np.maximum(np.minimum(skin, skin[above]), _LEAST_SKIN)
    block = rows.T @ (strength[:, None] * rows)
    for axis in range(3):
        system.matrix[axis, :, axis] += block


def _nearest_ancestors(rig: ReferenceRig, some: IntArray) -> IntArray:
    """For each of some bones the nearest one of them above it, as its position among them; -1 for none."""
    place = {int(bone): number for number, bone in enumerate(some)}
    return np.array([next((place[a] for a in rig.skeleton.ancestors(int(b)) if a in place), -1) for b in some])
