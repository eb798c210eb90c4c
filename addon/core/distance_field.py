"""Distance fields from chosen vertices, each useful by itself: the pictures of the paper's section 3.3."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .assembly.parts import Part, connected_parts
from .distances.edge_paths import edge_graph
from .distances.fast_marching import fast_marching
from .distances.heat import WHOLE, HeatMethod
from .distances.spectral import GreensFunction
from .mesh.coarsening import coarsened
from .mesh.geometry import of_unit_area
from .numerics.arrays import FloatArray, IntArray
from .run.errors import InvalidSettingsError
from .run.memory import require_field_memory, require_pair_memory
from .run.monitor import Cancelled, Monitor, Progress, Warned
from .surface.delaunay import intrinsic_delaunay
from .surface.laplacian import mass, stiffness
from .surface.triangulation import triangulated
from .unfolding.settings import Settings

KINDS = ("heat", "fast_marching", "biharmonic", "commute_time")
_WORKED_ON = 2000  # vertices between which biharmonic distance and commute time are computed, all pairs
_REFINED = 30_000  # vertices up to which the heat method splits the triangles for accuracy
_ONE_BY_ONE = 16  # sources that the heat method measures from one by one, which is more accurate
_OFF = 0.1  # of the largest distance: how far one may be held before it is told
_MOST_SOURCES = 1000  # of these kinds: each stays in the coarse mesh


def distance_field(
    vertices: ArrayLike,
    faces: ArrayLike,
    sources: ArrayLike,
    kind: str = "heat",
    progress: Progress | None = None,
    cancelled: Cancelled | None = None,
    warned: Warned | None = None,
    memory_limit: float = 0.0,
) -> FloatArray:
    """Measure how far every vertex of a mesh is from the nearest of some vertices.

    Parameters
    ----------
    vertices : (n, 3) array_like of float
        Vertex positions, any unit of length.
    faces : (m, 3) array_like of int
        Triangles of one or several surfaces.
    sources : (s,) array_like of int
        Vertices to measure from.
    kind : {'heat', 'fast_marching', 'biharmonic', 'commute_time'}
        Geodesic distance by the heat method or by fast marching, biharmonic distance (equation 9) or commute time
        (the root of equation 8). The last two are computed on 2,000 vertices and carried to all.
    progress : callable, optional
        Called with the fraction done (0 to 1) and the name of the stage.
    cancelled : callable, optional
        The computation stops when it returns True; one factorisation, a few seconds at 160,000 vertices, is not
        interrupted.
    warned : callable, optional
        Called with each warning, a sentence; without it they are Python's own.
    memory_limit : float
        Gigabytes that the computation may take; 0 for 60 % of the free memory.

    Returns
    -------
    (n,) ndarray of float
        Distances, in the unit of the vertices; commute time has no unit. inf where no way leads.

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
    """
    monitor, settings = Monitor(progress, cancelled), Settings(memory_limit=memory_limit)
    if kind not in KINDS:
        raise InvalidSettingsError(f"kind must be one of {', '.join(KINDS)}; got {kind!r}.")
    with monitor.stage("Surface", 0.1):
        parts = connected_parts(vertices, faces, monitor)
        monitor.warnings += parts.mended
        placed = parts.placed(sources)
        chosen = np.unique(np.asarray(sources))
        for part, (_, starts) in zip(parts.parts, placed, strict=True):
            if kind in ("biharmonic", "commute_time") and len(starts) > _MOST_SOURCES:
                raise InvalidSettingsError(
                    f"Select at most {_MOST_SOURCES:,} vertices to measure from; {len(starts):,} are."
                )
            if len(starts):
                require_field_memory(_measured_on(len(part.vertices), kind), kind, settings)
    fields = []
    for (part, own), (_, starts) in zip(parts.each(monitor), placed, strict=True):
        with own.stage("Distances", 1.0):
            fields.append(_field_of_part(part, np.unique(starts), kind, own, settings))
    field = parts.together(fields, np.full(len(parts.vertices), np.inf))
    field[chosen] = 0.0
    monitor.hand_over(warned)
    return field


def heat_geodesics(
    vertices: ArrayLike, faces: ArrayLike, sources: ArrayLike, warned: Warned | None = None, memory_limit: float = 0.0
) -> FloatArray:
    """Measure geodesic distances from some vertices of a mesh to all its vertices, one by one, by the heat method.

    Parameters
    ----------
    vertices : (n, 3) array_like of float
        Vertex positions.
    faces : (m, 3) array_like of int
        Triangles of one or several surfaces.
    sources : (s,) array_like of int
        Vertex indices to measure from.
    warned : callable, optional
        Called with each warning, a sentence; without it they are Python's own.
    memory_limit : float
        Gigabytes that the computation may take; 0 for 60 % of the free memory.

    Returns
    -------
    (n, s) ndarray of float
        Distances in the unit of the vertices, one column a source; inf where no way leads.

    Raises
    ------
    InvalidMeshError
        If the mesh cannot be used; the message says what to do.
    InvalidSettingsError
        If the sources are not vertices of the mesh.
    TooLargeError
        If the surfaces with sources are too large for the memory limit.
    """
    from scipy.sparse.csgraph import dijkstra
    from scipy.spatial.distance import cdist

    monitor, settings = Monitor(), Settings(memory_limit=memory_limit)
    parts = connected_parts(vertices, faces)
    monitor.warnings += parts.mended
    placed = parts.placed(sources)
    columns = np.atleast_1d(np.asarray(sources))
    for part, (here, _) in zip(parts.parts, placed, strict=True):
        if len(here):
            require_field_memory(4 * len(part.vertices), "heat", settings)
    distances = []
    for (part, own), (here, starts) in zip(parts.each(monitor), placed, strict=True):
        each = np.full((len(part.vertices), len(columns)), np.inf)
        if len(here):
            points, _, unit = of_unit_area(part.points, part.faces)
            surface = triangulated(points, part.faces)
            found = HeatMethod(surface, monitor=own, fewest=WHOLE).distances(starts)
            longest = dijkstra(edge_graph(surface), directed=False, indices=starts).T
            each[:, here] = unit * _possible(found, cdist(points, points[starts]), longest, own)
        distances.append(each)
    monitor.hand_over(warned)
    result = parts.together(distances, np.full((len(parts.vertices), len(columns)), np.inf))
    result[columns, np.arange(len(columns))] = 0.0
    return result


def _measured_on(count: int, kind: str) -> int:
    """Tell how many vertices the computation has to do with: refined ones are about four times as many."""
    return 4 * count if kind == "heat" and count <= _REFINED else count


def _field_of_part(part: Part, chosen: IntArray, kind: str, monitor: Monitor, settings: Settings) -> FloatArray:
    from scipy.sparse.csgraph import dijkstra
    from scipy.spatial import cKDTree

    if not len(chosen):
        return np.full(len(part.vertices), np.inf)
    points, _, unit = of_unit_area(part.points, part.faces)
    if kind in ("biharmonic", "commute_time"):
        field = _between_all(points, part.faces, chosen, kind, monitor, settings)
        return field * (unit if kind == "biharmonic" else 1.0)
    surface = triangulated(points, part.faces)
    if kind == "fast_marching":
        return unit * fast_marching(surface, chosen, monitor)
    heat = HeatMethod(surface, refine=len(points) <= _REFINED, monitor=monitor, fewest=WHOLE)
    one_by_one = len(chosen) <= _ONE_BY_ONE
    field = heat.distances(chosen).min(axis=1) if one_by_one else heat.distance_to_set(chosen)
    longest = dijkstra(edge_graph(surface), directed=False, indices=chosen, min_only=True)
    return unit * _possible(field, cKDTree(points[chosen]).query(points)[0], longest, monitor)


def _possible(field: FloatArray, straight: FloatArray, longest: FloatArray, monitor: Monitor) -> FloatArray:
    """Hold distances between the straight ones and the ways along edges, which heat misses beside spikes."""
    held = np.clip(field, np.minimum(straight, longest), longest)
    off = ~(np.abs(held - field) <= _OFF * longest.max(axis=0))
    far = np.count_nonzero(off.reshape(len(off), -1).any(axis=1))
    if far:
        which = "1 vertex" if far == 1 else f"{far:,} vertices"
        monitor.warn(
            f"Heat runs astray beside spikes: the distances of {which} were put between the straight way and that "
            "along edges. Compare fast marching, or smooth the spikes."
        )
    return np.where(np.isfinite(held), held, longest)


def _between_all(
    points: FloatArray, triangles: IntArray, chosen: IntArray, kind: str, monitor: Monitor, settings: Settings
) -> FloatArray:
    """Compute exact biharmonic distances or commute times on a coarse mesh and carry them to all vertices."""
    coarse = None
    if len(points) > _WORKED_ON:
        coarse = coarsened(points, triangles, _WORKED_ON, chosen, monitor)
        points, triangles, chosen = points[coarse.kept], coarse.faces, np.searchsorted(coarse.kept, chosen)
        if len(points) > 2 * _WORKED_ON:  # it would not get smaller
            require_pair_memory(len(coarse.kept), [len(points)], settings)
            monitor.warn(
                f"The mesh could only be reduced to {len(points):,} vertices, because of its many borders or edges of "
                "more than two faces; the distances took longer. Merge vertices by distance for faster ones."
            )
    surface = intrinsic_delaunay(triangulated(points, triangles), monitor)
    green = GreensFunction(stiffness(surface), mass(surface))
    everywhere = np.arange(len(points))
    if kind == "biharmonic":
        field = green.biharmonic_distances(everywhere)[:, chosen].min(axis=1)
    else:
        field = np.sqrt(green.commute_time_squared(everywhere, monitor)[:, chosen].min(axis=1))
    monitor.check()
    return field if coarse is None else coarse.carried_back(field)
