"""What the surface of a body explains: for each vertex its place on the mannequin, whose limbs are searched for."""

from __future__ import annotations

import numpy as np

from ..matching.unfolded import Unfolded
from ..mesh.geometry import vertex_areas, vertex_normals
from ..numerics.arrays import FloatArray, IntArray
from ..rigging.articulated_fit import laid_on, nearest_of_posed
from ..rigging.bone_fit import BoneFit
from ..rigging.limb_search import searched_limbs
from ..rigging.reference_rig import ReferenceRig
from ..rigging.references import Reference
from ..run.monitor import Monitor
from .star_rest import star_rest

_EXPLAINED = 0.0085  # residual above which the legs are searched for, too: feet on each other are matched with one


def explained_skin(
    one: Unfolded, lender: Reference, bones: BoneFit, monitor: Monitor
) -> tuple[FloatArray, IntArray, float]:
    """Find for all vertices of a body their places in the star-shaped rest, (n, 3), and the bones that hold them, (n,).

    Also how far the skin lies from that of the mannequin in the mean, in sizes of the body.

    `one`: the body; `lender`: the mannequin; `bones`: its skeleton in the body, by a match; `monitor`: with the stage
    "Limbs".
    """
    own, surface = one.found, one.found.surface
    with monitor.stage("Limbs"):
        normals, areas = vertex_normals(surface.points, surface.faces), vertex_areas(surface.points, surface.faces)
        skin, residual = (surface.points, normals, areas), np.inf
        for kind in ("arm", "leg"):
            if residual > _EXPLAINED:
                found = searched_limbs(lender.rig, bones, kind, surface.points, surface.faces, areas, monitor)
                laid = laid_on(lender.rig, bones if found is None else found, *skin, monitor)
                apart = _residual(lender.rig, laid, *skin, monitor)
                if apart < residual:
                    bones, residual = laid, apart
    normals, whole = vertex_normals(own.whole_points, own.whole_faces), lender.whole
    there = nearest_of_posed(whole, bones, own.whole_points, normals, monitor)
    held = there.on(whole.weights, whole.faces).argmax(axis=1)
    return there.on(star_rest(whole), whole.faces), held, residual


def _residual(
    rig: ReferenceRig, bones: BoneFit, points: FloatArray, normals: FloatArray, areas: FloatArray, monitor: Monitor
) -> float:
    """Measure how far the skin lies from that of the posed mannequin in the mean, in sizes of the body."""
    there = nearest_of_posed(rig, bones, points, normals, monitor)
    laid = bones.posed(rig, there.on(rig.vertices, rig.faces), there.on(rig.weights, rig.faces))
    apart = np.linalg.norm(laid - points, axis=1)
    return float(areas @ apart / areas.sum() / np.ptp(points, axis=0).max())
