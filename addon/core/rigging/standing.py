"""A body that stands up by its fitted skeleton: its elastic skin is pulled along, and it stays around its centre."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..deformation.elastic_body import ElasticBody
from ..deformation.struts import struts_through
from ..matching.unfolded import Unfolded
from ..measures.form_measures import median_distortion
from ..mesh.geometry import moved_by_frames, vertex_areas
from ..numerics.arrays import FloatArray
from ..posing.taken_pose import taken_pose
from ..posing.untangling import untangled
from ..run.monitor import Monitor
from .articulated_fit import Explained
from .bone_fit import BoneFit
from .evidence import strayed
from .fitted_stance import fitted_stance, goal_turns
from .reference_rig import ReferenceRig
from .skeleton import BoneMotions, skinned
from .stance import ARMS_LOWERED

_LEAST = 0.1  # least confidence of skin that follows the skeleton


class Stood(NamedTuple):
    """A body in another pose, in the unit and place of its mesh.

    Attributes
    ----------
    vertices : (n, 3) ndarray of float
        All its vertices.
    motions : BoneMotions
        How each bone has moved there.
    off : float
        By how many degrees a limb is off its way, where that is known: of a human in a T-pose or an A-pose.
    """

    vertices: FloatArray
    motions: BoneMotions
    off: float


def stood(one: Unfolded, rig: ReferenceRig, fit: Explained, bones: BoneFit, pose: str, monitor: Monitor) -> Stood:
    """Let a body follow its bones into a pose.

    `one`: the body; `rig`: the reference that lends its skeleton; `fit`: how that explains the body; `bones`: as they
    lie in it, in its own unit; `pose`: as `goal_turns` takes it.
    """
    own, surface = one.found, one.found.surface
    body, motions, working = _skin_along(one, rig, fit, bones, pose, monitor)
    posed = working
    if surface.coarse:
        posed = moved_by_frames(own.whole_points, *surface.prolong_frames(*body.frames(working)))
    posed = untangled(own.whole_points, posed, own.whole_faces, monitor)
    areas = vertex_areas(own.whole_points, own.whole_faces)
    shift = areas / areas.sum() @ (own.whole_points - posed)
    starts, heads = (each * own.unit + own.centre for each in (motions.starts, motions.heads + shift))
    off = _off(one, rig, fit, pose, working)
    return Stood(np.asarray((posed + shift) * own.unit + own.centre), BoneMotions(starts, heads, motions.turns), off)


def strained(one: Unfolded, rig: ReferenceRig, fit: Explained, monitor: Monitor) -> tuple[float, float]:
    """Measure on the working vertices what a T-pose would strain: the median change of edges, and `Stood.off`."""
    surface = one.found.surface
    _, _, working = _skin_along(one, rig, fit, fit.bones, "T", monitor)
    return median_distortion(surface.points, working, surface.faces), _off(one, rig, fit, "T", working)


def _skin_along(
    one: Unfolded, rig: ReferenceRig, fit: Explained, bones: BoneFit, pose: str, monitor: Monitor
) -> tuple[ElasticBody, BoneMotions, FloatArray]:
    """Pull the working vertices along with the bones: the elastic skin, how the bones move, where the vertices end."""
    own, surface = one.found, one.found.surface
    motions = fitted_stance(rig, bones, surface.points, fit.weights, goal_turns(rig, pose))
    struts = struts_through(surface.points, surface.faces, own.limbs.to_features, monitor)
    body = ElasticBody(own.stiffness, own.mass, surface.points, surface.faces, struts)
    working = taken_pose(body, skinned(surface.points, fit.weights, motions), fit.trust(_LEAST))
    monitor.check()
    return body, motions, working


def _off(one: Unfolded, rig: ReferenceRig, fit: Explained, pose: str, working: FloatArray) -> float:
    """Return by how many degrees a limb is off its way; 0 where that is not known."""
    if not rig.is_human or pose not in ARMS_LOWERED:
        return 0.0
    return strayed(rig, working, one.found.mass, fit.weights, ARMS_LOWERED[pose])
