"""A rest pose in which nothing is near that is far apart on the skin: places by which fused skin is recognised."""

from __future__ import annotations

import numpy as np

from ..mesh.geometry import surface_area
from ..numerics.arrays import FloatArray
from ..rigging.fitted_stance import about_y
from ..rigging.reference_rig import ReferenceRig
from ..rigging.skeleton import BoneMotions, skinned

_SPREAD = np.radians(35.0)  # by which each leg is held out
_LEG = ("thigh", "shin", "foot", "toe")


def star_rest(rig: ReferenceRig) -> FloatArray:
    """Spread the legs of the mannequin, whose arms are held out already; scaled to unit area.

    `rig`: the mannequin in its T-pose; gives (n, 3).

    Examples
    --------
    >>> from addon.core import mannequin
    >>> from addon.core.rigging.reference_rig import mannequin_rig
    >>> rig = mannequin_rig(*mannequin())
    >>> places = star_rest(rig)
    >>> bool(np.ptp(places[:, 2]) < np.ptp(rig.vertices[:, 2]) / np.sqrt(surface_area(rig.vertices, rig.faces)))
    True
    """
    names, heads = rig.skeleton.names, rig.skeleton.heads
    turns, there = np.broadcast_to(np.eye(3), (len(names), 3, 3)).copy(), heads.copy()
    for side, sign in (("L", -1.0), ("R", 1.0)):
        turn, hip = about_y(sign * _SPREAD), heads[names.index(f"thigh.{side}")]
        for bone in (names.index(f"{name}.{side}") for name in _LEG):
            turns[bone], there[bone] = turn, hip + turn @ (heads[bone] - hip)
    spread = skinned(rig.vertices, rig.weights, BoneMotions(heads, there, turns))
    return np.asarray(spread / np.sqrt(surface_area(rig.vertices, rig.faces)))
