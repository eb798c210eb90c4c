"""Pieces that ride on a body: they follow the surface under them, and keep their shape."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ..deformation.elastic_body import ElasticBody
from ..deformation.rotations import nearest_rotations
from ..measures.form_measures import edge_stretch
from ..mesh.geometry import moved_by_frames, of_unit_area
from ..numerics.arrays import FloatArray, IntArray
from ..run.monitor import Monitor
from ..surface.laplacian import stiffness_and_mass
from ..surface.working_surface import working_surface
from .contacts import SPACING, Samples
from .pieces import Piece

if TYPE_CHECKING:
    from scipy.spatial import KDTree

_REACH = 0.02  # distance up to which ground moves a rider, in sqrt(area) of the mesh, like the lengths below
_UNDER = 0.03  # radius of the surface under a contact that determines its motion
_SMALL_HALF, _SMALL_AREA = 0.06, 0.004  # half the diagonal and the area below which a rider is rigid
_FEWEST = 24  # vertices of a rider that bends
_STRETCHED = 0.3  # 95th percentile of the edge distortion above which a rider moves rigidly instead of bending
_LARGE = 0.025  # area from which that is told: a belt that stays stiff is hardly seen
_LOOSE = 0.3  # share of a rider on its carrier below which it is rigid
_OFF, _ROUNDS = 0.005, 5  # deviation of ground of the same limb from its rigid motion; iterations of the robust fit
_RIDERS_AT_ONCE = 256  # whose contacts are held in memory
_NEIGHBOURS = 24  # samples from which the rotation of the surface at one of them is estimated
_NEAREST = 6  # samples under a vertex of a rider that move it
_WORKED_ON = 400  # working vertices of a rider
_SPREAD = 0.002  # diffusion time of the motion over a rider, as a share of its area
_FAR, _FAR_SHARE = 100, 1e-4  # factor on that time, and its weight: for parts far from any contact
_PULL, _STEPS = 60.0, 8  # strength of the pull towards the motion of the ground, in 1/area; alternations


@dataclass(frozen=True, eq=False)
class Ground:
    """The surface that carries riders, before and after it moved.

    Attributes
    ----------
    before, after : (s, 3) ndarray of float
        Samples of it.
    """

    before: FloatArray
    after: FloatArray

    @cached_property
    def tree(self) -> KDTree:
        """The samples before the move, for searches."""
        from scipy.spatial import KDTree

        return KDTree(self.before)


def ground_of(samples: Sequence[Samples], shapes: Sequence[FloatArray]) -> Ground:
    """Combine the samples of several pieces.

    `samples`: samples of each piece; `shapes`: positions of its vertices after the move.

    Examples
    --------
    >>> from addon.core.assembly.contacts import sampled
    >>> points, faces = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]])
    >>> ground = ground_of([sampled(points, faces, 0.1)], [points + 1])
    >>> np.allclose(ground.after, ground.before + 1)
    True
    """
    return Ground(
        np.concatenate([each.points for each in samples]),
        np.concatenate([each.on(shape) for each, shape in zip(samples, shapes, strict=True)]),
    )


def is_rigid(points: FloatArray, area: float, covered: float) -> bool:
    """Check whether a rider moves rigidly: because it is small, or has little contact.

    `points` (n, 3); `area`: its area, as a share of the mesh; `covered`: share of it that touches its carrier.

    Examples
    --------
    >>> is_rigid(np.array([[0.0, 0, 0], [0.05, 0, 0]]), 0.01, 1.0)
    True
    """
    half = float(np.linalg.norm(np.ptp(points, axis=0))) / 2
    return len(points) < _FEWEST or half < _SMALL_HALF or area < _SMALL_AREA or covered < _LOOSE


def ridden(
    pieces: Sequence[Piece], samples: Sequence[Samples], ground: Ground, *, rigid: bool, monitor: Monitor
) -> list[FloatArray]:
    """Move riders with the ground under them.

    `pieces`: the riders; `samples`: samples of each; `ground`: what carries them; `rigid`: whether they move rigidly;
    otherwise they follow what lies under each of their parts, as rigidly as possible.

    Examples
    --------
    >>> from addon.core.assembly.contacts import sampled
    >>> points, faces = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]])
    >>> below, turn = sampled(points, faces, 0.02), np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]])
    >>> rider = Piece(np.arange(3), 0.1 * points + [0.2, 0.2, 0.01], faces)
    >>> own, ground = sampled(rider.points, faces), ground_of([below], [points @ turn + 3])
    >>> (moved,) = ridden([rider], [own], ground, rigid=True, monitor=Monitor())
    >>> np.allclose(moved, rider.points @ turn + 3)
    True

    References
    ----------
    Sumner, Schmid and Pauly, "Embedded Deformation for Shape Manipulation", 2007, doi:10.1145/1276377.1276478;
    Sorkine and Alexa, "As-Rigid-As-Possible Surface Modeling", 2007, doi:10.2312/SGP/SGP07/109-116; Geman and
    McClure, "Statistical Methods for Tomographic Image Reconstruction", 1987 (the robust weights).
    """
    if rigid:
        return _moved_as_one(pieces, samples, ground, monitor)
    moved = []
    for piece, own in zip(pieces, samples, strict=True):
        shape = _draped(piece.points, piece.faces, ground, monitor)
        if np.quantile(np.abs(edge_stretch(piece.points, shape, piece.faces) - 1), 0.95) >= _STRETCHED:
            if own.area > _LARGE:
                monitor.warn("rider_stretched")
            (shape,) = _moved_as_one([piece], [own], ground, monitor)
        moved.append(shape)
    return moved


def _moved_as_one(
    pieces: Sequence[Piece], samples: Sequence[Samples], ground: Ground, monitor: Monitor
) -> list[FloatArray]:
    """Move each rider as one rigid whole."""
    moved: list[FloatArray] = []
    for start in range(0, len(pieces), _RIDERS_AT_ONCE):
        monitor.check()
        some = slice(start, start + _RIDERS_AT_ONCE)
        motions = zip(pieces[some], *_rigid_motions(samples[some], ground), strict=True)
        moved += [piece.points @ rotation + shift for piece, rotation, shift in motions]
    return moved


def _rigid_motions(riders: Sequence[Samples], ground: Ground) -> tuple[FloatArray, FloatArray]:
    """Fit a rigid motion of each rider to the ground around its contact, except for ground that moves away from it."""
    first = np.cumsum([0, *(len(each.points) for each in riders)])[:-1]
    owner = np.repeat(np.arange(len(riders)), [len(each.points) for each in riders])
    distance, at = ground.tree.query(np.concatenate([each.points for each in riders]))
    gap = np.minimum.reduceat(distance, first)[owner]
    touching = distance <= np.maximum(_REACH, gap + _REACH / 2)
    owner, at = owner[touching], at[touching]
    weight = np.exp(-(((distance - gap)[touching] / SPACING) ** 2))
    under = ground.tree.query_ball_point(ground.before[at], _UNDER)
    count = [len(each) for each in under]
    each, contact = np.concatenate([np.asarray(one, dtype=np.int64) for one in under]), np.repeat(at, count)
    share = np.repeat(weight / np.maximum(count, 1), count) * _stays(ground, contact, each)
    used, place = np.unique(np.repeat(owner, count) * len(ground.before) + each, return_inverse=True)
    summed = np.maximum(np.bincount(place.ravel(), share, minlength=len(used)), 1e-300)
    owner, used = np.divmod(used, len(ground.before))
    first = np.flatnonzero(np.diff(owner, prepend=-1))
    before, after, trust = ground.before[used], ground.after[used], np.ones(len(used))
    for _ in range(_ROUNDS):
        rotations, shifts = _rigid_fits(before, after, summed * trust, owner, first)
        moved = moved_by_frames(before, rotations[owner], shifts[owner])
        trust = 1 / (1 + (np.linalg.norm(moved - after, axis=1) / _OFF) ** 2) ** 2 + 1e-9
    return rotations, shifts


def _rigid_fits(
    before: FloatArray, after: FloatArray, weight: FloatArray, owner: IntArray, first: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Compute the rigid motion of every group of matching points, which start at `first`."""
    share = (weight / np.add.reduceat(weight, first)[owner])[:, None]
    here, there = np.add.reduceat(share * before, first), np.add.reduceat(share * after, first)  # the centroids
    products = (share * (before - here[owner]))[:, :, None] * (after - there[owner])[:, None, :]
    rotations = nearest_rotations(np.add.reduceat(products, first))
    return rotations, there - np.einsum("ri,rij->rj", here, rotations)


