"""A body that stands up by its fitted skeleton: its elastic skin is pulled along, and it stays around its centre."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..deformation.elastic_body import ElasticBody
from ..deformation.struts import struts_through
from ..matching.unfolded import Unfolded
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
    motions = fitted_stance(rig, bones, surface.points, fit.weights, goal_turns(rig, pose))
    struts = struts_through(surface.points, surface.faces, own.limbs.to_features, monitor)
    body = ElasticBody(own.stiffness, own.mass, surface.points, surface.faces, struts)
    working = taken_pose(body, skinned(surface.points, fit.weights, motions), fit.trust(_LEAST))
    monitor.check()
    posed = working
    if surface.coarse:
        posed = moved_by_frames(own.whole_points, *surface.prolong_frames(*body.frames(working)))
    posed = untangled(own.whole_points, posed, own.whole_faces, monitor)
    areas = vertex_areas(own.whole_points, own.whole_faces)
    shift = areas / areas.sum() @ (own.whole_points - posed)
    starts, heads = (each * own.unit + own.centre for each in (motions.starts, motions.heads + shift))
    off = 0.0
    if rig.is_human and pose in ARMS_LOWERED:
        off = strayed(rig, working, own.mass, fit.weights, ARMS_LOWERED[pose])
    return Stood(np.asarray((posed + shift) * own.unit + own.centre), BoneMotions(starts, heads, motions.turns), off)
