"""The placement of a form: as posed, upright, or aligned to a reference, which also numbers its feature points."""

from __future__ import annotations

import numpy as np

from ..matching.laying import CLOSE, laid_by_limbs, laid_by_vertices
from ..measures.alignment import rigid_fit
from ..mesh.geometry import vertex_areas
from ..method_api.method_result import MethodResult
from ..method_api.settings import Settings
from ..method_api.surface_features import SurfaceFeatures
from ..numerics.arrays import FloatArray, IntArray
from ..run.errors import InvalidSettingsError
from ..run.monitor import Monitor
from ..symmetry.limb_names import limb_names
from ..symmetry.upright import upright_rotation
from .reference import ReferenceBody

_ROUNDED = 1e-4  # share of the size to which positions at the reference may be rounded
_UPSIDE_DOWN = -0.5  # cosine between the axes of form and file below which one of the two stands on its head
_UNLIKE = 0.3  # mismatch above which two bodies count as dissimilar


def in_place(
    embedded: MethodResult,
    found: SurfaceFeatures,
    settings: Settings,
    reference: ReferenceBody | None,
    monitor: Monitor,
) -> tuple[FloatArray, IntArray]:
    """Place and orient a form by a proper motion, in the unit of its input.

    `embedded`: the form, in any position; `found`: the surface of which it is the form; `settings`: whether
    it lies as posed, or upright; `reference`: the body to which it is aligned instead; gives form (n, 3), order (k,).
    """
    form = embedded.points
    areas = vertex_areas(found.whole_points, found.whole_faces)
    order = np.arange(len(found.features))
    if reference is not None:
        if reference.same_mesh:
            laying = laid_by_vertices(form, reference.points, areas, found.whole_features, reference.tips)
        else:
            tips = found.whole_features
            upright = (
                None
                if settings.orientation == "posed"
                else _upright(embedded, found, form, areas, settings.orientation)[0]
            )
            laying = laid_by_limbs(
                form, reference.points, tips, reference.tips, found.limbs, reference.limbs, upright=upright
            )
        if laying.mismatch > _UNLIKE:
            monitor.warn("reference_unlike")
        elif laying.rival < CLOSE:
            monitor.warn("reference_sides")
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
        rotation, posed, by_file = _upright(embedded, found, form, areas, settings.orientation)
        if by_file:
            monitor.warn("upright_by_file")
        elif rotation[:, 2] @ posed[:, 2] < _UPSIDE_DOWN:
            monitor.warn("upside_down")
        share = areas / areas.sum()
        shift = share @ found.whole_points - share @ form @ rotation
    return (form @ rotation + shift) * found.unit + found.centre, order


def names_in_form(embedded: MethodResult, found: SurfaceFeatures) -> list[str]:
    """Name the feature points; left and right by toes, too, on the form, where the surface itself hardly tells them.

    `embedded`: the form; `found`: the surface of which it is the form; gives k names, "" for none.
    """
    form = embedded.points
    areas = vertex_areas(found.whole_points, found.whole_faces)
    rotation, _, _ = _upright(embedded, found, form, areas, "upright")
    return limb_names(found.limbs, form[found.whole_features] @ rotation[:, 0])


def _upright(
    embedded: MethodResult, found: SurfaceFeatures, form: FloatArray, areas: FloatArray, stance: str
) -> tuple[FloatArray, FloatArray, bool]:
    """Find the rotations of a form to upright and to its pose, and whether the file had a say."""
    posed = rigid_fit(form, found.whole_points, areas)[0]
    own = form[found.surface.kept]
    rotation, by_file = upright_rotation(own, found.mass, found.limbs, embedded.partner, stance=stance, posed=posed)
    return rotation, posed, by_file
