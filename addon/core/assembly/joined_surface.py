"""The working surface of a body: all parts coarsened, with bridges between them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..mesh.coarsening import coarsened
from ..numerics.arrays import FloatArray, IntArray
from ..run.monitor import Monitor
from ..surface.delaunay import intrinsic_delaunay
from ..surface.triangulation import triangulated
from ..surface.working_surface import STUCK, WORTH_IT, WorkingSurface
from .bridges import bridges_between
from .contacts import Samples


def joined_surface(
    points: FloatArray,
    faces: IntArray,
    parts: Sequence[tuple[slice, slice, Samples]],
    target: int | None = None,
    *,
    fixed: IntArray | None = None,
    rest: FloatArray | None = None,
    monitor: Monitor,
) -> WorkingSurface:
    """Reduce the parts of a body to about `target` vertices in total, and bridge them at their joints.

    `points` (n, 3); `faces` (m, 3); `parts`: the vertices, the triangles and samples of each part; the samples'
    corners index the vertices of the part; `target`: number of working vertices; all if omitted; `fixed` (k,);
    `rest` (n, 3): positions in which the parts are bridged, if not in these.

    Examples
    --------
    >>> from addon.core.assembly.contacts import sampled
    >>> corners, face = np.array([[0.0, 0, 0], [0.7, 0, 0], [0, 0.7, 0]]), np.array([[0, 1, 2]])
    >>> points, faces = np.concatenate([corners, corners + [0, 0, 0.01]]), np.concatenate([face, face + 3])
    >>> parts = [(slice(3 * i, 3 * i + 3), slice(i, i + 1), sampled(points[:3], face, 0.1)) for i in (0, 1)]
    >>> surface = joined_surface(points, faces, parts, monitor=Monitor())
    >>> len(surface.faces), len(surface.bridges)
    (8, 6)
    """
    coarsening, kept, corners = None, np.arange(len(points)), faces
    if target is not None and len(points) > WORTH_IT * target:
        with monitor.stage("Coarse mesh"):
            coarsening = coarsened(points, faces, target, fixed=fixed, monitor=monitor)
            kept, corners = coarsening.kept, coarsening.faces
    part = np.searchsorted([vertices.stop for vertices, _, _ in parts], kept, side="right")
    with monitor.stage("Triangulation"):
        places = points if rest is None else rest
        surfaces = [samples.on(places[vertices]) for vertices, _, samples in parts]
        bridges = bridges_between(places[kept], corners, part, surfaces)
        joined = np.concatenate([corners, bridges])
        triangulation = intrinsic_delaunay(triangulated(points[kept], joined), monitor)
    stuck = target is not None and len(kept) > STUCK * target
    return WorkingSurface(points[kept], joined, kept, triangulation, stuck, coarsening, bridges)
