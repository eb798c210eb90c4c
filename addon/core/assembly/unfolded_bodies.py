"""The bodies of a mesh, each unfolded: what a match and a search for contacts compare."""

from __future__ import annotations

from numpy.typing import ArrayLike

from ..matching.unfolded import Unfolded, unfolded
from ..method_api.catalogue import DETECTION, method_named
from ..method_api.settings import Settings
from ..numerics.arrays import FloatArray
from ..run.monitor import Monitor
from .bodies import Bodies
from .body import Body, Chosen
from .gathering import gathered
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

    def work(body: Body, chosen: Chosen | None, own: Monitor) -> Unfolded:
        found = body.features(chosen, settings, own)
        form = method.unfold(found, settings, own).of_unit_area(found.whole_faces)
        return unfolded(found, form.points, own)

    return bodies, bodies.map(work, monitor, {**DETECTION, **method.stages}, bodies.chosen)


def unfolded_shape(vertices: ArrayLike, faces: ArrayLike, settings: Settings, monitor: Monitor) -> FloatArray:
    """Unfold every body of a mesh around its own centre, each scaled to unit area.

    What belongs to no body keeps its place.

    `settings`, `monitor`: as in `unfolded_bodies`; gives (n, 3).

    Examples
    --------
    >>> tetrahedron = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> unfolded_shape(tetrahedron, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]], Settings(), Monitor()).shape
    (4, 3)
    """
    method = method_named(settings.method)
    bodies = opened(vertices, faces, settings, monitor)

    def work(body: Body, own: Monitor) -> FloatArray:
        return method.unfold(body.features(None, settings, own), settings, own).points

    forms = bodies.map(work, monitor, {**DETECTION, **method.stages})
    return gathered(bodies, forms, bodies.vertices.copy())
