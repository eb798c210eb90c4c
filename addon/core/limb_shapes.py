"""The form of some limbs only: the rest of the surface keeps its pose."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .assembly.parts import Part, connected_parts
from .mesh.geometry import of_unit_area, vertex_areas
from .numerics.arrays import FloatArray, IntArray
from .posing.articulation import Articulation
from .posing.limbs import limb_amounts
from .run.errors import InvalidMeshError, InvalidSettingsError
from .run.monitor import Monitor


def limb_shapes(
    points: FloatArray,
    faces: IntArray,
    form: FloatArray,
    chosen: np.ndarray,
    ways: Sequence[float] = (1.0,),
    monitor: Monitor | None = None,
) -> list[FloatArray]:
    """Take the pose out of some limbs, all the way and in between.

    Where the limbs have less than half of the area, all else stays where it is and they hang on it. Where they have
    more, they are where the form has them and the rest, in its pose, hangs on them: one arm that keeps its pose does
    not turn the body around.

    Parameters
    ----------
    points : (n, 3) ndarray of float
        Vertices of the pose.
    faces : (m, 3) ndarray of int
        Triangles of one or several surfaces; each is treated by itself.
    form : (n, 3) ndarray of float
        Vertices of the form, rigidly aligned to the pose.
    chosen : (n,) ndarray of bool
        The vertices of those limbs: whole patches.
    ways : sequence of float
        Parts of the way, 0 to 1.
    monitor : Monitor, optional
        Told the progress and asked whether to stop.

    Returns
    -------
    list of (n, 3) ndarray of float
        A shape for each part of the way.

    Raises
    ------
    InvalidMeshError, InvalidSettingsError
        If the mesh cannot be used, or the rest does not fit to it; the message says what to do.
    CancelledError
        If the monitor says so.
    """
    parts = connected_parts(points, faces)
    form, chosen, count = np.asarray(form, dtype=np.float64), np.asarray(chosen), len(parts.vertices)
    if form.shape != (count, 3) or not np.isfinite(form).all():
        raise InvalidMeshError(f"The form must be a ({count}, 3) array of numbers.")
    if chosen.shape != (count,) or chosen.dtype != bool:
        raise InvalidSettingsError(f"chosen must be an array of {count} times True or False.")
    if not all(0 <= way <= 1 for way in ways):
        raise InvalidSettingsError("ways must be from 0 to 1.")
    shapes = []
    for part, own in parts.each(monitor or Monitor()):
        here = part.vertices
        with own.stage("Limbs", 1.0):
            shapes.append(_shapes_of_part(part, form[here], chosen[here], ways, own))
    return [parts.together(each, parts.vertices) for each in zip(*shapes, strict=True)]


def _shapes_of_part(
    part: Part, form: FloatArray, chosen: np.ndarray, ways: Sequence[float], monitor: Monitor
) -> list[FloatArray]:
    points, faces = part.points, part.faces
    if not chosen.any():
        return [points for _ in ways]
    amounts = limb_amounts(points, faces, chosen)
    monitor.check()
    areas = vertex_areas(of_unit_area(points, faces)[0], faces)
    if not chosen.all() and areas[chosen].sum() > areas.sum() / 2:
        form = Articulation(form, faces, points, monitor).at(1.0 - amounts)
        amounts = np.ones(len(points))
    if all(way == 1 for way in ways) and (amounts == 1).all():
        return [form for _ in ways]
    path = Articulation(points, faces, form, monitor)
    shapes = []
    for number, way in enumerate(ways, start=1):
        shapes.append(path.at(amounts, way))
        monitor.tick(number / len(ways))
    return shapes
