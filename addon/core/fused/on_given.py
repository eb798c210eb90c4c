"""Results of a parted mesh on the mesh as given: a vertex takes the mean of its copies, or follows its neighbours."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from ..mesh.edges import vertex_pairs
from ..numerics.arrays import BoolArray, FloatArray, IntArray
from ..numerics.factoring import factored
from ..symmetry.limbs import BodyLimbs
from .parting import PartedMesh

if TYPE_CHECKING:
    from ..results import CanonicalForm, Contacts, Match, PosedLike, Rigged

Result = TypeVar("Result", "CanonicalForm", "PosedLike")


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


def rows_on_given(mesh: PartedMesh, found: Contacts) -> IntArray:
    """Return for each vertex as given the one of the parted mesh that it is, (n,): its first copy, or the nearest."""
    from scipy.spatial import cKDTree

    first = np.full(len(found.vertices), -1)
    own = np.flatnonzero(mesh.origin >= 0)[::-1]
    first[mesh.origin[own]] = own
    lost = np.flatnonzero(first < 0)
    if len(lost):
        first[lost] = cKDTree(mesh.vertices).query(found.vertices[lost])[1]
    return first[found.representative]


def shape_of_all(mesh: PartedMesh, shape: FloatArray, found: Contacts) -> FloatArray:
    """Carry positions as `shape_on_given` does to all vertices: copies at seams too, and what is of no face stays."""
    whole, used = found.vertices.copy(), np.unique(found.faces)
    whole[used] = shape_on_given(mesh, shape, len(whole), found.faces)[used]
    return whole[found.representative]


def surface_on_given(result: Result, mesh: PartedMesh, found: Contacts) -> Result:
    """Carry a form or a pose with its feature points and patches to the mesh as given."""
    rows = rows_on_given(mesh, found)
    held = np.zeros(len(found.vertices), dtype=bool)
    held[found.faces.ravel()] = True
    held = held[found.representative]
    return replace(
        result,
        vertices=shape_of_all(mesh, result.vertices, found),
        faces=found.faces.copy(),
        feature_points=given_of(mesh)[result.feature_points],
        patches=np.where(held, result.patches[rows], -1),
        adf=np.where(held, result.adf[rows], 0.0),
    )


def match_on_given(result: Match, mesh: PartedMesh, found: Contacts) -> Match:
    """Carry a match to the mesh as given; borders that coincide in the other one stay as they are."""
    rows = rows_on_given(mesh, found)
    return replace(
        result,
        vertices=result.vertices[rows],
        faces=result.faces[rows],
        weights=result.weights[rows],
        confidence=result.confidence[rows],
        seams=None,
    )


def pose_on_given(result: PosedLike, mesh: PartedMesh, found: Contacts) -> PosedLike:
    """Carry a pose with its match to the mesh as given."""
    return replace(surface_on_given(result, mesh, found), match=match_on_given(result.match, mesh, found))


def rig_on_given(result: Rigged, mesh: PartedMesh, found: Contacts) -> Rigged:
    """Carry a rig to the mesh as given."""
    return replace(
        result,
        vertices=shape_of_all(mesh, result.vertices, found),
        weights=result.weights[rows_on_given(mesh, found)],
        match=match_on_given(result.match, mesh, found),
    )


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


def form_on_parted(mesh: PartedMesh, form: CanonicalForm) -> CanonicalForm:
    """Carry a form of the mesh as given to the parted one, so that another form of it is aligned to it."""
    given, first = given_of(mesh), np.full(int(mesh.origin.max()) + 1, -1)
    own = np.flatnonzero(mesh.origin >= 0)[::-1]
    first[mesh.origin[own]] = own
    bodies = []
    for body in form.bodies:
        vertices = np.flatnonzero(np.isin(given, body.vertices))
        there = body.vertices[body.tips]
        tips = np.where(there < len(first), first[np.minimum(there, len(first) - 1)], -1)
        if (tips < 0).any():  # a tip lies inside of a contact
            return form
        bodies.append(body._replace(vertices=vertices, tips=np.searchsorted(vertices, tips)))
    return replace(form, vertices=form.vertices[given], faces=mesh.faces, bodies=bodies)


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
