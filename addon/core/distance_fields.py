"""Entry points for distances from source vertices, each useful by itself: the figures of the paper's section 4."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from .assembly.bodies import Bodies, Chosen, bodies_of
from .assembly.body import Body
from .assembly.gathering import gathered
from .distances.costs import require_distance_memory
from .distances.edge_paths import edge_graph
from .distances.fast_marching import fast_marching
from .distances.heat import WHOLE, HeatMethod
from .distances.kinds import KINDS
from .distances.spectral import GreensFunction
from .mesh.geometry import of_unit_area
from .numerics.arrays import FloatArray, IntArray
from .run.errors import InvalidSettingsError
from .run.memory import require_pair_memory
from .run.monitor import Cancelled, Monitor, Plan, Progress, Warned
from .surface.delaunay import intrinsic_delaunay, refined
from .surface.laplacian import stiffness_and_mass
from .surface.triangulation import Triangulation, triangulated

_STAGES: Plan = {"Surface": 10, "Pieces": 90}
_BODY_STAGES: Plan = {"Coarse mesh": 20, "Triangulation": 5, "Distances": 75}
_WORKED_ON = 2000  # vertices between which biharmonic distance and commute time are computed, all pairs
_WHOLE = 30_000  # vertices up to which the heat method uses the surface as it is
_COARSE = 20_000  # vertices, besides the sources, to which it reduces a larger one
_ONE_BY_ONE = 16  # sources up to which the heat method treats each separately, which is more accurate
_OFF = 0.1  # of the largest distance: clamping by more than this is reported
_MOST_SOURCES = 1000  # for the spectral kinds: each stays in the coarse mesh


def distance_field(
    vertices: ArrayLike,
    faces: ArrayLike,
    sources: ArrayLike,
    kind: str = "heat",
    *,
    progress: Progress | None = None,
    cancelled: Cancelled | None = None,
    warned: Warned | None = None,
    memory_limit: float = 0.0,
) -> FloatArray:
    """Compute the distance of every vertex of a mesh from the nearest source vertex.

    Parameters
    ----------
    vertices : (n, 3) array_like of float
        Vertex positions, any unit of length.
    faces : (m, 3) array_like of int
        Triangles of one or several surfaces.
    sources : (s,) array_like of int
        Vertices to measure from.
    kind : {'heat', 'fast_marching', 'biharmonic', 'commute_time'}
        Geodesic distance by the heat method or by fast marching, biharmonic distance (equation 9) or commute time (the
        root of equation 8). The last two are computed on 2,000 vertices and interpolated to all; the heat method, above
        30,000 vertices, on 20,000.
    progress : callable, optional
        Called with the fraction done (0 to 1) and the name of the stage.
    cancelled : callable, optional
        The computation stops when it returns True; one factorisation, up to a second, is not interrupted.
    warned : callable, optional
        Called with the sentence of each warning; if omitted, Python warnings are issued.
    memory_limit : float
        Gigabytes that the computation may use; 0 for 60 % of the free memory.

    Returns
    -------
    (n,) ndarray of float
        Distances, in the unit of the vertices; commute time has no unit. inf where unreachable.

    Raises
    ------
    InvalidMeshError
        If the mesh cannot be used; the message says what to do.
    InvalidSettingsError
        If the kind is unknown, or the sources are not vertices or too many.
    TooLargeError
        If the surfaces with sources are too large for the memory limit.
    CancelledError
        If `cancelled` returned True.

    Examples
    --------
    >>> points = np.array([[x, y, 0.0] for y in range(5) for x in range(5)])
    >>> corners = [5 * y + x for y in range(4) for x in range(4)]
    >>> faces = np.array([[i, i + a, i + b] for i in corners for a, b in ((1, 6), (6, 5))])
    >>> distance_field(points, faces, [0], "fast_marching").round(6)[:5].tolist()
    [0.0, 1.0, 2.0, 3.0, 4.0]
    """
    if kind not in KINDS:
        raise InvalidSettingsError("unknown_kind", names=", ".join(KINDS), value=kind)
    monitor = Monitor(progress, cancelled, _STAGES)
    bodies, chosen = _measurable(vertices, faces, sources, kind, memory_limit, monitor)

    def work(body: Body, here: Chosen, own: Monitor) -> FloatArray:
        if not len(here.vertices):
            return np.full(len(body.vertices), np.inf)
        return _FIELDS[kind](body, np.unique(here.vertices), memory_limit, own)

    fields = bodies.map(work, monitor, _BODY_STAGES, chosen)
    field = gathered(bodies, fields, np.full(len(bodies.vertices), np.inf))
    field[np.unique(np.asarray(sources))] = 0.0
    monitor.deliver(warned)
    return field


def heat_geodesics(
    vertices: ArrayLike,
    faces: ArrayLike,
    sources: ArrayLike,
    *,
    warned: Warned | None = None,
    memory_limit: float = 0.0,
) -> FloatArray:
    """Compute the geodesic distances from each of several source vertices to all vertices by the heat method.

    Parameters
    ----------
    vertices : (n, 3) array_like of float
        Vertex positions.
    faces : (m, 3) array_like of int
        Triangles of one or several surfaces.
    sources : (s,) array_like of int
        Vertex indices to measure from.
    warned : callable, optional
        Called with the sentence of each warning; if omitted, Python warnings are issued.
    memory_limit : float
        Gigabytes that the computation may use; 0 for 60 % of the free memory.

    Returns
    -------
    (n, s) ndarray of float
        Distances in the unit of the vertices, one column per source; inf where unreachable.

    Raises
    ------
    InvalidMeshError
        If the mesh cannot be used; the message says what to do.
    InvalidSettingsError
        If the sources are not vertices of the mesh.
    TooLargeError
        If the surfaces with sources are too large for the memory limit.

    Examples
    --------
    >>> angles = 2 * np.pi * np.arange(5) / 5
    >>> points = [[0, 0, 0], *np.column_stack([np.cos(angles), np.sin(angles), 0 * angles])]
    >>> faces = [[0, 1 + i, 1 + (i + 1) % 5] for i in range(5)]
    >>> np.allclose(heat_geodesics(points, faces, [0])[1:, 0], 1, rtol=0.05)
    True
    """
    from scipy.sparse.csgraph import dijkstra
    from scipy.spatial.distance import cdist

    monitor = Monitor()
    bodies, chosen = _measurable(vertices, faces, sources, "heat", memory_limit, monitor)
    columns = np.atleast_1d(np.asarray(sources))

    def work(body: Body, here: Chosen, own: Monitor) -> FloatArray:
        each = np.full((len(body.vertices), len(columns)), np.inf)
        if len(here.vertices):
            points, _, unit = of_unit_area(body.points, body.faces)
            surface = _surface_of(body, points, own)
            heat, numbers, prolong = _heat_on(body, surface, points, here.vertices, memory_limit, own)
            found = prolong(heat.distances(numbers))
            longest = dijkstra(edge_graph(surface), directed=False, indices=here.vertices).T
            each[:, here.positions] = unit * _possible(found, cdist(points, points[here.vertices]), longest, own)
        return each

    distances = bodies.map(work, monitor, _BODY_STAGES, chosen)
    monitor.deliver(warned)
    result = gathered(bodies, distances, np.full((len(bodies.vertices), len(columns)), np.inf))
    result[columns, np.arange(len(columns))] = 0.0
    return result


def _measurable(
    vertices: ArrayLike,
    faces: ArrayLike,
    sources: ArrayLike,
    kind: str,
    memory_limit: float,
    monitor: Monitor,
) -> tuple[Bodies, list[Chosen]]:
    """Find the bodies and their sources, and reject what is too large before anything is computed."""
    with monitor.stage("Surface"):
        bodies = bodies_of(vertices, faces, monitor)
        monitor.extend(bodies.pieces.repairs)
        chosen = bodies.sources(sources)
        for body, here in zip(bodies.bodies, chosen, strict=True):
            if KINDS[kind].spectral and len(here.vertices) > _MOST_SOURCES:
                raise InvalidSettingsError("too_many_sources", most=_MOST_SOURCES, count=len(here.vertices))
            count = len(body.vertices)
            if len(here.vertices):
                held = len(_border(body, here.vertices))
                worked_on = count if count <= _WHOLE else min(count, _COARSE + held)
                require_distance_memory(count, kind, unknowns=_unknowns(worked_on), limit=memory_limit)
    return bodies, chosen


def _surface_of(body: Body, points: FloatArray, monitor: Monitor) -> Triangulation:
    """Triangulate the surface of a body as it is, with bridges between its parts."""
    if len(body.parts) > 1:
        return body.working_surface(points, body.faces, monitor=monitor).triangulation
    return triangulated(points, body.faces)


def _heat_on(
    body: Body,
    surface: Triangulation,
    points: FloatArray,
    chosen: IntArray,
    memory_limit: float,
    monitor: Monitor,
) -> tuple[HeatMethod, IntArray, Callable[[FloatArray], FloatArray]]:
    """Prepare the heat method on a surface or its coarse mesh: return it, the sources there and the interpolation."""
    if len(points) <= _WHOLE:
        fine = refined(intrinsic_delaunay(surface, monitor), WHOLE, monitor)
        return HeatMethod(fine, count=len(points), monitor=monitor), chosen, lambda field: field
    fixed = np.unique(chosen)
    coarse = body.working_surface(points, body.faces, _COARSE + len(fixed), fixed=fixed, monitor=monitor)
    if coarse.stuck:
        count = len(coarse.points)
        require_distance_memory(len(points), "heat", unknowns=_unknowns(count), limit=memory_limit)
        monitor.warn("coarse_mesh_stuck", count=count)
    # the split triangles of a coarse mesh give more accurate distances than the unsplit ones of the fine mesh
    fine = coarse.triangulation
    if len(coarse.points) <= _WHOLE:
        fine = refined(fine, WHOLE, monitor)
    heat = HeatMethod(fine, count=len(coarse.points), monitor=monitor)
    return heat, coarse.numbers_of(chosen), coarse.prolong


def _unknowns(count: int) -> int:
    """Count the unknowns of the heat method: the triangles of a small surface are split into four."""
    return 4 * count if count <= _WHOLE else count


def _heat_field(body: Body, chosen: IntArray, memory_limit: float, monitor: Monitor) -> FloatArray:
    from scipy.sparse.csgraph import dijkstra
    from scipy.spatial import cKDTree

    points, _, unit = of_unit_area(body.points, body.faces)
    surface = _surface_of(body, points, monitor)
    border = _border(body, chosen)
    heat, numbers, prolong = _heat_on(body, surface, points, border, memory_limit, monitor)
    with monitor.stage("Distances"):
        one_by_one = len(border) <= _ONE_BY_ONE
        field = prolong(heat.distances(numbers).min(axis=1) if one_by_one else heat.distance_to_set(numbers))
        field[chosen] = 0.0
        longest = dijkstra(edge_graph(surface), directed=False, indices=chosen, min_only=True)
        return unit * _possible(field, cKDTree(points[chosen]).query(points)[0], longest, monitor)


def _marched_field(body: Body, chosen: IntArray, memory_limit: float, monitor: Monitor) -> FloatArray:
    points, _, unit = of_unit_area(body.points, body.faces)
    surface = _surface_of(body, points, monitor)
    with monitor.stage("Distances"):
        return unit * fast_marching(surface, chosen, monitor)


def _border(body: Body, chosen: IntArray) -> IntArray:
    """Find the chosen vertices on the border of the chosen region; those inside affect no other vertex."""
    if len(body.parts) > 1:  # others may be reached over a bridge
        return chosen
    inside = np.zeros(len(body.vertices), dtype=bool)
    inside[chosen] = True
    mixed = body.faces[inside[body.faces].any(axis=1) & ~inside[body.faces].all(axis=1)]
    border = np.unique(mixed[inside[mixed]])
    return border if len(border) else chosen


def _possible(field: FloatArray, straight: FloatArray, longest: FloatArray, monitor: Monitor) -> FloatArray:
    """Clamp distances between the straight lines and the paths along edges; the heat method fails beside spikes."""
    held = np.clip(field, np.minimum(straight, longest), longest)
    off = ~(np.abs(held - field) <= _OFF * longest.max(axis=0))
    far = np.count_nonzero(off.reshape(len(off), -1).any(axis=1))
    if far:
        monitor.warn("heat_bounded", count=far)
    return np.where(np.isfinite(held), held, longest)


def _biharmonic_field(body: Body, chosen: IntArray, memory_limit: float, monitor: Monitor) -> FloatArray:
    def distances(green: GreensFunction, count: int, chosen: IntArray) -> FloatArray:
        return green.biharmonic_distances(np.arange(count))[:, chosen].min(axis=1)

    points, _, unit = of_unit_area(body.points, body.faces)
    return unit * _spectral_field(body, points, chosen, distances, memory_limit, monitor)


def _commute_time_field(body: Body, chosen: IntArray, memory_limit: float, monitor: Monitor) -> FloatArray:
    def distances(green: GreensFunction, count: int, chosen: IntArray) -> FloatArray:
        return np.sqrt(green.commute_time_squared(np.arange(count), monitor)[:, chosen].min(axis=1))

    points = of_unit_area(body.points, body.faces)[0]
    return _spectral_field(body, points, chosen, distances, memory_limit, monitor)  # a time: it has no unit of length


def _spectral_field(
    body: Body,
    points: FloatArray,
    chosen: IntArray,
    distances: Callable[[GreensFunction, int, IntArray], FloatArray],
    memory_limit: float,
    monitor: Monitor,
) -> FloatArray:
    """Compute exact distances from a Green's function on a coarse mesh and interpolate them to all vertices."""
    surface = body.working_surface(points, body.faces, _WORKED_ON, fixed=chosen, monitor=monitor)
    count = len(surface.points)
    if surface.stuck:
        require_pair_memory(len(points), [count], limit=memory_limit)
        monitor.warn("coarse_mesh_stuck", count=count)
    chosen = surface.numbers_of(chosen)
    with monitor.stage("Distances"):
        green = GreensFunction(*stiffness_and_mass(surface.triangulation))
        field = distances(green, count, chosen)
        monitor.check()
    return surface.prolong(field)


_FIELDS = {  # how each of `KINDS` is computed on a body, in the unit of the mesh
    "heat": _heat_field,
    "fast_marching": _marched_field,
    "biharmonic": _biharmonic_field,
    "commute_time": _commute_time_field,
}
