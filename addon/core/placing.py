"""Where a form lies: as the pose does, upright, or on a reference; and how a reference numbers its feature points."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from .matching.laying import laid_by_limbs, laid_by_vertices
from .measures.alignment import rigid_fit
from .mesh.geometry import of_unit_area, surface_area, vertex_areas
from .method_api.method_result import MethodResult
from .method_api.settings import Settings
from .method_api.surface_features import SurfaceFeatures
from .numerics.arrays import FloatArray, IntArray
from .results import BodyLimbs, CanonicalForm
from .run.errors import InvalidSettingsError
from .run.monitor import Monitor
from .symmetry.limbs import Limbs
from .symmetry.upright import upright_rotation

_ROUNDED = 1e-4  # share of the size to which positions may be rounded where the reference lies
_UNLIKE = 0.3  # mismatch from which on two bodies count as unlike


class ReferenceBody(NamedTuple):
    """A body of a form that others are laid onto.

    Attributes
    ----------
    points : (p, 3) ndarray of float
        Its form, scaled to unit area.
    centre : (3,) ndarray of float
        Where its centre was, in the unit of the form.
    tips : (k,) ndarray of int
        Its feature points among its vertices, in the order of the mesh.
    limbs : Limbs
        What tells them apart.
    same_mesh : bool
        Whether the mesh that is laid onto it has the same triangles.
    """

    points: FloatArray
    centre: FloatArray
    tips: IntArray
    limbs: Limbs
    same_mesh: bool


def reference_bodies(
    reference: CanonicalForm, faces: IntArray, vertices: Sequence[IntArray], monitor: Monitor
) -> list[ReferenceBody | None]:
    """Take a form apart into the bodies that others are laid onto.

    Parameters
    ----------
    reference : CanonicalForm
        The form.
    faces : (m, 3) ndarray of int
        Triangles of the mesh that is laid onto it.
    vertices : sequence of (p,) ndarray of int
        Vertices of each body of that mesh. In the same mesh each is laid onto itself; otherwise the largest is laid
        onto the largest, and so on.
    monitor : Monitor
        Receives a warning where one has more bodies than the other.

    Returns
    -------
    list of ReferenceBody or None
        One for each body; None where there is none for it.

    Raises
    ------
    InvalidSettingsError
        If the form was made without feature points, so that nothing tells its limbs apart.

    Examples
    --------
    >>> from addon.core import canonical_form
    >>> corner = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> form = canonical_form(corner, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> [body.same_mesh for body in reference_bodies(form, form.faces, [np.arange(4)], Monitor())]
    [True]
    """
    if not reference.bodies:
        raise InvalidSettingsError("reference_without_limbs")
    count = len(vertices)
    if len(reference.bodies) != count:
        monitor.warn("reference_bodies", count=count, others=len(reference.bodies))
    same = np.array_equal(reference.faces, faces)
    wanted = [np.sort(each) for each in vertices]
    twins = [
        next((other for other in reference.bodies if same and np.array_equal(np.sort(other.vertices), own)), None)
        for own in wanted
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


def _reference_body(reference: CanonicalForm, body: BodyLimbs, vertices: IntArray, same_mesh: bool) -> ReferenceBody:
    """Take one body out of a form, its vertices in the order of those given."""
    number = np.full(len(reference.vertices), -1)
    number[vertices] = np.arange(len(vertices))
    own = number[reference.faces]
    points, centre, _ = of_unit_area(reference.vertices[vertices], own[(own >= 0).all(axis=1)])
    order = np.argsort(body.numbers, kind="stable")
    tips = number[body.vertices[body.tips[order]]]
    return ReferenceBody(points, centre, tips, body.limbs.sorted_by(order), same_mesh)


def in_place(
    embedded: MethodResult,
    found: SurfaceFeatures,
    settings: Settings,
    reference: ReferenceBody | None,
    monitor: Monitor,
) -> tuple[FloatArray, IntArray]:
    """Give a form the area of its input, a place and an orientation, by a proper motion.

    Parameters
    ----------
    embedded : MethodResult
        The form, of any size and in any place.
    found : SurfaceFeatures
        The surface that it is the form of.
    settings : Settings
        Whether it lies as posed, or upright.
    reference : ReferenceBody or None
        What it is laid onto instead.
    monitor : Monitor
        Receives a warning where the reference is a body of another kind.

    Returns
    -------
    form : (n, 3) ndarray of float
        The form in its place.
    order : (k,) ndarray of int
        Which feature point comes first, second, …: as in the reference, where there is one.

    Raises
    ------
    InvalidSettingsError
        If positions so far away as the reference are too coarse for a surface of this size.

    Examples
    --------
    >>> from addon.core.method_api.surface_features import detected
    >>> points = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    >>> found = detected(points, np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]), None, Settings(), Monitor())
    >>> turned = MethodResult(7 * points[:, [1, 2, 0]], np.zeros(1), 0)
    >>> np.allclose(in_place(turned, found, Settings(), None, Monitor())[0], points)
    True
    """
    form = embedded.points / np.sqrt(surface_area(embedded.points, found.whole_faces))
    areas = vertex_areas(found.whole_points, found.whole_faces)
    order = np.arange(len(found.features))
    if reference is not None:
        if reference.same_mesh:
            laying = laid_by_vertices(form, reference.points, areas, found.whole_features, reference.tips)
        else:
            tips = found.whole_features
            laying = laid_by_limbs(form, reference.points, tips, reference.tips, found.limbs, reference.limbs)
        if laying.mismatch > _UNLIKE:
            monitor.warn("reference_unlike")
        elif len(laying.image) != len(reference.tips) or (laying.image < 0).any():
            monitor.warn("reference_features", count=len(laying.image), others=len(reference.tips))
        if np.spacing(np.abs(reference.centre).max()) > _ROUNDED * found.unit:
            raise InvalidSettingsError("reference_far")
        if settings.feature_points is None:
            order = np.argsort(np.where(laying.image < 0, len(reference.tips), laying.image), kind="stable")
        return (form @ laying.rotation + laying.shift) * found.unit + reference.centre, order
    if settings.orientation == "posed":
        rotation, shift = rigid_fit(form, found.whole_points, areas)
    else:
        rotation = upright_rotation(
            form[found.surface.kept],
            found.mass,
            found.features,
            found.to_features,
            found.limbs,
            embedded.partner,
            settings.orientation,
        )
        share = areas / areas.sum()
        shift = share @ found.whole_points - share @ form @ rotation
    return (form @ rotation + shift) * found.unit + found.centre, order
