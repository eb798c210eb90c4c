"""Interpolation from the pose to the form: shapes that bend like joints, uniformly or by vertex."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from ..deformation.elastic_body import ElasticBody
from ..deformation.rotations import nearest_rotations
from ..mesh.geometry import moved_by_frames, of_unit_area, vertex_areas
from ..numerics.arrays import FloatArray, IntArray
from ..numerics.factoring import factored
from ..run.monitor import Monitor
from ..surface.laplacian import stiffness_and_mass
from ..surface.working_surface import WorkingSurface, working_surface

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

WORKED_ON = 1600  # vertices whose rotations are computed; the others follow them
_RELAXATION = 20  # alternations between rotations and positions if part of the surface is held


class Articulation:
    """Interpolation of a surface from its pose to its form.

    Rotations of neighbouring vertices differ little, however far the whole limb rotates. So each *difference* is
    scaled, and the rotations are composed of the scaled differences: this is not limited to half a turn, and a limb
    unbends like a joint where linear interpolation of the two shapes would shrink it.

    `points` (n, 3); `faces` (m, 3); `form` (n, 3); `surface`: some of the vertices, whose rotations are computed
    while the others follow them; computed if omitted.

    References
    ----------
    Lipman, Sorkine, Levin and Cohen-Or, "Linear Rotation-Invariant Coordinates for Meshes", 2005,
    doi:10.1145/1073204.1073217 (rotations from their differences); Sumner, Schmid and Pauly, "Embedded Deformation for
    Shape Manipulation", 2007, doi:10.1145/1276377.1276478 (frames that carry detail).
    """

    def __init__(
        self,
        points: FloatArray,
        faces: IntArray,
        form: FloatArray,
        monitor: Monitor | None = None,
        *,
        surface: WorkingSurface | None = None,
    ) -> None:
        from scipy.sparse import triu

        self._monitor = monitor or Monitor()
        self._points, self._centre, self._unit = of_unit_area(points, faces)
        self._form = (form - self._centre) / self._unit
        self._areas = vertex_areas(self._points, faces)
        self._surface = surface or working_surface(self._points, faces, WORKED_ON, monitor=self._monitor)
        self._monitor.check()
        self._kept = self._surface.kept
        before, after = self._surface.points, self._form[self._kept]
        L, M = stiffness_and_mass(self._surface.triangulation)
        edges = triu(L, 1).tocoo()
        self._i, self._j, self._weight = edges.row, edges.col, np.maximum(-edges.data, 0.0)
        self._turned = ElasticBody(L, M, before, self._surface.faces).turns(after)  # x ↦ x R
        self._turns = _rotation_vectors(np.einsum("nji,njk->nik", self._turned[self._i], self._turned[self._j]))
        own = _rotation_vectors(self._turned)
        self._anchor = int(np.argmin((own**2).sum(axis=1)))  # the vertex that rotates least
        self._edge_before = before[self._j] - before[self._i]
        self._edge_after = np.einsum("ij,ikj->ik", after[self._j] - after[self._i], self._edge_turns(self._turned))
        whole_turn, shift = self._carried(self._turned, after)
        left = self._form - np.einsum("ij,ijk->ik", self._points, whole_turn) - shift
        self._left = np.einsum("ij,ikj->ik", left, nearest_rotations(whole_turn))  # of the form, rotated into the pose

    def at(self, amount: FloatArray | float, way: float = 1.0) -> FloatArray:
        """Interpolate all vertices between the pose and the form.

        `amount` (n,); `way`: factor on the amounts, 0 to 1: from the pose to the shape that the amounts describe;
        gives (n, 3).
        """
        everywhere = np.broadcast_to(np.asarray(amount, dtype=np.float64), len(self._points))
        complete = everywhere == 1
        everywhere = way * everywhere
        if (everywhere == 0).all() or (everywhere == 1).all():
            return (self._points if everywhere[0] == 0 else self._form) * self._unit + self._centre
        here = everywhere[self._kept]
        held = here == 0
        if (everywhere == 0).any() and not held.any():  # none of them is a working vertex
            here, held = here.copy(), here == here.min()
            here[held] = 0.0
        turned, placed = self._turned_and_placed(here, held, way * complete[self._kept])
        self._monitor.check()
        turn, shift = self._carried(turned, placed)
        share = everywhere[:, None]
        result = moved_by_frames(self._points, turn, shift)
        result += share * np.einsum("ij,ijk->ik", self._left, nearest_rotations(turn))
        if (everywhere == 0).any():
            still = everywhere == 0
            result[still] = self._points[still]
        else:
            shares = self._areas / self._areas.sum()
            result += shares @ (self._points + share * (self._form - self._points) - result)
        return result * self._unit + self._centre

    def _turned_and_placed(
        self, amount: FloatArray, held: np.ndarray, lengths: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Compute rotations and positions of the coarse vertices from those of their edges."""
        from scipy.sparse import coo_matrix, diags

        count = len(amount)
        pinned = held if held.any() else np.arange(count) == self._anchor
        share = (amount[self._i] + amount[self._j])[:, None] / 2
        turns = _rotation_matrices(share * self._turns)  # R_j = R_i D_ij
        ones = np.where(self._weight > 0, 1.0, 0.0)
        degree = np.bincount(self._i, ones, count) + np.bincount(self._j, ones, count)
        blocks = -ones[:, None, None] * turns
        row = np.repeat(3 * self._i[:, None] + [0, 1, 2], 3, axis=1).ravel()
        column = np.tile(3 * self._j[:, None] + [0, 1, 2], (1, 3)).ravel()
        upper = coo_matrix((blocks.ravel(), (row, column)), shape=(3 * count, 3 * count)).tocsr()
        diagonal = diags(np.repeat(degree, 3))
        start = np.zeros((count, 3, 3))  # of vertex i, the columns are the unknowns of rows 3i to 3i + 2
        start[pinned] = np.eye(3)
        if not held.any():
            start[pinned] = _rotation_matrices(amount[pinned, None] * _rotation_vectors(self._turned[pinned]))
        start = start.transpose(0, 2, 1).reshape(-1, 3)
        solved = _held_solver(diagonal + upper + upper.T, np.repeat(pinned, 3))(start, 0 * start)
        turned = nearest_rotations(solved.reshape(-1, 3, 3).transpose(0, 2, 1))
        self._monitor.check()
        if held.any():  # the band keeps the lengths of the pose
            share = np.minimum(lengths[self._i], lengths[self._j])[:, None]
        edge = self._edge_before + share * (self._edge_after - self._edge_before)
        weights = coo_matrix((self._weight, (self._i, self._j)), shape=(count, count)).tocsr()
        weights = weights + weights.T
        solve = _held_solver(diags(np.asarray(weights.sum(axis=1)).ravel()) - weights, pinned)
        placed = self._points[self._kept]
        for step in range(1 + (_RELAXATION if held.any() else 0)):
            if step:
                turned = nearest_rotations(self._covariances(edge, placed))
                turned[held] = np.eye(3)
            pull = self._weight[:, None] * np.einsum("ij,ijk->ik", edge, self._edge_turns(turned))
            placed = solve(placed, self._summed(pull, -pull))
            self._monitor.check()
        return turned, placed

    def _edge_turns(self, turned: FloatArray) -> FloatArray:
        """Compute the rotation of each edge as the mean of those of its ends."""
        return nearest_rotations(turned[self._i] + turned[self._j])

    def _covariances(self, edge: FloatArray, placed: FloatArray) -> FloatArray:
        outer = (self._weight[:, None] * edge)[:, :, None] * (placed[self._j] - placed[self._i])[:, None, :]
        outer = outer.reshape(-1, 9)
        return self._summed(outer, outer).reshape(-1, 3, 3)

    def _summed(self, to_second: FloatArray, to_first: FloatArray) -> FloatArray:
        """Sum the contributions of the edges to their ends."""
        count = len(self._kept)
        return np.column_stack(
            [
                np.bincount(self._j, second, count) + np.bincount(self._i, first, count)
                for second, first in zip(to_second.T, to_first.T, strict=True)
            ]
        )

    def _carried(self, turned: FloatArray, placed: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Interpolate the frames of the coarse vertices to all vertices."""
        shift = placed - np.einsum("ij,ijk->ik", self._points[self._kept], turned)
        return self._surface.prolong_frames(turned, shift)


def _held_solver(matrix: csr_matrix, held: np.ndarray) -> Callable[[FloatArray, FloatArray], FloatArray]:
    """Factor ``matrix x = force`` where some rows of x have given values."""
    matrix = matrix.tocsr()
    free = np.flatnonzero(~held)
    solve = factored(matrix[free][:, free]).solve

    def solved(values: FloatArray, force: FloatArray) -> FloatArray:
        result = np.where(held[:, None], values, 0.0)
        result[free] = solve(np.ascontiguousarray((force - matrix @ result)[free]))
        return result

    return solved


def _rotation_vectors(rotations: FloatArray) -> FloatArray:
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_matrix(rotations).as_rotvec())


def _rotation_matrices(vectors: FloatArray) -> FloatArray:
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_rotvec(vectors).as_matrix())
