"""The bodies of a mesh, each unfolded: what a match and a search for contacts compare."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..matching.unfolded import Unfolded, unfolded
from ..mesh.geometry import surface_area
from ..method_api.catalogue import DETECTION, method_named
from ..method_api.settings import Settings
from ..numerics.arrays import IntArray
from ..run.monitor import Monitor
from .bodies import Bodies
from .body import Body
from .opening import opened


def unfolded_bodies(
    vertices: ArrayLike, faces: ArrayLike, settings: Settings, monitor: Monitor, rest: ArrayLike | None = None
) -> tuple[Bodies, list[Unfolded]]:
    """Find the bodies of a mesh, and unfold each.

    `settings`: of the method, as it takes them; `monitor`: with the stages of `OPENING`; `rest` (n, 3): positions in
    the rest pose of a rig.
    """
    method = method_named(settings.method)
    bodies = opened(vertices, faces, settings, monitor, rest=rest)

    def work(body: Body, chosen: IntArray | None, own: Monitor) -> Unfolded:
        found = body.features(chosen, settings, own)
        form = method.unfold(found, settings, own).points
        return unfolded(found, form / np.sqrt(surface_area(form, found.whole_faces)), own)

    return bodies, bodies.map(work, monitor, {**DETECTION, **method.stages}, bodies.chosen_vertices)
