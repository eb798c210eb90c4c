"""The skeleton refined by closest points: the reference, posed by it, is laid onto the body again and again."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..mesh.closest_points import SurfacePoints, closest_points
from ..mesh.geometry import vertex_normals
from ..numerics.arrays import FloatArray
from ..run.monitor import Monitor
from .bone_fit import BoneFit, connected, fitted_bones
from .reference_rig import ReferenceRig
from .skin_fit import laid_bones

UNLIKE, ALIKE = 4, 8  # rounds for bodies that differ from the reference, which drift in more, and for such as it
_FACING = 0.05  # weight of normals, in sizes of the body
_STRAYED = 0.06  # of the reference's size: as far from the match, a closest point is not believed
_BELIEVED, _LEAST = 0.1, 0.02  # least belief in one, and weight of a point that keeps its match
_FAR, _NEARER = 0.08, 3.0  # of the body's size: what a match misses by that much goes to a point so many times nearer
_TRUSTED = 0.03  # of the body's size: residual of skin that hardly follows the skeleton
_LAID = 0.05  # of the body's size: distance at which a closest point is hardly believed, where no match helps
_DOUBTFUL = 0.1  # least confidence of a point


class Explained(NamedTuple):
    """A body explained by the posed reference.

    Attributes
    ----------
    bones : BoneFit
        The skeleton.
    at : (n, 3) ndarray of float
        The point of the reference that each vertex is.
    weights : (n, b) ndarray of float
        The weights there.
    sure : (n,) ndarray of float
        Confidence of each, 0 to 1.
    residual : (n,) ndarray of float
        How far each vertex is from where the skeleton puts its point, in sizes of the body.
    """

    bones: BoneFit
    at: FloatArray
    weights: FloatArray
    sure: FloatArray
    residual: FloatArray

    def closeness(self) -> FloatArray:
        """Return how well the skeleton explains each vertex, 0 to 1, (n,), whatever the match thought of it."""
        return np.asarray(np.exp(-((self.residual / _TRUSTED) ** 2)))

    def trust(self, least: float) -> FloatArray:
        """Return how far each vertex follows the skeleton, 0 to 1, (n,). `least`: confidence that all of them have."""
        return np.asarray(np.maximum(self.sure, least) * self.closeness())

    def bone_confidence(self, areas: FloatArray) -> FloatArray:
        """Return how well each bone explains its skin, 0 to 1, (b,). `areas` (n,) of the vertices."""
        skin = areas[:, None] * self.weights
        return np.asarray(self.closeness() @ skin / np.maximum(skin.sum(axis=0), 1e-30))


def explained(
    rig: ReferenceRig,
    points: FloatArray,
    normals: FloatArray,
    areas: FloatArray,
    at: FloatArray,
    weights: FloatArray,
    sure: FloatArray,
    monitor: Monitor,
    rounds: int = UNLIKE,
) -> Explained:
    """Fit a skeleton to a body, from a match.

    `points` (n, 3), `normals` (n, 3), `areas` (n,): the body, or samples of it; `at` (n, 3), `weights` (n, b): the
    matching points of the reference; `sure` (n,): their confidence; `rounds`: `ALIKE` for a body like the reference.

    References
    ----------
    Pellegrini, Schindler and Nardi, "A Generalization of the ICP Algorithm for Articulated Bodies", 2008.
    """
    size = float(np.ptp(points, axis=0).max())
    scale = float(np.ptp(rig.vertices, axis=0).max())
    known = np.maximum(sure, _DOUBTFUL)
    bones = fitted_bones(rig, points, areas, at, weights, sure)
    matched, matched_weights = at, weights
    for _ in range(rounds):
        monitor.check()
        near = nearest_of_posed(rig, bones, points, normals, monitor)
        found, found_weights = near.on(rig.vertices, rig.faces), near.on(rig.weights, rig.faces)
        belief = np.exp(-((np.linalg.norm(found - matched, axis=1) / scale / _STRAYED) ** 2))
        missed = np.linalg.norm(bones.posed(rig, matched, matched_weights) - points, axis=1) / size
        apart = np.linalg.norm(bones.posed(rig, found, found_weights) - points, axis=1) / size
        lost = (missed > _FAR) & (apart < missed / _NEARER)  # such as a head of its own that was matched with an arm
        belief = np.where(lost, 1.0, belief)
        taken = (belief > _BELIEVED)[:, None]
        at, weights = np.where(taken, found, matched), np.where(taken, found_weights, matched_weights)
        bones = laid_bones(rig, bones, points, normals, at, weights, areas * known * np.maximum(belief, _LEAST))
    bones = connected(rig, bones)
    residual = np.linalg.norm(bones.posed(rig, at, weights) - points, axis=1) / size
    return Explained(bones, at, weights, sure, residual)


def explained_whole(
    rig: ReferenceRig, bones: BoneFit, points: FloatArray, normals: FloatArray, at: FloatArray, monitor: Monitor
) -> tuple[SurfacePoints, FloatArray]:
    """Find the point of the whole reference that each vertex of the whole body is, and how far it is believed.

    The reference, posed by the bones, has what samples of it lack, such as fingers.

    `points` (n, 3), `normals` (n, 3): the body; `at` (n, 3): about where the points of the reference are.
    """
    scale = float(np.ptp(rig.vertices, axis=0).max())
    found = nearest_of_posed(rig, bones, points, normals, monitor)
    apart = np.linalg.norm(found.on(rig.vertices, rig.faces) - at, axis=1) / scale
    belief = np.exp(-((apart / _STRAYED) ** 2))
    lost = belief <= _BELIEVED
    near = closest_points(rig.vertices, rig.faces, at[lost], monitor)
    for own, other in zip(found, near, strict=True):
        own[lost] = other
    return found, belief


def nearest_of_posed(
    rig: ReferenceRig, bones: BoneFit, points: FloatArray, normals: FloatArray, monitor: Monitor
) -> SurfacePoints:
    """Find the points of the posed reference that are closest to those of a body, and face the same way.

    `points` (n, 3), `normals` (n, 3): the body.
    """
    facing = _FACING * float(np.ptp(points, axis=0).max())
    laid = bones.posed(rig, rig.vertices, rig.weights)
    others = np.column_stack([laid, facing * vertex_normals(laid, rig.faces)])
    return closest_points(others, rig.faces, np.column_stack([points, facing * normals]), monitor)


def turned_round(rig: ReferenceRig, at: FloatArray, weights: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Turn a match back to front: every point of the reference becomes its counterpart after half a turn.

    So a body that was matched facing backwards is fitted the other way round without a second match.

    `at` (n, 3); `weights` (n, b); gives both for the other side.
    """
    found = closest_points(rig.vertices, rig.faces, at * [-1.0, -1, 1])
    there = found.on(rig.weights, rig.faces)
    return found.on(rig.vertices, rig.faces), (weights[:, rig.mates] + there) / 2


def laid_on(
    rig: ReferenceRig, bones: BoneFit, points: FloatArray, normals: FloatArray, areas: FloatArray, monitor: Monitor
) -> BoneFit:
    """Refine a skeleton that lies about right by closest points alone, without a match.

    `points` (n, 3), `normals` (n, 3), `areas` (n,): the body.
    """
    size = float(np.ptp(points, axis=0).max())
    for _ in range(UNLIKE):
        monitor.check()
        near = nearest_of_posed(rig, bones, points, normals, monitor)
        at, weights = near.on(rig.vertices, rig.faces), near.on(rig.weights, rig.faces)
        apart = np.linalg.norm(bones.posed(rig, at, weights) - points, axis=1) / size
        bones = laid_bones(rig, bones, points, normals, at, weights, areas * np.exp(-((apart / _LAID) ** 2)))
    return connected(rig, bones)
