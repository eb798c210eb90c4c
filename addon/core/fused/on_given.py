"""Results of a parted mesh on the mesh as given: a vertex takes the mean of its copies, or follows its neighbours."""

from __future__ import annotations

import numpy as np

from ..mesh.edges import vertex_pairs
from ..numerics.arrays import BoolArray, FloatArray, IntArray
from ..numerics.factoring import factored
from ..symmetry.limbs import BodyLimbs
from .parting import PartedMesh


def shape_on_given(mesh: PartedMesh, shape: FloatArray, count: int, faces: IntArray) -> FloatArray:
    """Carry positions to the vertices of the mesh as given; those of the triangles taken out span as a membrane.

    `shape` (n', 3): of the parted mesh; `count`: n; `faces` (m, 3): of the mesh as given; gives (n, 3).

    Examples
    --------
    >>> mesh = PartedMesh(np.eye(3), np.array([[0, 1, 2]]), np.array([0, 1, 1]), 0)
    >>> shape_on_given(mesh, np.diag([2.0, 4, 6]), 2, np.empty((0, 3), dtype=int)).tolist()
    [[2.0, 0.0, 0.0], [0.0, 2.0, 3.0]]
    """
    own = mesh.origin >= 0
    number = np.bincount(mesh.origin[own], minlength=count)
    total = np.column_stack([np.bincount(mesh.origin[own], shape[own, axis], count) for axis in range(3)])
    found = total / np.maximum(number, 1)[:, None]
    return _spanned(found, number == 0, faces)


def rows_on_given(mesh: PartedMesh, vertices: FloatArray, representative: IntArray) -> IntArray:
    """Return for each vertex as given the one of the parted mesh that it is, (n,): its first copy, or the nearest.

    `vertices` (n, 3): as given; `representative` (n,): of copies at one place the one that stands for them.
    """
    from scipy.spatial import cKDTree

    first = mesh.copies(len(vertices))
    lost = np.flatnonzero(first < 0)
    if len(lost):
        first[lost] = cKDTree(mesh.vertices).query(vertices[lost])[1]
    return first[representative]


def given_of(mesh: PartedMesh) -> IntArray:
    """Return the vertex of the given mesh that stands for each, (n',): itself, for those of caps the nearest one."""
    from scipy.spatial import cKDTree

    own = np.flatnonzero(mesh.origin >= 0)
    found = mesh.origin.copy()
    caps = mesh.origin < 0
    if caps.any():
        found[caps] = mesh.origin[own[cKDTree(mesh.vertices[own]).query(mesh.vertices[caps])[1]]]
    return found


def limbs_on_given(mesh: PartedMesh, bodies: list[BodyLimbs]) -> list[BodyLimbs]:
    """Carry the limbs of bodies to the vertices of the mesh as given."""
    given, found = given_of(mesh), []
    for body in bodies:
        vertices = np.unique(mesh.origin[body.vertices][mesh.origin[body.vertices] >= 0])
        tips = np.searchsorted(vertices, given[body.vertices[body.tips]])
        found.append(body._replace(vertices=vertices, tips=np.minimum(tips, len(vertices) - 1)))
    return found


def _spanned(shape: FloatArray, lost: BoolArray, faces: IntArray) -> FloatArray:
    """Span lost vertices between their neighbours, each in the mean of its own; those of no face stay."""
    from scipy.sparse import coo_matrix, diags

    used = np.zeros(len(shape), dtype=bool)
    used[faces.ravel()] = True
    inner = np.flatnonzero(lost & used)
    if len(inner) == 0:
        return shape
    pairs = vertex_pairs(faces)
    both = np.concatenate([pairs, pairs[:, ::-1]])
    size = (len(shape), len(shape))
    beside = coo_matrix((np.ones(len(both)), (both[:, 0], both[:, 1])), shape=size).tocsr()[inner]
    outer = np.setdiff1d(np.arange(len(shape)), inner)
    system = diags(np.asarray(beside.sum(axis=1)).ravel() + 1e-9) - beside[:, inner]
    spanned = shape.copy()
    spanned[inner] = factored(system.tocsc()).solve(beside[:, outer] @ shape[outer])
    return spanned
