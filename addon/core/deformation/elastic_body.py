"""The input as an elastic body, which is deformed towards a form as rigidly as possible, no limb inside out."""

from __future__ import annotations

from itertools import chain, repeat
from typing import TYPE_CHECKING

import numpy as np

from ..mesh.edges import is_closed
from ..numerics.arrays import FloatArray, IntArray
from ..numerics.factoring import factored
from ..run.monitor import Monitor
from ..stress.majorisation import Majorisation, Solve, anchored_solver
from ..stress.pairs import Pairs, length
from .pressure import under_pressure
from .rotations import nearest_rotations
from .stretches import stretch_between

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

_STRUT = 3.0  # stiffness of a strut, in areas of its end over its length squared; also its maximum
_ROUNDING = 1e-9  # negative stiffness beyond which an edge has none: bridges that no flip made Delaunay would push
_WIDE = 0.01  # diffusion time of the first rotations, as a share of the area: wide enough to cover a limb
_SMALL = 0.0005  # diffusion time of the rotations between a stretched form and the body
_NEAR = 0.0015  # diffusion time of the frames that carry detail: two edges of the coarse mesh
_YIELD = 0.15  # strain from which the force of an edge grows no more: skin at a joint yields before the limb bends
_YIELDING_STEPS = 3  # of a body that takes a pose
_TORN = 4.0  # stretch above which an edge is capped: bridges that open between parts say nothing about a limb
_HARDLY = 1e-6  # an anchor that only fixes the position of a form


