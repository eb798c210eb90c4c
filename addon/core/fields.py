"""Distance fields from chosen vertices, each useful by itself: the pictures of the paper's section 3.3."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .coarsening import coarsened
from .delaunay import intrinsic_delaunay
from .distances import GreensFunction
from .errors import InvalidSettingsError
from .fast_marching import fast_marching
from .heat import WHOLE, HeatMethod
from .laplacian import mass, stiffness
from .memory import require_field_memory
from .monitor import Cancelled, Monitor, Progress, Warned
from .parts import Part, connected_parts
from .surface import FloatArray, IntArray, surface_area, triangulated

KINDS = ("heat", "fast_marching", "biharmonic", "commute_time")
_WORKED_ON = 2000  # vertices between which biharmonic distance and commute time are computed, all pairs
_REFINED = 30_000  # vertices up to which the heat method splits the triangles for accuracy
_ONE_BY_ONE = 16  # sources that the heat method measures from one by one, which is more accurate
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
    monitor = Monitor(progress, cancelled)
    if kind not in KINDS:
        raise InvalidSettingsError(f"kind must be one of {', '.join(KINDS)}; got {kind!r}.")
    with monitor.stage("Surface", 0.1):
        parts = connected_parts(vertices, faces, monitor)
        monitor.warnings += parts.mended
        chosen = np.unique(np.asarray(sources))
        placed = parts.placed(chosen)
        for part, (_, starts) in zip(parts.parts, placed, strict=True):
            if len(starts):
                require_field_memory(_measured_on(len(part.vertices), kind), kind, memory_limit)
    fields = []
    for (part, own), (_, starts) in zip(parts.each(monitor), placed, strict=True):
        with own.stage("Distances", 1.0):
            fields.append(_field_of_part(part, np.unique(starts), kind, own))
    field = parts.together(fields, np.full(len(parts.vertices), np.inf))
    field[chosen] = 0.0
    monitor.hand_over(warned)
    return field


def _measured_on(count: int, kind: str) -> int:
    """Tell how many vertices the computation has to do with: refined ones are about four times as many."""
    return 4 * count if kind == "heat" and count <= _REFINED else count


def _field_of_part(part: Part, chosen: IntArray, kind: str, monitor: Monitor) -> FloatArray:
    if not len(chosen):
        return np.full(len(part.vertices), np.inf)
    unit = float(np.sqrt(surface_area(part.points, part.faces)))
    points, triangles = (part.points - part.points.mean(axis=0)) / unit, part.faces
    if kind == "heat":
        refine = len(points) <= _REFINED
        heat = HeatMethod(triangulated(points, triangles), refine=refine, monitor=monitor, fewest=WHOLE)
        if len(chosen) <= _ONE_BY_ONE:
            return unit * heat.distances(chosen).min(axis=1)
        return unit * heat.distance_to_set(chosen)
    if kind == "fast_marching":
        return unit * fast_marching(triangulated(points, triangles), chosen, monitor)
    field = _between_all(points, triangles, chosen, kind, monitor)
    return field * (unit if kind == "biharmonic" else 1.0)


def _between_all(points: FloatArray, triangles: IntArray, chosen: IntArray, kind: str, monitor: Monitor) -> FloatArray:
    """Compute exact biharmonic distances or commute times on a coarse mesh and carry them to all vertices."""
    if len(chosen) > _MOST_SOURCES:
        raise InvalidSettingsError(f"Select at most {_MOST_SOURCES:,} vertices to measure from; {len(chosen):,} are.")
    coarse = None
    if len(points) > _WORKED_ON:
        coarse = coarsened(points, triangles, _WORKED_ON, chosen, monitor)
        points, triangles, chosen = points[coarse.kept], coarse.faces, np.searchsorted(coarse.kept, chosen)
    surface = intrinsic_delaunay(triangulated(points, triangles), monitor)
    green = GreensFunction(stiffness(surface), mass(surface))
    everywhere = np.arange(len(points))
    if kind == "biharmonic":
        field = green.biharmonic_distances(everywhere)[:, chosen].min(axis=1)
    else:
        field = np.sqrt(green.commute_time_squared(everywhere, monitor)[:, chosen].min(axis=1))
    monitor.check()
    return field if coarse is None else coarse.carried_back(field)