def _stays(ground: Ground, here: IntArray, there: IntArray) -> FloatArray:
    """Weigh samples of the ground by how well they keep their distance from others: those of the same limb do."""
    before = np.linalg.norm(ground.before[here] - ground.before[there], axis=-1)
    after = np.linalg.norm(ground.after[here] - ground.after[there], axis=-1)
    return np.exp(-(((after - before) / _OFF) ** 2))


def _draped(points: FloatArray, faces: IntArray, ground: Ground, monitor: Monitor) -> FloatArray:
    """Let every part follow the surface under it, and parts without contact follow their surroundings."""
    monitor.check()
    scaled, _, unit = of_unit_area(points, faces)
    surface = working_surface(scaled, faces, _WORKED_ON, monitor=monitor)
    kept = points[surface.kept]
    distance, at = ground.tree.query(kept, k=min(_NEAREST, len(ground.before)))
    distance, at = distance.reshape(len(kept), -1), at.reshape(len(kept), -1)
    used, place = np.unique(at, return_inverse=True)
    turn = _turns(ground, used)[place.reshape(at.shape)]  # (c, k, 3, 3)
    shift = ground.after[at] - np.einsum("cki,ckij->ckj", ground.before[at], turn)
    nearest = distance[:, :1]
    weight = np.exp(-(((distance - nearest) / SPACING) ** 2))
    weight /= weight.sum(axis=1, keepdims=True)
    motion = np.concatenate([turn.reshape(*at.shape, 9), shift], axis=2)  # (c, k, 12)
    motion = np.einsum("ck,ckd->cd", weight, motion)
    body = ElasticBody(*stiffness_and_mass(surface.triangulation), surface.points, surface.faces)
    trust = np.exp(-((nearest[:, 0] / _REACH) ** 2)) + 1e-9
    trusted = np.column_stack([motion * trust[:, None], trust]) * body.mass[:, None]
    spread = body.smoothed(trusted, _SPREAD) + _FAR_SHARE * body.smoothed(trusted, _FAR * _SPREAD)
    motion = spread[:, :12] / spread[:, 12:]
    monitor.check()
    target = moved_by_frames(kept, motion[:, :9].reshape(-1, 3, 3), motion[:, 9:])
    placed = body.towards(target / unit, _PULL, _STEPS, monitor=Monitor(cancelled=monitor.is_cancelled))
    rotation, shift = surface.prolong_frames(*body.frames(placed))
    return moved_by_frames(scaled, rotation, shift) * unit if surface.coarse else placed * unit


def _turns(ground: Ground, where: IntArray) -> FloatArray:
    """Estimate the rotation of the ground at some of its samples, from neighbours of the same limb."""
    k = min(_NEIGHBOURS, len(ground.before))
    around = ground.tree.query(ground.before[where], k=k)[1].reshape(len(where), -1)
    same = _stays(ground, np.broadcast_to(where[:, None], around.shape), around)
    before = ground.before[around] - ground.before[where][:, None]
    after = ground.after[around] - ground.after[where][:, None]
    return nearest_rotations(np.einsum("sk,ski,skj->sij", same, before, after))
