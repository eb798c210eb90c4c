"""The working surface of a body: each part made coarse by itself, with bridges between them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..mesh.coarsening import Coarsening, coarsened
from ..mesh.geometry import component_areas
from ..numerics.arrays import FloatArray, IntArray
from ..run.monitor import Monitor
from ..surface.delaunay import intrinsic_delaunay
from ..surface.triangulation import triangulated
from ..surface.working_surface import STUCK, WORTH_IT, WorkingSurface
from .bridges import bridges_between
from .contacts import Samples

_FEWEST = 12  # vertices of a part


def joined_surface(
    points: FloatArray,
    faces: IntArray,
    parts: Sequence[tuple[slice, slice, Samples]],
    target: int | None = None,
    *,
    fixed: IntArray | None = None,
    monitor: Monitor,
) -> WorkingSurface:
    """Reduce the parts of a body to about `target` vertices together, and bridge them where they hold each other.

    Parameters
    ----------
    points : (n, 3) ndarray of float
        Vertices of all parts, of unit area.
    faces : (m, 3) ndarray of int
        Triangles.
    parts : sequence of (slice, slice, Samples)
        The vertices, the triangles and samples of each part; the samples' corners count within the part.
    target : int, optional
        Number of vertices to work on; all when left out.
    fixed : (k,) ndarray of int, optional
        Vertices that are kept.
    monitor : Monitor
        Receives progress and warnings (stages *Coarse mesh* and *Triangulation*); polled for cancellation.

    Returns
    -------
    WorkingSurface
        One connected surface; its bridges lie on other triangles' edges.

    Raises
    ------
    CancelledError
        If the run is cancelled.

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
    area, size = component_areas(points, faces, np.array([own.start for _, own, _ in parts]))
    area = area * size**2
    shares = area / area.sum()
    with monitor.stage("Coarse mesh"):
        each = []
        done = 0.0
        for (vertices, own, _), share in zip(parts, shares.tolist(), strict=True):
            wanted = None if target is None else max(_FEWEST, round(target * share))
            stay = None if fixed is None else _within(fixed, vertices)
            each.append(_coarse(points[vertices], faces[own] - vertices.start, wanted, stay, monitor))
            done += share
            monitor.tick(done)
    coarsening = _together(each, [vertices.start for vertices, _, _ in parts], len(points))
    kept = coarsening.kept
    part = np.searchsorted([vertices.stop for vertices, _, _ in parts], kept, side="right")
    with monitor.stage("Triangulation"):
        surfaces = [samples.on(points[vertices]) for vertices, _, samples in parts]
        bridges = bridges_between(points[kept], coarsening.faces, part, surfaces)
        joined = np.concatenate([coarsening.faces, bridges])
        triangulation = intrinsic_delaunay(triangulated(points[kept], joined), monitor)
    stuck = target is not None and len(kept) > STUCK * target
    whole = coarsening if len(kept) < len(points) else None
    return WorkingSurface(points[kept], joined, kept, triangulation, stuck, whole, bridges)


def _within(fixed: IntArray, vertices: slice) -> IntArray:
    """Take those vertices that lie in a part, numbered there."""
    return fixed[(fixed >= vertices.start) & (fixed < vertices.stop)] - vertices.start


def _coarse(
    points: FloatArray, faces: IntArray, target: int | None, fixed: IntArray | None, monitor: Monitor
) -> Coarsening:
    """Make one part coarse, where it is worth it."""
    if target is None or len(points) <= WORTH_IT * target:
        return Coarsening(len(points), np.arange(len(points)), faces, [])
    return coarsened(points, faces, target, fixed=fixed, monitor=Monitor(cancelled=monitor.is_cancelled))


def _together(each: list[Coarsening], starts: list[int], count: int) -> Coarsening:
    """Put coarse meshes of parts side by side."""
    from scipy.sparse import csr_matrix

    kept = [start + part.kept for start, part in zip(starts, each, strict=True)]
    first = np.cumsum([0, *(len(own) for own in kept)])
    faces = [part.faces + begin for part, begin in zip(each, first[:-1], strict=True)]
    rounds = [
        (removed + start, csr_matrix((weights.data, weights.indices + start, weights.indptr), (len(removed), count)))
        for start, part in zip(starts, each, strict=True)
        for removed, weights in part.rounds
    ]
    return Coarsening(count, np.concatenate(kept), np.concatenate(faces), rounds)
