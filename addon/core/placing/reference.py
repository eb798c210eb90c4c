"""A form as a reference: split into the bodies to which others are aligned."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

from ..mesh.geometry import of_unit_area
from ..numerics.arrays import FloatArray, IntArray
from ..run.errors import InvalidSettingsError
from ..run.monitor import Monitor

if TYPE_CHECKING:
    from ..symmetry.limbs import BodyLimbs, Limbs


class Reference(Protocol):
    """The interface of a form to which others are aligned; every `CanonicalForm` has it."""

    @property
    def vertices(self) -> FloatArray:
        """Positions of all vertices, (n, 3)."""

    @property
    def faces(self) -> IntArray:
        """Triangles, (m, 3)."""

    @property
    def bodies(self) -> list[BodyLimbs]:
        """The limbs identified among the feature points of each body."""


class ReferenceBody(NamedTuple):
    """A body of a form to which others are aligned.

    Attributes
    ----------
    points : (p, 3) ndarray of float
        Its form, scaled to unit area.
    centre : (3,) ndarray of float
        Its centre, in the unit of the form.
    tips : (k,) ndarray of int
        Its feature points among its vertices, in the order of the mesh.
    limbs : Limbs
        The limbs identified among them.
    same_mesh : bool
        Whether the mesh that is aligned to it has the same triangles, except for a few that were repaired.
    """

    points: FloatArray
    centre: FloatArray
    tips: IntArray
    limbs: Limbs
    same_mesh: bool


def require_limbs(reference: Reference) -> None:
    """Require that a form has limbs by which others are aligned to it.

    Examples
    --------
    >>> from addon.core import canonical_form
    >>> require_limbs(canonical_form([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                              [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]))
    """
    if not reference.bodies:
        raise InvalidSettingsError("reference_without_limbs")


def reference_bodies(
    reference: Reference | None, faces: IntArray, vertices: Sequence[IntArray], monitor: Monitor
) -> list[ReferenceBody | None]:
    """Split a form into the bodies to which others are aligned.

    `reference`: the form; None where there is none; `faces` (m, 3); `vertices`: vertices of each body of that mesh.

    Examples
    --------
    >>> from addon.core import canonical_form
    >>> corner = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> form = canonical_form(corner, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> [body.same_mesh for body in reference_bodies(form, form.faces, [np.arange(4)], Monitor())]
    [True]
    """
    if reference is None:
        return [None] * len(vertices)
    count = len(vertices)
    if len(reference.bodies) != count:
        monitor.warn("reference_bodies", count=count, others=len(reference.bodies))
    same = _is_same_mesh(reference.faces, faces)
    known = [same and own.max() < len(reference.vertices) for own in vertices]  # vertices may have been added since
    twins = [
        next((other for other in reference.bodies if has and _is_twin(other, own)), None)
        for own, has in zip(vertices, known, strict=True)
    ]
    left = [other for other in reference.bodies if not any(other is twin for twin in twins)]
    alone = [rank for rank, twin in enumerate(twins) if twin is None]
    ranked = dict(zip(alone, left, strict=False))
    return [
        _reference_body(reference, twin, vertices[rank], True)
        if twin is not None
        else _reference_body(reference, ranked[rank], ranked[rank].vertices, False)
        if rank in ranked
        else None
        for rank, twin in enumerate(twins)
    ]


def _is_same_mesh(faces: IntArray, others: IntArray) -> bool:
    """Return whether most triangles are the same; repairs of a few may depend on the pose."""
    if faces.shape == others.shape and np.array_equal(faces, others):
        return True
    size = np.int64(max(faces.max(initial=0), others.max(initial=0))) + 1
    codes = [np.sort(each, axis=1).astype(np.int64) @ np.array([1, size, size**2]) for each in (faces, others)]
    return 2 * len(np.intersect1d(*codes)) > max(len(faces), len(others))


def _is_twin(body: BodyLimbs, vertices: IntArray) -> bool:
    """Return whether a body of a form has most of these vertices, and all its feature points among them."""
    common = np.intersect1d(body.vertices, vertices)
    most = 2 * len(common) > max(len(body.vertices), len(vertices))
    return most and bool(np.isin(body.vertices[body.tips], common).all())


def _reference_body(reference: Reference, body: BodyLimbs, vertices: IntArray, same_mesh: bool) -> ReferenceBody:
    """Extract one body of a form, with its vertices in the given order."""
    number = np.full(len(reference.vertices), -1)
    number[vertices] = np.arange(len(vertices))
    own = number[reference.faces]
    points, centre, _ = of_unit_area(reference.vertices[vertices], own[(own >= 0).all(axis=1)])
    order = np.argsort(body.numbers, kind="stable")
    tips = number[body.vertices[body.tips[order]]]
    return ReferenceBody(points, centre, tips, body.limbs.sorted_by(order), same_mesh)
