"""The form of some limbs only: the rest of the surface keeps its pose."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .articulation import Articulation
from .errors import InvalidMeshError, InvalidSettingsError
from .monitor import Monitor
from .parts import Part, connected_parts
from .surface import FloatArray, IntArray, of_unit_area, vertex_areas, vertex_pairs

_BAND = 0.15  # half the width of the band in which a limb's form passes into the pose, in sqrt(area)
_DEEPEST = 0.5  # of the way from the border of a limb to its tip: the most that the band may take


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


def limb_amounts(points: FloatArray, faces: IntArray, chosen: np.ndarray) -> FloatArray:
    """Say how far each vertex goes when the pose is taken out of some limbs only.

    Parameters
    ----------
    points : (n, 3) ndarray of float
        Vertices of the pose.
    faces : (m, 3) ndarray of int
        Triangles.
    chosen : (n,) ndarray of bool
        The vertices of those limbs: whole patches.

    Returns
    -------
    (n,) ndarray of float
        1 in the limbs and 0 outside, rising smoothly over a band along their borders, measured along edges.
    """
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components, dijkstra

    if chosen.all() or not chosen.any():
        return chosen.astype(np.float64)
    points = of_unit_area(points, faces)[0]
    pairs = vertex_pairs(faces)
    length = np.linalg.norm(points[pairs[:, 0]] - points[pairs[:, 1]], axis=1)
    graph = coo_matrix((length, (pairs[:, 0], pairs[:, 1])), shape=(len(points), len(points))).tocsr()
    border = pairs[chosen[pairs[:, 0]] != chosen[pairs[:, 1]]].ravel()

    def depth(side: np.ndarray) -> FloatArray:
        """Distance from the other side's vertices along the border."""
        sources = np.unique(border[~side[border]])
        return dijkstra(graph, directed=False, indices=sources, min_only=True)

    same = pairs[chosen[pairs[:, 0]] == chosen[pairs[:, 1]]]
    sides = coo_matrix((np.ones(len(same)), (same[:, 0], same[:, 1])), shape=graph.shape)
    # each limb, and each piece of the rest, has a band of its own
    part = connected_components(sides, directed=False)[1]
    distance = np.where(chosen, depth(chosen), depth(~chosen))
    deepest = np.zeros(int(part.max()) + 1)
    np.maximum.at(deepest, part, distance)
    half = np.minimum(_BAND, _DEEPEST * deepest[part])
    signed = np.where(chosen, distance, -distance) / half
    share = np.clip((1 + signed) / 2, 0.0, 1.0)
    return share * share * (3 - 2 * share)
