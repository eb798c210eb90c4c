"""What the surface of a body explains: for each vertex its place on the mannequin, whose limbs are searched for."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..matching.unfolded import Unfolded
from ..mesh.geometry import vertex_areas, vertex_normals
from ..method_api.settings import Settings
from ..modelling.mannequins import mannequin
from ..numerics.arrays import FloatArray, IntArray
from ..rigging.articulated_fit import laid_on, nearest_of_posed
from ..rigging.bone_fit import BoneFit
from ..rigging.candidates import candidates
from ..rigging.limb_search import searched_limbs
from ..rigging.reference_rig import ReferenceRig, mannequin_rig
from ..rigging.references import Reference, unfolded_reference
from ..run.kept_stages import KeptStages
from ..run.monitor import Monitor
from .star_rest import star_rest

_EXPLAINED = 0.0085  # residual above which the legs are searched for, too: feet on each other are matched with one
_HOPELESS = 0.016  # residual by a match above which limbs need not be searched for: humans have up to .0126
_FOREIGN = 0.012  # residual above which the mannequin does not explain the body: humans have .006 to .009


class Explained(NamedTuple):
    """The skin of a body, explained by another.

    Attributes
    ----------
    places : (n, 3) ndarray of float
        The place of each vertex on that one, which lies so that nothing of it touches, of unit area.
    held : (n,) ndarray of int
        The part of that one which each belongs to.
    names : list of str
        Names of the parts.
    residual : float
        How far the skin lies from that one in the mean, in sizes of the body or sqrt(area).
    convinces : bool
        Whether it is such a body at all.
    """

    places: FloatArray
    held: IntArray
    names: list[str]
    residual: float
    convinces: bool


def explained_by_mannequin(one: Unfolded, settings: Settings, kept: KeptStages, monitor: Monitor) -> Explained:
    """Find for all vertices of a body their places on the mannequin, spread like a star, and the bones that hold them.

    The residual is in sizes of the body.

    `one`: the body; `settings`: of the mannequin's form; `kept`: results of earlier runs; `monitor`: with the stages
    "Ways to face" and "Limbs".
    """
    with monitor.stage("Ways to face"):
        figure = kept.take("Mannequin", [], lambda: mannequin_rig(*mannequin()), monitor.warnings)
        human: Reference = kept.take(
            "Mannequin unfolded", [figure, repr(settings)],
            lambda: unfolded_reference(figure, settings, Monitor(cancelled=monitor.is_cancelled)), monitor.warnings
        )  # fmt: skip
        best = candidates(one, human, lambda: [], monitor, fused=True)[0]
    names, own, whole = human.whole.skeleton.names, one.found, human.whole
    if best.residual > _HOPELESS:
        count = len(own.whole_points)
        return Explained(own.whole_points, np.zeros(count, dtype=np.int64), names, best.residual, False)
    bones, residual = _laid_limbs(one, human, best.fit.bones, monitor)
    normals = vertex_normals(own.whole_points, own.whole_faces)
    there = nearest_of_posed(whole, bones, own.whole_points, normals, monitor)
    held = there.on(whole.weights, whole.faces).argmax(axis=1)
    return Explained(there.on(star_rest(whole), whole.faces), held, names, residual, residual <= _FOREIGN)


def _laid_limbs(one: Unfolded, human: Reference, bones: BoneFit, monitor: Monitor) -> tuple[BoneFit, float]:
    """Lay the limbs of the mannequin by search; also how far the skin lies from it then, in sizes of the body."""
    surface = one.found.surface
    with monitor.stage("Limbs"):
        normals, areas = vertex_normals(surface.points, surface.faces), vertex_areas(surface.points, surface.faces)
        skin, residual, size = (surface.points, normals, areas), np.inf, float(np.ptp(surface.points, axis=0).max())
        for kind in ("arm", "leg"):
            if residual > _EXPLAINED:
                found = searched_limbs(human.rig, bones, kind, surface.points, surface.faces, areas, monitor)
                laid = laid_on(human.rig, bones if found is None else found, *skin, monitor)
                apart = residual_of(human.rig, laid, *skin, monitor) / size
                if apart < residual:
                    bones, residual = laid, apart
    return bones, residual


def residual_of(
    rig: ReferenceRig, bones: BoneFit, points: FloatArray, normals: FloatArray, areas: FloatArray, monitor: Monitor
) -> float:
    """Measure how far the skin of a body lies from that of a posed one in the mean.

    `rig`, `bones`: the posed one; `points` (n, 3), `normals` (n, 3), `areas` (n,): the body.
    """
    there = nearest_of_posed(rig, bones, points, normals, monitor)
    laid = bones.posed(rig, there.on(rig.vertices, rig.faces), there.on(rig.weights, rig.faces))
    return float(areas @ np.linalg.norm(laid - points, axis=1) / areas.sum())
