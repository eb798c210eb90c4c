"""Where the bones of a reference lie in another body, from a match of the two skins."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..deformation.rotations import nearest_rotations
from ..numerics.arrays import BoolArray, FloatArray, IntArray
from .reference_rig import ReferenceRig
from .skeleton import BoneMotions, Skeleton, skinned
from .stance import swing

_ROUNDS = 3  # of robust weights
_ALTERNATIONS = 4  # of rotation and scales
_ENOUGH = 1e-5  # share of the skin below which a bone follows its parent
_LOCAL = 1.5  # radii of a limb: reach of the skin that tells where a joint is
_THIN = 1e-3  # of the reference's size: least radius of a limb
_PRIOR = 0.3  # weight of a bone's own rotation where only the skin near a joint is used
_POINT = 1e-6  # of the longest bone: length of one that is but a point
_LONG, _SHORT = 5.0, 0.2  # bounds of a bone's scales, relative to the body's


class BoneFit(NamedTuple):
    """The bones of a reference in the pose and proportions of another body.

    Attributes
    ----------
    heads, tails : (b, 3) ndarray of float
        Where each bone begins and ends.
    turns : (b, 3, 3) ndarray of float
        Rotation of each bone from the reference, for column vectors.
    scales : (b, 2) ndarray of float
        How much larger the body is than the reference, along each bone and across it.
    """

    heads: FloatArray
    tails: FloatArray
    turns: FloatArray
    scales: FloatArray

    def posed(self, rig: ReferenceRig, points: FloatArray, weights: FloatArray) -> FloatArray:
        """Carry points of the reference to the body. `points` (n, 3); `weights` (n, b); gives (n, 3)."""
        turns = self.turns @ stretches(rig.axes, self.scales)
        return skinned(points, weights, BoneMotions(rig.skeleton.heads, self.heads, turns))


def stretches(axes: FloatArray, scales: FloatArray) -> FloatArray:
    """Return the maps that scale along bones and across them, (b, 3, 3). `axes` (b, 3); `scales` (b, 2)."""
    line = axes[:, :, None] * axes[:, None, :]
    along, across = scales.T[:, :, None, None]
    return np.asarray(across * np.eye(3) + (along - across) * line)


class _Similarities(NamedTuple):
    """One motion with two scales for each bone: ``x ↦ there + R S (x - here)``."""

    turns: FloatArray  # (b, 3, 3)
    scales: FloatArray  # (b, 2)
    here: FloatArray  # (b, 3)
    there: FloatArray  # (b, 3)

    def of(self, points: FloatArray, axes: FloatArray) -> FloatArray:
        """Move points with every bone, (n, b, 3); or one point each with its own bone, (b, 3)."""
        apart = (points if points.shape == self.here.shape else points[:, None]) - self.here
        along = np.einsum("...bi,bi->...b", apart, axes)[..., None]
        scaled = self.scales[:, 1:] * apart + (self.scales[:, :1] - self.scales[:, 1:]) * along * axes
        return np.asarray(np.einsum("bij,...bj->...bi", self.turns, scaled) + self.there)


def fitted_bones(
    rig: ReferenceRig, points: FloatArray, areas: FloatArray, at: FloatArray, weights: FloatArray, sure: FloatArray
) -> BoneFit:
    """Fit the bones of a reference to another body.

    Every bone is a similarity with a scale along and one across, robustly fitted to the skin that it moves; a joint is
    where the skin of both its bones near it puts it.

    `points` (n, 3) of the body; `areas` (n,) of them; `at` (n, 3): the matching points of the reference; `weights`
    (n, b): of the bones there; `sure` (n,): confidence, 0 to 1.

    References
    ----------
    Horn, "Closed-form solution of absolute orientation using unit quaternions", 1987, doi:10.1364/JOSAA.4.000629.
    """
    mass = (areas * sure)[:, None] * weights  # (n, b)
    parents, heads, tails = rig.skeleton.parents, rig.skeleton.heads, rig.skeleton.tails
    axes = rig.axes
    whole = _similarities(at, points, mass, axes)
    for _ in range(_ROUNDS):
        error = np.linalg.norm(whole.of(at, axes) - points[:, None], axis=2)  # (n, b)
        typical = np.sqrt((mass * error**2).sum(axis=0) / np.maximum(mass.sum(axis=0), 1e-30)) + 1e-9
        whole = _similarities(at, points, mass / (1 + (error / typical) ** 2), axes)
    known = known_bones(mass)
    whole = _taken(whole, movers(rig.skeleton, mass))
    radius = np.linalg.norm(rig.vertices[:, None] - heads, axis=2).min(axis=0)  # (b,) of the limb at each joint
    radius = np.maximum(radius, _THIN * np.ptp(rig.vertices, axis=0).max())  # a joint may lie on the skin
    near = np.exp(-(((at[:, None] - heads) ** 2).sum(axis=2)) / (2 * (_LOCAL * radius) ** 2))  # (n, b)
    above = np.where(parents < 0, np.arange(len(parents)), parents)
    guesses, shares = [], []
    for bones in (np.arange(len(parents)), above):  # the bone itself, and its parent, at the bone's head
        local = mass[:, bones] * near
        share = np.where(known[bones], local.sum(axis=0), 0.0)
        some = share > _ENOUGH * mass.sum()
        own = _similarities(at, points, local, axes[bones], prior=whole.turns[bones])
        here = np.where(some[:, None], own.of(heads, axes[bones]), _taken(whole, bones).of(heads, axes[bones]))
        guesses.append(here)
        shares.append(np.where(some, share, np.where(known[bones], _ENOUGH * mass.sum(), 1e-30)))
    total = shares[0] + shares[1]
    placed = (shares[0][:, None] * guesses[0] + shares[1][:, None] * guesses[1]) / total[:, None]
    ends = whole.of(tails, axes) + placed - whole.of(heads, axes)
    return connected(rig, BoneFit(placed, ends, whole.turns, whole.scales))


def known_bones(mass: FloatArray) -> BoolArray:
    """Tell which bones have skin enough to be fitted by it, (b,). `mass` (n, b): of the skin that each bone holds."""
    return np.asarray(mass.sum(axis=0) > _ENOUGH * mass.sum())


def connected(rig: ReferenceRig, fit: BoneFit) -> BoneFit:
    """Let bones end where the next begins if they do in the reference, and point there."""
    ends, turns, axes = fit.tails.copy(), fit.turns.copy(), rig.axes
    for bone, parent in enumerate(rig.skeleton.parents):
        if parent >= 0 and np.allclose(rig.skeleton.heads[bone], rig.skeleton.tails[parent]):
            ends[parent] = fit.heads[bone]
    long = np.linalg.norm(rig.skeleton.tails - rig.skeleton.heads, axis=1)
    for bone in np.flatnonzero(long > _POINT * long.max()):  # shorter ones have no direction
        way = ends[bone] - fit.heads[bone]
        if np.linalg.norm(way) > 0:
            turns[bone] = swing(turns[bone] @ axes[bone], way) @ turns[bone]
    return fit._replace(tails=ends, turns=turns)


def movers(skeleton: Skeleton, mass: FloatArray) -> IntArray:
    """Return the bone with which each moves, (b,): itself, or for want of skin that above; roots go with the first.

    `mass` (n, b): of the skin that each bone holds.
    """
    known, found = known_bones(mass), np.arange(len(skeleton.names))
    depth = np.array([len(skeleton.ancestors(bone)) for bone in found])
    first = int(np.lexsort((-mass.sum(axis=0), depth, ~known))[0])  # of the body, whichever is listed first
    for bone in skeleton.downwards():
        if known.any() and not known[bone]:
            found[bone] = found[skeleton.parents[bone]] if skeleton.parents[bone] >= 0 else first
    return found


def growth(at: FloatArray, points: FloatArray) -> float:
    """Return how much larger a body is than the reference. `at` (n, 3): points of that one; `points` (n, 3)."""
    return float(np.sqrt(points.var(axis=0).sum() / max(float(at.var(axis=0).sum()), 1e-30)))


def turns_and_scales(
    maps: FloatArray,
    axes: FloatArray,
    larger: float,
    *,
    long: FloatArray | float = 1.0,
    wide: FloatArray | float = 2.0,
    prior: FloatArray | float = 0.0,
) -> tuple[FloatArray, FloatArray]:
    """Find the rotations with scales along bones and across them that are nearest to maps, (b, 3, 3) and (b, 2).

    `maps` (b, 3, 3): or moments of skin, before and after; `larger`: by `growth`; `long`, `wide` (b,): how far the
    skin reaches along the bone and across it, of moments; `prior` (b, 3, 3): weighed rotations that are preferred.
    """
    scales = np.full((len(axes), 2), larger)
    for _ in range(_ALTERNATIONS):
        turns = nearest_rotations(maps @ stretches(axes, scales) + prior)
        back = turns.transpose(0, 2, 1) @ maps
        along = np.einsum("bi,bij,bj->b", axes, back, axes)
        across = np.trace(back, axis1=1, axis2=2) - along
        scales = np.clip(np.column_stack([along / long, across / wide]), _SHORT * larger, _LONG * larger)
    return turns, scales


def _taken(some: _Similarities, bones: IntArray) -> _Similarities:
    return _Similarities(*(each[bones] for each in some))


def _similarities(
    at: FloatArray, points: FloatArray, mass: FloatArray, axes: FloatArray, prior: FloatArray | None = None
) -> _Similarities:
    """Fit a motion with two scales to each bone: from the moments of its skin alone."""
    share = mass / np.maximum(mass.sum(axis=0), 1e-30)
    here, there = share.T @ at, share.T @ points
    spread = np.einsum("nb,ni,nj->bij", share, at, at) - here[:, :, None] * here[:, None, :]
    both = np.einsum("nb,ni,nj->bij", share, points, at) - there[:, :, None] * here[:, None, :]
    size = np.maximum(np.trace(spread, axis1=1, axis2=2), 1e-30)
    long = np.maximum(np.einsum("bi,bij,bj->b", axes, spread, axes), 1e-30)
    larger = growth(at, points)
    weighed = 0.0 if prior is None else _PRIOR * larger**2 * size[:, None, None] * prior
    wide = np.maximum(size - long, 1e-30)
    return _Similarities(*turns_and_scales(both, axes, larger, long=long, wide=wide, prior=weighed), here, there)
