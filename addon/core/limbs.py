"""Entry point for the form of selected limbs: the rest of the surface keeps its pose."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .assembly.body import Body
from .assembly.gathering import shaped
from .assembly.opening import known_bodies
from .mesh.geometry import of_unit_area, vertex_areas
from .numerics.arrays import FloatArray, IntArray
from .posing.articulation import WORKED_ON, Articulation
from .posing.limb_amounts import limb_amounts
from .run.errors import InvalidMeshError, InvalidSettingsError
from .run.monitor import Monitor, Plan

_STAGES: Plan = {"Coarse mesh": 35, "Triangulation": 5, "Limbs": 60}


def limb_shapes(
    points: FloatArray,
    faces: IntArray,
    form: FloatArray,
    chosen: np.ndarray,
    *,
    ways: Sequence[float] = (1.0,),
    together: bool = True,
    rest: FloatArray | None = None,
    monitor: Monitor | None = None,
) -> list[FloatArray]:
    """Remove the pose from selected limbs, fully or in part.

    If the limbs have less than half of the area, the rest stays in place and they remain attached to it. If they have
    more, they lie as in the form and the rest, in its pose, is attached to them: one arm that keeps its pose does not
    turn the body around.

    Parameters
    ----------
    points : (n, 3) ndarray of float
        Vertices of the pose.
    faces : (m, 3) ndarray of int
        Triangles of one or several surfaces.
    form : (n, 3) ndarray of float
        Vertices of the form, rigidly aligned to the pose.
    chosen : (n,) ndarray of bool
        The vertices of these limbs: whole patches.
    ways : sequence of float
        Fractions of the way from pose to form, 0 to 1.
    together : bool
        Whether pieces that belong together are one body, as in the form; otherwise each is treated by itself.
    rest : (n, 3) ndarray of float, optional
        Positions in the rest pose of a rig, as in `canonical_form`.
    monitor : Monitor, optional
        Receives progress; polled for cancellation.

    Returns
    -------
    list of (n, 3) ndarray of float
        A shape for each fraction.

    Raises
    ------
    InvalidMeshError, InvalidSettingsError
        If the mesh cannot be used, or the other arguments do not fit it; the message says what to do.
    CancelledError
        If the run is cancelled.

    Examples
    --------
    >>> points = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    >>> faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
    >>> pose, form = limb_shapes(points, faces, 2 * points, np.full(4, True), ways=(0.0, 1.0))
    >>> np.allclose(pose, points), np.allclose(form, 2 * points)
    (True, True)
    """
    monitor = monitor or Monitor()
    bodies = known_bodies(points, faces, monitor, together=together, rest=rest)
    form, chosen, count = np.asarray(form, dtype=np.float64), np.asarray(chosen), len(bodies.vertices)
    if form.shape != (count, 3) or not np.isfinite(form).all():
        raise InvalidMeshError("form_shape", count=count)
    if chosen.shape != (count,) or chosen.dtype != bool:
        raise InvalidSettingsError("limb_mask", count=count)
    if not all(0 <= way <= 1 for way in ways):
        raise InvalidSettingsError("limb_ways")
    if chosen[np.asarray(faces)].all() and all(way == 1 for way in ways):
        return [form.copy() for _ in ways]  # with its riders, which would ride anew

    def work(body: Body, own: Monitor) -> list[FloatArray]:
        here = body.vertices
        return _shapes_of_body(body, form[here], chosen[here], ways, own)

    shapes = bodies.map(work, monitor, _STAGES)
    return [shaped(bodies, each, monitor) for each in zip(*shapes, strict=True)]


def _shapes_of_body(
    body: Body, form: FloatArray, chosen: np.ndarray, ways: Sequence[float], monitor: Monitor
) -> list[FloatArray]:
    points, faces = body.points, body.faces
    if not chosen.any():
        return [points for _ in ways]
    amounts = limb_amounts(points, faces, chosen)
    monitor.check()
    scaled = of_unit_area(points, faces)[0]
    areas = vertex_areas(scaled, faces)
    surface = monitor.kept(
        "coarse mesh",
        [points, faces, None, WORKED_ON, body.working_surface],
        lambda: body.working_surface(scaled, faces, WORKED_ON, monitor=monitor),
    )
    if not chosen.all() and areas[chosen].sum() > areas.sum() / 2:
        unfolded = surface.moved(of_unit_area(form, faces)[0], monitor)
        form = Articulation(form, faces, points, monitor, surface=unfolded).at(1.0 - amounts)
        amounts = np.ones(len(points))
    if all(way == 1 for way in ways) and (amounts == 1).all():
        return [form for _ in ways]
    path = Articulation(points, faces, form, monitor, surface=surface)
    shapes = []
    with monitor.stage("Limbs"):
        for number, way in enumerate(ways, start=1):
            shapes.append(path.at(amounts, way))
            monitor.tick(number / len(ways))
    return shapes
