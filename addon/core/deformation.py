"""As-rigid-as-possible deformation of the input towards an embedding, which turns no limb inside out."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from .laplacian import factored, mass, stiffness
from .monitor import Monitor
from .surface import FloatArray, IntArray, Triangulation, signed_volume

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

_PRESSURE_STEPS = 3  # Newton steps of the pressure in each deformation step
_MOST_PRESSURE = 0.05  # farthest a vertex may be pushed in one step, in units of sqrt(area)
_POCKET = 40.0  # this many times the inverted share of the surroundings is not trusted
_LEAST_TRUST = 1e-3  # keeps the system regular
_NEAR = 0.0005  # diffusion time of the rotations that carry detail, as a share of the area
_SPREAD = 0.01  # diffusion time of the first rotations, as a share of the area: wide enough to see a limb as a body


def diffused_covariances(
    surface: Triangulation,
    before: FloatArray,
    after: FloatArray,
    trust: FloatArray | None = None,
    spread: float = _SPREAD,
) -> FloatArray:
    """Compare the surroundings of every vertex before and after, over an area as wide as a limb.

    Parameters
    ----------
    surface : Triangulation
        The surface, Delaunay.
    before, after : (n, 3) ndarray of float
        Positions of the vertices.
    trust : (n,) ndarray of float, optional
        Weight of each vertex; 1 when left out.
    spread : float
        Diffusion time, as a share of the area.

    Returns
    -------
    (n, 3, 3) ndarray of float
        Covariances of edge vectors, those before by row and those after by column, smoothed by the heat flow.
    """
    from scipy.sparse import diags

    L, M = stiffness(surface), mass(surface)
    local = _Edges(L, before).covariances(after).reshape(-1, 9)
    if trust is not None:
        local *= np.maximum(trust, _LEAST_TRUST)[:, None]
    return factored(diags(M) + spread * M.sum() * L).solve(local).reshape(-1, 3, 3)


def local_rotations(surface: Triangulation, before: FloatArray, after: FloatArray) -> FloatArray:
    """Find the rotation of the surroundings of every vertex: of the edges near it.

    One ring alone would not do: a few edges that lie almost in one plane have a second rotation that fits as well.

    Parameters
    ----------
    surface : Triangulation
        The surface, Delaunay.
    before, after : (n, 3) ndarray of float
        Positions of the vertices.

    Returns
    -------
    (n, 3, 3) ndarray of float
        Proper rotations, applied from the right: ``x ↦ x R``.
    """
    return _rotations(diffused_covariances(surface, before, after, spread=_NEAR))


def deformed_towards(
    surface: Triangulation,
    before: FloatArray,
    target: FloatArray,
    pull: float,
    steps: int,
    memory: float = 1.0,
    closed_faces: IntArray | None = None,
    monitor: Monitor | None = None,
    trust: FloatArray | None = None,
    done: float = 0.0,
    share: float = 1.0,
) -> FloatArray:
    """Deform a mesh as rigidly as possible while its vertices are pulled to given places.

    Parameters
    ----------
    surface : Triangulation
        The surface, Delaunay, so that no weight is negative.
    before : (n, 3) ndarray of float
        Positions of the undeformed vertices.
    target : (n, 3) ndarray of float
        Where the vertices are pulled to.
    pull : float
        Strength of the pull, in 1/area.
    steps : int
        Number of alternations between rotations and positions.
    memory : float
        Share of the energy that remembers how the surface was bent, 0 to 1. The rest asks for the lengths of the
        edges only, whichever way they point: creases of the pose may open.
    closed_faces : (m, 3) ndarray of int, optional
        Triangles of the mesh, if it is closed: the compactness ``V² / A³`` is then kept, by an even pressure.
    monitor : Monitor, optional
        Told the progress and asked whether to stop.
    trust : (n,) ndarray of float, optional
        How far the target is to be trusted, 0 to 1 by vertex; where it is not, there is no pull and full memory.
    done, share : float
        The fraction of the present stage that is done before, and that this call is worth.

    Returns
    -------
    (n, 3) ndarray of float
        The deformed vertices.

    Raises
    ------
    CancelledError
        If the monitor says so.

    References
    ----------
    Sorkine and Alexa, "As-Rigid-As-Possible Surface Modeling", 2007. The first rotations come from covariances
    diffused over the surface, so that a limb that the target squashes or turns inside out comes out right.
    """
    from scipy.sparse import diags

    monitor = monitor or Monitor()
    L, M = stiffness(surface), mass(surface)
    edges = _Edges(L, before)
    trust = np.ones(len(before)) if trust is None else trust
    anchor = pull * np.maximum(trust, _LEAST_TRUST) * M
    memory_at = edges.means(1 - (1 - memory) * trust)[:, None]
    solve = factored(L + diags(anchor)).solve
    monitor.check()
    positions, rotation = target, _rotations(diffused_covariances(surface, before, target, trust))
    for step in range(steps):
        force = edges.rotated(rotation, memory_at)
        if memory < 1:
            force += edges.with_lengths_kept(positions, 1 - memory_at)
        positions = solve(force + anchor[:, None] * target)
        if closed_faces is not None:
            positions = _under_pressure(positions, before, closed_faces, solve)
        monitor.tick(done + share * (step + 1) / steps)
        if step + 1 < steps:
            rotation = _rotations(edges.covariances(positions))
    return positions


def right_side_out(
    surface: Triangulation, before: FloatArray, after: FloatArray, faces: IntArray, spread: float
) -> FloatArray:
    """Tell where an embedding is right side out, seen against its wider surroundings.

    Parameters
    ----------
    surface : Triangulation
        The surface, Delaunay.
    before, after : (n, 3) ndarray of float
        Positions of the vertices.
    faces : (m, 3) ndarray of int
        Triangles of the mesh.
    spread : float
        How far around an inverted triangle it is told, as a diffusion time and share of the area.

    Returns
    -------
    (n,) ndarray of float
        1 where all is well, 0 in the middle of a pocket that is inside out.
    """
    from scipy.sparse import diags

    rotation = _rotations(diffused_covariances(surface, before, after))
    normals = []
    for positions in (before, after):
        a, b, c = positions[faces].transpose(1, 0, 2)
        normals.append(np.cross(b - a, c - a))
    turned = np.einsum("ij,ijk->ik", normals[0], rotation[faces[:, 0]])
    size = np.linalg.norm(turned, axis=1)
    with_it = np.einsum("ij,ij->i", turned, normals[1]) / np.maximum(size * np.linalg.norm(normals[1], axis=1), 1e-30)
    inverted = np.repeat(np.clip(-2 * with_it, 0.0, 1.0) * size / 6, 3)
    area = np.bincount(faces.ravel(), inverted, minlength=len(before))
    L, M = stiffness(surface), mass(surface)
    share = factored(diags(M) + spread * M.sum() * L).solve(area)
    return np.clip(1 - _POCKET * share, 0.0, 1.0)


class _Edges:
    """The edges of the undeformed mesh with their weights, and sums over the edges at each vertex."""

    def __init__(self, stiffness_matrix: csr_matrix, before: FloatArray) -> None:
        from scipy.sparse import csr_matrix, triu

        upper = triu(stiffness_matrix, 1).tocoo()
        self._i, self._j, weight = upper.row, upper.col, -upper.data
        count = len(weight)
        self._vectors = before[self._i] - before[self._j]  # (e, 3)
        self._weighted = weight[:, None] * self._vectors
        self._stretch = weight * np.linalg.norm(self._vectors, axis=1)
        ends = np.column_stack([self._i, self._j]).ravel()
        shape = (2 * count, len(before))
        start = np.arange(2 * count + 1)
        self._ends = csr_matrix((np.ones(2 * count), ends, start), shape=shape).T.tocsr()
        signs = np.tile([1.0, -1.0], count)
        self._signed = csr_matrix((signs, ends, start), shape=shape).T.tocsr()

    def covariances(self, after: FloatArray) -> FloatArray:
        moved = after[self._i] - after[self._j]
        outer = (self._weighted[:, :, None] * moved[:, None, :]).reshape(-1, 9)
        return (self._ends @ np.repeat(outer, 2, axis=0)).reshape(-1, 3, 3)

    def means(self, values: FloatArray) -> FloatArray:
        return np.asarray((values[self._i] + values[self._j]) / 2)

    def rotated(self, rotation: FloatArray, share: FloatArray) -> FloatArray:
        turned = np.einsum("ij,ijk->ik", share * self._weighted / 2, rotation[self._i] + rotation[self._j])
        return self._signed @ np.repeat(turned, 2, axis=0)

    def with_lengths_kept(self, positions: FloatArray, share: FloatArray) -> FloatArray:
        moved = positions[self._i] - positions[self._j]
        length = np.linalg.norm(moved, axis=1)
        length[length == 0] = 1.0
        return self._signed @ np.repeat(share * (self._stretch / length)[:, None] * moved, 2, axis=0)


def _under_pressure(
    positions: FloatArray, before: FloatArray, faces: IntArray, solve: Callable[[FloatArray], FloatArray]
) -> FloatArray:
    """Blow a closed mesh up, or let air out, until its compactness is that of the mesh before."""
    wanted = _signed_compactness(before, faces)
    corner = positions[faces]
    push = np.repeat(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]) / 6, 3, axis=0)
    count = len(positions)
    normals = np.zeros((count, 3))
    for axis in range(3):
        normals[:, axis] = np.bincount(faces.ravel(), push[:, axis], minlength=count)
    way = solve(normals)
    way *= np.sqrt(_area(before, faces) / (way**2).sum(axis=1).max())  # an amount of 1 moves by sqrt(area)
    side = np.sign(wanted)  # -1 where the triangles face inwards
    way, wanted, amount, step = side * way, abs(wanted), 0.0, 1e-4
    for _ in range(_PRESSURE_STEPS):
        here = side * _signed_compactness(positions + amount * way, faces) - wanted
        slope = (side * _signed_compactness(positions + (amount + step) * way, faces) - wanted - here) / step
        if not slope > 0:  # the mesh has no inside to speak of
            return positions
        amount = float(np.clip(amount - here / slope, -_MOST_PRESSURE, _MOST_PRESSURE))
    return positions + amount * way


def _signed_compactness(positions: FloatArray, faces: IntArray) -> float:
    """Divide the volume by the area to the power 3/2: the root of the compactness, with the volume's sign."""
    return signed_volume(positions, faces) / _area(positions, faces) ** 1.5


def _area(positions: FloatArray, faces: IntArray) -> float:
    a, b, c = positions[faces].transpose(1, 0, 2)
    return float(np.sqrt((np.cross(b - a, c - a) ** 2).sum(axis=1)).sum() / 2)


def _rotations(covariances: FloatArray) -> FloatArray:
    """Find the proper rotation nearest to each covariance; it is applied from the right, ``x ↦ x R``."""
    left, _, right = np.linalg.svd(covariances)
    left[:, :, -1] *= np.sign(np.linalg.det(left @ right))[:, None]
    return left @ right
