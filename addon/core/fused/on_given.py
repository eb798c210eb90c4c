"""Results of a parted mesh on the mesh as given: a vertex takes the mean of its copies, or follows its neighbours."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, ClassVar, NamedTuple, Protocol, TypeVar, cast

import numpy as np

from ..mesh.connectivity import component_labels
from ..mesh.edges import vertex_pairs
from ..numerics.arrays import BoolArray, FloatArray, IntArray
from ..numerics.factoring import factored
from ..symmetry.limbs import BodyLimbs
from .parting import PartedMesh


class Given(NamedTuple):
    """A mesh as given.

    Attributes
    ----------
    vertices : (n, 3) ndarray of float
        Its vertices.
    faces : (m, 3) ndarray of int
        The triangles of those that stand for others.
    representative : (n,) ndarray of int
        The vertex that stands for each: itself, or of coincident ones the first.
    touched : (n,) ndarray of bool
        Whether each lies where the mesh was parted.
    """

    vertices: FloatArray
    faces: IntArray
    representative: IntArray
    touched: BoolArray


class Parted(NamedTuple):
    """What was computed on a mesh that was parted.

    Attributes
    ----------
    mesh : PartedMesh
        That mesh.
    result : CanonicalForm or PosedLike
        The result on it.
    representative : (n,) ndarray of int
        Of the mesh as given, the vertex that stands for each.
    """

    mesh: PartedMesh
    result: Any
    representative: IntArray

    def turned(self, turn: FloatArray) -> Parted:
        """Return mesh and result turned. `turn` (3, 3), for row vectors."""
        mesh = self.mesh._replace(vertices=self.mesh.vertices @ turn)
        return self._replace(mesh=mesh, result=replace(self.result, vertices=self.result.vertices @ turn))


class _Shaped(Protocol):
    """A result with vertices; the results of doors are dataclasses."""

    __dataclass_fields__: ClassVar[dict[str, Any]]

    @property
    def vertices(self) -> FloatArray: ...


class _OnSurface(_Shaped, Protocol):
    """A form or a pose."""

    @property
    def feature_points(self) -> IntArray: ...
    @property
    def patches(self) -> IntArray: ...
    @property
    def adf(self) -> FloatArray: ...


class _Limbed(_Shaped, Protocol):
    """A form."""

    @property
    def bodies(self) -> list[BodyLimbs]: ...
    @property
    def parted(self) -> Parted | None: ...


class _Points(Protocol):
    """A match."""

    __dataclass_fields__: ClassVar[dict[str, Any]]

    @property
    def vertices(self) -> IntArray: ...
    @property
    def faces(self) -> IntArray: ...
    @property
    def weights(self) -> FloatArray: ...
    @property
    def confidence(self) -> FloatArray: ...


class _Posed(_OnSurface, Protocol):
    """A pose by a match."""

    @property
    def match(self) -> Any: ...


class _Skinned(_Shaped, Protocol):
    """A rig."""

    @property
    def weights(self) -> FloatArray: ...
    @property
    def match(self) -> Any: ...


Surface = TypeVar("Surface", bound=_OnSurface)
Posed = TypeVar("Posed", bound=_Posed)
Skinned = TypeVar("Skinned", bound=_Skinned)
Form = TypeVar("Form", bound=_Limbed)
Points = TypeVar("Points", bound=_Points)


def shape_on_given(mesh: PartedMesh, shape: FloatArray, count: int, faces: IntArray) -> FloatArray:
    """Carry positions to the vertices of the mesh as given; those of the triangles taken out span as a membrane.

    `shape` (n', 3): of the parted mesh; `count`: n; `faces` (m, 3): of the mesh as given; gives (n, 3).

    Examples
    --------
    >>> mesh = PartedMesh(np.eye(3), np.array([[0, 1, 2]]), np.array([0, 1, 1]), 0, 1)
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


def surface_on_given(result: Surface, mesh: PartedMesh, given: Given) -> Surface:
    """Carry a form or a pose with its feature points and patches to the mesh as given."""
    return _surface_on_given(result, mesh, given, _rows(mesh, given))


def pose_on_given(result: Posed, mesh: PartedMesh, given: Given) -> Posed:
    """Carry a pose with its match to the mesh as given."""
    rows = _rows(mesh, given)
    return replace(_surface_on_given(result, mesh, given, rows), match=_match_on_given(result.match, rows))


def rig_on_given(result: Skinned, mesh: PartedMesh, given: Given) -> Skinned:
    """Carry a rig to the mesh as given."""
    rows, posed = _rows(mesh, given), _shape_of_all(mesh, result.vertices, given)
    return replace(result, vertices=posed, weights=result.weights[rows], match=_match_on_given(result.match, rows))


def match_on_given(result: Points, mesh: PartedMesh, given: Given) -> Points:
    """Carry a match to the mesh as given."""
    return _match_on_given(result, _rows(mesh, given))


def form_on_parted(form: Form, mesh: PartedMesh) -> Form:
    """Carry a form of the mesh as given to the parted one, so that another form of it is aligned to it.

    Gives that of the mesh as given, if a feature point lies in a contact.
    """
    if form.parted is not None and _same_parting(form.parted.mesh, mesh):
        return cast(Form, form.parted.result)  # on the mesh as given, both lips of a contact have one position
    given, first, bodies = given_of(mesh), mesh.copies(len(form.vertices)), []
    for body in form.bodies:
        vertices = np.flatnonzero(np.isin(given, body.vertices))
        tips = first[body.vertices[body.tips]]
        if (tips < 0).any():  # a tip lies inside of a contact
            return form
        bodies.append(body._replace(vertices=vertices, tips=np.searchsorted(vertices, tips)))
    return replace(form, vertices=form.vertices[given], faces=mesh.faces, bodies=bodies)


def _same_parting(one: PartedMesh, other: PartedMesh) -> bool:
    """Return whether two meshes were parted alike."""
    return np.array_equal(one.origin, other.origin) and np.array_equal(one.faces, other.faces)


def _rows(mesh: PartedMesh, given: Given) -> IntArray:
    """Return for each vertex as given the one of the parted mesh that it is, (n,)."""
    return rows_on_given(mesh, given.vertices, given.representative)


def _surface_on_given(result: Surface, mesh: PartedMesh, given: Given, rows: IntArray) -> Surface:
    """Carry a form or a pose to the mesh as given, whose vertices are some rows of it, (n,)."""
    held = np.zeros(len(given.vertices), dtype=bool)
    held[given.faces.ravel()] = True
    held = held[given.representative]
    return replace(
        result,
        vertices=_shape_of_all(mesh, result.vertices, given),
        faces=given.faces.copy(),
        feature_points=given_of(mesh)[result.feature_points],
        patches=np.where(held, result.patches[rows], -1),
        adf=np.where(held, result.adf[rows], 0.0),
        contacts=given.touched,
        parted=Parted(mesh, result, given.representative),
    )


def _match_on_given(result: Points, rows: IntArray) -> Points:
    """Carry a match to the mesh as given; borders that coincide in the other one stay as they are."""
    return replace(
        result,
        vertices=result.vertices[rows],
        faces=result.faces[rows],
        weights=result.weights[rows],
        confidence=result.confidence[rows],
        seams=None,
    )


def _shape_of_all(mesh: PartedMesh, shape: FloatArray, given: Given) -> FloatArray:
    """Carry positions to all vertices as given: copies at seams too, and what is of no face stays. `shape` (n', 3)."""
    whole, used = given.vertices.copy(), np.unique(given.faces)
    found = shape_on_given(mesh, shape, len(whole), given.faces)[used]
    whole[used] = np.where(np.isfinite(found), found, whole[used])  # of a speck that was left out nothing is known
    return whole[given.representative]


def _spanned(shape: FloatArray, lost: BoolArray, faces: IntArray) -> FloatArray:
    """Span lost vertices between their neighbours, each in the mean of its own; nan where none has a place."""
    from scipy.sparse import coo_matrix, diags

    used = np.zeros(len(shape), dtype=bool)
    used[faces.ravel()] = True
    inner = np.flatnonzero(lost & used)
    if len(inner) == 0:
        return shape
    pairs = vertex_pairs(faces)
    piece = component_labels(len(shape), pairs)
    placed = np.zeros(int(piece.max()) + 1, dtype=bool)
    placed[piece[~lost]] = True
    shape = np.where((lost & ~placed[piece])[:, None], np.nan, shape)
    inner = inner[placed[piece[inner]]]
    both = np.concatenate([pairs, pairs[:, ::-1]])
    size = (len(shape), len(shape))
    beside = coo_matrix((np.ones(len(both)), (both[:, 0], both[:, 1])), shape=size).tocsr()[inner]
    outer = np.setdiff1d(np.arange(len(shape)), inner)
    system = diags(np.asarray(beside.sum(axis=1)).ravel() + 1e-9) - beside[:, inner]
    spanned = shape.copy()
    spanned[inner] = factored(system.tocsc()).solve(beside[:, outer] @ shape[outer])
    return spanned
