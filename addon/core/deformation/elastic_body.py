"""As-rigid-as-possible deformation of the input towards an embedding, which turns no limb inside out."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..mesh.edges import is_closed
from ..numerics.arrays import FloatArray, IntArray
from ..numerics.factoring import factored
from ..run.monitor import Monitor
from ..surface.laplacian import mass, stiffness
from ..surface.triangulation import Triangulation
from .pressure import under_pressure
from .rotations import nearest_rotations
from .stretches import stretch_between

_STRUT = 3.0  # stiffness of a strut, in areas of its end over its length squared; also its maximum
_WIDE = 0.01  # diffusion time of the first rotations, as a share of the area: wide enough to cover a limb
_SMALL = 0.0005  # diffusion time of the rotations between a stretched form and the body, as a share of the area
_ROUNDING = 1e-9  # negative stiffness beyond which an edge has none: bridges that no flip made Delaunay would push
_YIELD = 0.15  # strain from which the force of an edge grows no more: skin at a joint yields before the limb bends
_YIELDING_STEPS = 3  # of a body that takes a pose
_TORN = 4.0  # stretch above which an edge is capped: bridges that open between parts say nothing about a limb
_BEYOND = 1e200  # stretch assigned to edges of zero length
_HARDLY = 1e-6  # a pull that only fixes the position of a form
_NEAR = 0.0015  # diffusion time of the frames that carry detail, as a share of the area: two edges of the coarse mesh


class ElasticBody:
    """The input as an elastic body: its surface is a shell, with struts through the interior.

    Parameters
    ----------
    surface : Triangulation
        The surface, Delaunay, so that no weight is negative.
    points : (n, 3) ndarray of float
        Positions of the undeformed vertices.
    faces : (m, 3) ndarray of int
        Triangles of the mesh.
    struts : (s, 2) ndarray of int, optional
        Pairs of vertices that face each other through the interior.

    Attributes
    ----------
    points : (n, 3) ndarray of float
        As given.
    mass : (n,) ndarray of float
        Areas of the vertices.

    Examples
    --------
    >>> from addon.core.surface.triangulation import triangulated
    >>> points = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    >>> faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
    >>> body = ElasticBody(triangulated(points, faces), points, faces)
    >>> quarter = np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]])
    >>> np.allclose(body.turns(points @ quarter), quarter)
    True
    """

    def __init__(
        self, surface: Triangulation, points: FloatArray, faces: IntArray, struts: IntArray | None = None
    ) -> None:
        from scipy.sparse import csr_matrix, diags, triu

        self.points, self.mass = points, mass(surface)
        self._faces, self._closed = faces, is_closed(faces)
        self._stiffness = stiffness(surface)
        shell = triu(self._stiffness, 1).tocoo()
        struts = np.empty((0, 2), dtype=np.int64) if struts is None else struts
        self._i, self._j = np.concatenate([np.column_stack([shell.row, shell.col]), struts]).T
        vectors = points[self._i] - points[self._j]  # (e, 3)
        length = np.linalg.norm(vectors, axis=1)
        self._is_shell = np.arange(len(length)) < shell.nnz
        thickness = np.maximum(length[~self._is_shell], np.finfo(float).tiny)
        area = self.mass[struts].mean(axis=1)
        cotangents = np.where(shell.data < _ROUNDING, -shell.data, 0.0)
        weight = np.concatenate([cotangents, _STRUT * np.minimum(area / thickness**2, 1.0)])
        self._vectors, self._weight = vectors, weight
        self._length, self._weighted = length, weight[:, None] * vectors
        count = len(weight)
        ends, start = np.column_stack([self._i, self._j]).ravel(), 2 * np.arange(count + 1)
        differences = csr_matrix((np.tile([1.0, -1.0], count), ends, start), shape=(count, len(points)))
        self._to_ends = differences.T.tocsr()
        self._sums = abs(self._to_ends)
        self._firmness = self._to_ends @ diags(weight) @ differences
        self._smoothers: dict[float, Callable[[FloatArray], FloatArray]] = {}
        self._solvers: dict[float, Callable[[FloatArray], FloatArray]] = {}

    def shell(self) -> tuple[IntArray, FloatArray]:
        """Return the edges of the shell and their stiffness.

        Returns
        -------
        edges : (e, 2) ndarray of int
            Pairs of vertices.
        stiffness : (e,) ndarray of float
            Their cotangent weights.
        """
        return np.column_stack([self._i, self._j])[self._is_shell], self._weight[self._is_shell]

    def smoothed(self, integrals: FloatArray, share: float) -> FloatArray:
        """Smooth values on the surface by one step of the heat flow.

        Parameters
        ----------
        integrals : (n, d) ndarray of float
            Values times areas.
        share : float
            Diffusion time, as a share of the area.

        Returns
        -------
        (n, d) ndarray of float
            Smoothed values.
        """
        from scipy.sparse import diags

        if share not in self._smoothers:
            time = share * float(self.mass.sum())
            self._smoothers[share] = factored(diags(self.mass) + time * self._stiffness).solve
        return self._smoothers[share](integrals)

    def covariances(self, after: FloatArray, share: float = _WIDE) -> FloatArray:
        """Compute the covariances of edge vectors before and after, over an area as wide as a limb.

        Parameters
        ----------
        after : (n, 3) ndarray of float
            Positions of the vertices.
        share : float
            Diffusion time, as a share of the area.

        Returns
        -------
        (n, 3, 3) ndarray of float
            Covariances of edge vectors, those before by row and those after by column, smoothed by the heat flow.
        """
        return self.smoothed(self._covariances(after).reshape(-1, 9), share).reshape(-1, 3, 3)

    def turns(self, after: FloatArray) -> FloatArray:
        """Compute the rotation of the neighbourhood of every vertex: of the edges near it.

        Parameters
        ----------
        after : (n, 3) ndarray of float
            Positions of the vertices.

        Returns
        -------
        (n, 3, 3) ndarray of float
            Rotations, ``x ↦ x R``.
        """
        return nearest_rotations(self.covariances(after, _NEAR))

    def frames(self, after: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Compute the rigid motion of the neighbourhood of every vertex: of the edges near it.

        The one-ring alone is not enough: a few nearly coplanar edges have a second rotation that fits as well.

        Parameters
        ----------
        after : (n, 3) ndarray of float
            Positions of the vertices.

        Returns
        -------
        rotation : (n, 3, 3) ndarray of float
            R, approximately a rotation: a mean of neighbouring ones.
        shift : (n, 3) ndarray of float
            t; the motion is ``x ↦ x R + t``.
        """
        rotation = self.turns(after)
        shift = after - np.einsum("ij,ijk->ik", self.points, rotation)
        motion = np.column_stack([rotation.reshape(-1, 9), shift]) * self.mass[:, None]
        motion = self.smoothed(motion, _NEAR)
        return motion[:, :9].reshape(-1, 3, 3), motion[:, 9:]

    def without_stretch(self, form: FloatArray, share: float) -> FloatArray:
        """Restore the mean lengths of the body around each point of a stretched form, and keep the form's directions.

        The edges of the body, rotated locally, and those of the form have a covariance around each point. The symmetric
        matrix that maps that of the form to that of the body is applied to the edges of the form, which are then
        reassembled. So a limb that was pulled straight and long stays straight.

        Parameters
        ----------
        form : (n, 3) ndarray of float
            The stretched form.
        share : float
            Diffusion time over which the stretch is averaged, as a share of the area.

        Returns
        -------
        (n, 3) ndarray of float
            The form without its stretch.
        """
        stretched = form[self._i] - form[self._j]
        turned = self._turned(self._vectors, nearest_rotations(self.covariances(form, _SMALL)))
        now = np.linalg.norm(stretched, axis=1)
        longer = np.divide(now, self._length, out=np.full_like(now, _BEYOND), where=self._length * _BEYOND > now)
        stretched_by = np.maximum(longer / _TORN, 1.0)[:, None]
        shrink = stretch_between(self._spreads(stretched / stretched_by, share), self._spreads(turned, share))
        edges = np.einsum("ij,ijk->ik", self._weight[:, None] * stretched, shrink[self._i] + shrink[self._j]) / 2
        return self._solver(_HARDLY)(self._to_ends @ edges)

    def turned(self, form: FloatArray, rotation: FloatArray) -> FloatArray:
        """Turn the edges of a form by the rotations at their ends, and reassemble them.

        Parameters
        ----------
        form : (n, 3) ndarray of float
            The form.
        rotation : (n, 3, 3) ndarray of float
            Rotations, ``x ↦ x R``, which vary little along an edge.

        Returns
        -------
        (n, 3) ndarray of float
            The form with its parts turned, and the lengths of its edges as far as possible.
        """
        edges = self._turned(form[self._i] - form[self._j], rotation)
        return self._solver(_HARDLY)(self._to_ends @ (self._weight[:, None] * edges))

    def _turned(self, edges: FloatArray, rotation: FloatArray) -> FloatArray:
        """Turn edges by the mean of the rotations at their ends; their lengths stay."""
        turned = np.einsum("ij,ijk->ik", edges, rotation[self._i] + rotation[self._j])
        length, now = (np.linalg.norm(each, axis=1) for each in (edges, turned))
        return turned * (length / np.maximum(now, np.finfo(float).tiny))[:, None]

    def _spreads(self, edges: FloatArray, share: float) -> FloatArray:
        """Compute the smoothed covariances of the edges of the shell with themselves."""
        outer = (self._is_shell * self._weight)[:, None, None] * edges[:, :, None] * edges[:, None, :]
        return self.smoothed(self._sums @ outer.reshape(-1, 9), share).reshape(-1, 3, 3)

    def stretch(self, after: FloatArray, share: float) -> FloatArray:
        """Compute how much longer the edges around every vertex are than those of the body.

        Parameters
        ----------
        after : (n, 3) ndarray of float
            Positions of the vertices.
        share : float
            Diffusion time over which lengths are averaged, as a share of the area.

        Returns
        -------
        (n,) ndarray of float
            Logarithm of the ratio of lengths.
        """
        longer = np.linalg.norm(after[self._i] - after[self._j], axis=1)
        shell = self._is_shell * self._weight * self._length
        sums = self.smoothed(self._sums @ (shell[:, None] * np.column_stack([longer, self._length])), share)
        return np.asarray(np.diff(np.log(np.maximum(sums[:, ::-1], np.finfo(float).tiny)), axis=1)[:, 0])

    def turned_towards(self, rotation: FloatArray, target: FloatArray, pull: FloatArray) -> FloatArray:
        """Rotate the edges of the body, reassemble them near a target, and let the skin yield there.

        Parameters
        ----------
        rotation : (n, 3, 3) ndarray of float
            Rotations, ``x ↦ x R``.
        target : (n, 3) ndarray of float
            Positions to which the vertices are pulled.
        pull : (n,) ndarray of float
            Strength of the pull, in 1/area, above 0.

        Returns
        -------
        (n, 3) ndarray of float
            The vertices, with the lengths of the body as far as possible.
        """
        from scipy.sparse import diags

        anchor = pull * self.mass
        solve = factored(self._firmness + diags(anchor)).solve
        pulled = anchor[:, None] * target
        positions = solve(self._rotated(rotation, np.ones(len(self._weight))) + pulled)
        unbent = np.where(self._is_shell, 0.0, 1.0)
        for _ in range(_YIELDING_STEPS):
            rotation = nearest_rotations(self._covariances(positions))
            positions = solve(self._force(positions, rotation, unbent, yielding=True) + pulled)
        return positions

    def deformed_towards(
        self,
        target: FloatArray,
        *,
        pull: float,
        steps: int,
        bending_weight: float = 1.0,
        monitor: Monitor | None = None,
        pressure: bool = False,
        yielding: bool = False,
        done: float = 0.0,
        share: float = 1.0,
    ) -> FloatArray:
        """Deform the body as rigidly as possible while its vertices are pulled to given positions.

        Parameters
        ----------
        target : (n, 3) ndarray of float
            Positions to which the vertices are pulled.
        pull : float
            Strength of the pull, in 1/area.
        steps : int
            Number of alternations between rotations and positions.
        bending_weight : float
            Share of the shell's energy that keeps its bends, 0 to 1. The rest keeps only the lengths of the edges, not
            their directions: creases of the pose may open. Struts always keep their direction.
        monitor : Monitor, optional
            Receives progress; polled for cancellation.
        pressure : bool
            Whether the compactness ``V² / A³`` of a closed mesh is kept, by an even pressure.
        yielding : bool
            Whether edges yield like skin: from a strain of .15, the force that keeps a length does not grow.
        done, share : float
            The fraction of the current stage that is done before, and the fraction that this call covers.

        Returns
        -------
        (n, 3) ndarray of float
            The deformed vertices.

        Raises
        ------
        CancelledError
            If the run is cancelled.

        References
        ----------
        Sorkine and Alexa, "As-Rigid-As-Possible Surface Modeling", 2007, doi:10.2312/SGP/SGP07/109-116. The first
        rotations come from covariances diffused over the surface, so that a limb that the target squashes or turns
        inside out is restored. Edges that yield have the loss of Huber, "Robust estimation of a location parameter",
        1964, doi:10.1214/aoms/1177703732.
        """
        monitor = monitor or Monitor()
        anchor = pull * self.mass
        solve = self._solver(pull)
        monitor.check()
        bending: FloatArray = np.where(self._is_shell, float(bending_weight), 1.0)
        positions, rotation = target, nearest_rotations(self.covariances(target))
        for step in range(steps):
            positions = solve(self._force(positions, rotation, bending, yielding) + anchor[:, None] * target)
            if pressure and self._closed:
                positions = under_pressure(positions, self.points, self._faces, solve)
            monitor.tick(done + share * (step + 1) / steps)
            if step + 1 < steps:
                rotation = nearest_rotations(self._covariances(positions))
        return positions

    def _solver(self, pull: float) -> Callable[[FloatArray], FloatArray]:
        from scipy.sparse import diags

        if pull not in self._solvers:
            self._solvers[pull] = factored(self._firmness + diags(pull * self.mass)).solve
        return self._solvers[pull]

    def _force(self, positions: FloatArray, rotation: FloatArray, bending: FloatArray, yielding: bool) -> FloatArray:
        """Sum the edges at each vertex: rotated by their share of bending, of the length kept by the rest."""
        force = self._rotated(rotation, bending)
        if (bending < 1).any():
            force += self._with_lengths_kept(positions, 1.0 - bending, yielding)
        return force

    def _covariances(self, after: FloatArray) -> FloatArray:
        moved = after[self._i] - after[self._j]
        outer = (self._weighted[:, :, None] * moved[:, None, :]).reshape(-1, 9)
        return (self._sums @ outer).reshape(-1, 3, 3)

    def _rotated(self, rotation: FloatArray, share: FloatArray) -> FloatArray:
        turn = rotation[self._i] + rotation[self._j]
        return self._to_ends @ np.einsum("ij,ijk->ik", share[:, None] * self._weighted / 2, turn)

    def _with_lengths_kept(self, positions: FloatArray, share: FloatArray, yielding: bool) -> FloatArray:
        moved = positions[self._i] - positions[self._j]
        now = np.linalg.norm(moved, axis=1)
        wanted = self._length
        if yielding:
            most = _YIELD * self._length
            wanted = now - np.clip(now - self._length, -most, most)
        now[now == 0] = 1.0
        return self._to_ends @ ((share * self._weight * wanted / now)[:, None] * moved)