class ElasticBody:
    """A surface as a shell of edges, with struts through the interior.

    `stiffness` (n, n) and `mass` (n,): L and M of the surface, of Delaunay triangles, so that no weight is negative;
    `points` (n, 3); `faces` (m, 3); `struts` (s, 2).

    Attributes
    ----------
    near : Pairs
        Edges of the surface, then struts.
    is_edge : (e,) ndarray of bool
        Which of them are edges.
    length : (e,) ndarray of float
        Their lengths.
    mass : (n,) ndarray of float
        Areas of the vertices.

    Examples
    --------
    >>> from addon.core.surface.laplacian import stiffness_and_mass
    >>> from addon.core.surface.triangulation import triangulated
    >>> points = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    >>> faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
    >>> body = ElasticBody(*stiffness_and_mass(triangulated(points, faces)), points, faces)
    >>> quarter = np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]])
    >>> np.allclose(body.rotations(points @ quarter), quarter)
    True
    """

    def __init__(
        self,
        stiffness: csr_matrix,
        mass: FloatArray,
        points: FloatArray,
        faces: IntArray,
        struts: IntArray | None = None,
    ) -> None:
        from scipy.sparse import triu

        self.points, self.faces, self.mass = points, faces, mass
        self._stiffness, self._closed = stiffness, is_closed(faces)
        edges = triu(self._stiffness, 1).tocoo()
        struts = np.empty((0, 2), dtype=np.int64) if struts is None else struts
        ends = np.concatenate([np.column_stack([edges.row, edges.col]), struts])
        self.is_edge = np.arange(len(ends)) < edges.nnz
        self._vectors = points[ends[:, 0]] - points[ends[:, 1]]  # (e, 3)
        self.length = length(self._vectors)
        firm = _STRUT * np.minimum(self.mass[struts].mean(axis=1) / self.length[edges.nnz :] ** 2, 1.0)
        skin = np.where(edges.data < _ROUNDING, -edges.data, 0.0)
        self.near = Pairs(ends, np.concatenate([skin, firm]), len(points))
        self._smoothers: dict[float, Solve] = {}
        self._solvers: dict[float, Solve] = {}

    def smoothed(self, integrals: FloatArray, share: float) -> FloatArray:
        """Smooth values times areas by one step of the heat flow, over a time given as a share of the area."""
        from scipy.sparse import diags

        if share not in self._smoothers:
            time = share * float(self.mass.sum())
            self._smoothers[share] = factored(diags(self.mass) + time * self._stiffness).solve
        return self._smoothers[share](integrals)

    def covariances(self, after: FloatArray, share: float = _WIDE) -> FloatArray:
        """Sum ``w a bᵀ`` of the pairs' vectors before (a) and after (b) around each vertex, smoothed: (n, 3, 3)."""
        return self._covariances(self._vectors, self.near.apart(after), share)

    def rotations(self, after: FloatArray, share: float = 0.0) -> FloatArray:
        """Find how the surroundings of each vertex are turned, x ↦ x R: (n, 3, 3)."""
        return nearest_rotations(self.covariances(after, share))

    def turns(self, after: FloatArray) -> FloatArray:
        """Find how the neighbourhood of each vertex is turned, about two edges wide: (n, 3, 3)."""
        return self.rotations(after, _NEAR)

    def frames(self, after: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Find the rigid motion ``x ↦ x R + s`` of the neighbourhood of each vertex: (n, 3, 3) and (n, 3)."""
        rotation = self.turns(after)
        shift = after - np.einsum("ij,ijk->ik", self.points, rotation)
        motion = np.column_stack([rotation.reshape(-1, 9), shift]) * self.mass[:, None]
        motion = self.smoothed(motion, _NEAR)
        return motion[:, :9].reshape(-1, 3, 3), motion[:, 9:]

    def towards(
        self,
        target: FloatArray,
        pull: float,
        steps: int,
        *,
        bending: float = 1.0,
        pressed: bool = False,
        monitor: Monitor | None = None,
    ) -> FloatArray:
        """Deform the body towards positions of its vertices.

        `target` (n, 3); `pull`: how firmly each vertex is pulled there, per area; `steps`: number of steps;
        `bending`: what edges want: their vector, turned with its surroundings (1), only their length, so that creases
        may open (0), or a mixture; `pressed`: whether a closed body keeps its compactness by an even pressure; gives
        (n, 3).
        """
        solve = self._solver(pull)
        share = np.where(self.is_edge, bending, 1.0)[:, None]
        times = chain([_WIDE], repeat(0.0))  # first over a limb, so that none stays inside out

        def wants(apart: FloatArray, points: FloatArray) -> FloatArray:
            turned = self._mapped(self._vectors, self.rotations(points, next(times)))
            return share * turned + (1 - share) * apart * (self.length / length(apart))[:, None]

        after = self._inflated if pressed and self._closed else None
        stress = Majorisation([self.near.wanting(wants)], pull * self.mass, target, solve)
        return stress.lowered(target, steps, after=after, monitor=monitor)[0]

    def turned_towards(self, rotation: FloatArray, target: FloatArray, pull: FloatArray) -> FloatArray:
        """Turn the edges of the body, reassemble them near a target, (n,) firmly, and let the skin yield there."""
        anchor = pull * self.mass
        solve = anchored_solver(self.near.laplacian(), anchor)
        turned = self.near.wanting(lambda *_: self._mapped(self._vectors, rotation))
        points, _ = Majorisation([turned], anchor, target, solve).lowered(target, 1)

        def wants(apart: FloatArray, points: FloatArray) -> FloatArray:
            turned = self._mapped(self._vectors, self.rotations(points))
            now = length(apart)
            strain = np.clip(now - self.length, -_YIELD * self.length, _YIELD * self.length)
            return np.where(self.is_edge[:, None], apart * (1 - strain / now)[:, None], turned)

        stress = Majorisation([self.near.wanting(wants)], anchor, target, solve)
        return stress.lowered(points, _YIELDING_STEPS, momentum=False)[0]

    def without_stretch(self, form: FloatArray, share: float) -> FloatArray:
        """Undo the stretch of a form, averaged around each point over a time; directions stay.

        The stretch U around a point takes the covariance of the form's edges to that of the body's, U C U = D.
        """
        now = self.near.apart(form)
        turned = self._mapped(self._vectors, self.rotations(form, _SMALL))
        turned *= (self.length / length(turned))[:, None]
        torn = np.maximum(length(now) / np.maximum(_TORN * self.length, 1e-300), 1.0)[:, None]
        edges = self.is_edge[:, None]  # a limb that is pulled long is also thin, which struts would take for a stretch
        spreads = (self._covariances(edges * each, each, share) for each in (now / torn, turned))
        return self._reassembled(self._mapped(now, stretch_between(*spreads)), np.zeros_like(form))

    def stretch(self, after: FloatArray, share: float) -> FloatArray:
        """Compute the logarithm of how much longer the edges around each vertex are than those of the body: (n,)."""
        long = (self.is_edge * self.length)[:, None] * np.column_stack([self.length, length(self.near.apart(after))])
        sums = np.maximum(self.smoothed(self.near.summed(long), share), np.finfo(float).tiny)
        return np.asarray(np.log(sums[:, 1] / sums[:, 0]))

    def _solver(self, pull: float) -> Solve:
        """Factor the stiffness of all pairs with a pull on each vertex, per area; once for each pull."""
        if pull not in self._solvers:
            self._solvers[pull] = anchored_solver(self.near.laplacian(), pull * self.mass)
        return self._solvers[pull]

    def _reassembled(self, vectors: FloatArray, place: FloatArray) -> FloatArray:
        """Find the positions whose pairs have given vectors as nearly as can be; `place` fixes where they lie."""
        return self._solver(_HARDLY)(self.near.pulled(vectors) + _HARDLY * self.mass[:, None] * place)

    def _mapped(self, vectors: FloatArray, maps: FloatArray) -> FloatArray:
        """Map the vector of each pair by the mean of the maps at its ends."""
        return np.einsum("ij,ijk->ik", vectors, self.near.mean(maps))

    def _covariances(self, one: FloatArray, two: FloatArray, share: float) -> FloatArray:
        """Sum ``w a bᵀ`` around each vertex, smoothed over a time if it is above 0."""
        sums = self.near.summed((one[:, :, None] * two[:, None, :]).reshape(-1, 9))
        return (self.smoothed(sums, share) if share else sums).reshape(-1, 3, 3)

    def _inflated(self, points: FloatArray, solve: Solve) -> FloatArray:
        return under_pressure(points, self.points, self.faces, solve)
