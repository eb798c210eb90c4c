"""The working surface: a coarse mesh under Delaunay triangles, and the interpolation to all vertices."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from ..mesh.coarsening import Coarsening, coarsened
from ..numerics.arrays import FloatArray, IntArray
from ..run.monitor import Monitor
from .delaunay import intrinsic_delaunay
from .triangulation import Triangulation, triangulated

WORTH_IT = 1.2  # ratio of vertices to the target up to which a mesh is not coarsened
STUCK = 2.0  # ratio of remaining vertices to the target above which coarsening is stuck


@dataclass(frozen=True, eq=False)
class WorkingSurface:
    """Some vertices of a mesh with triangles of their own.

    Attributes
    ----------
    points : (c, 3) ndarray of float
        The working vertices.
    faces : (d, 3) ndarray of int
        Their triangles in space; corners index `points`.
    kept : (c,) ndarray of int
        Their indices in the whole mesh, ascending.
    triangulation : Triangulation
        Their intrinsic Delaunay triangulation.
    stuck : bool
        Whether far more vertices remain than wanted, because no more could be removed.
    coarsening : Coarsening or None
        The interpolation to all vertices; None if all are working vertices.
    bridges : (b, 3) ndarray of int
        The last of the triangles, which are not on the mesh but join the parts of a body.
    """

    points: FloatArray
    faces: IntArray
    kept: IntArray
    triangulation: Triangulation
    stuck: bool
    coarsening: Coarsening | None
    bridges: IntArray

    @property
    def coarse(self) -> bool:
        """Whether there are other vertices than the working vertices."""
        return self.coarsening is not None

    def numbers_of(self, vertices: IntArray) -> IntArray:
        """Map vertices of the whole mesh to their numbers among the working vertices. `vertices` (k,); gives (k,)."""
        return np.searchsorted(self.kept, vertices)

    def prolong(self, values: FloatArray) -> FloatArray:
        """Interpolate values to all vertices of the mesh, smoothly over the surface.

        `values` (c, d); gives (n, d).
        """
        return values if self.coarsening is None else self.coarsening.prolong(values)

    def prolong_frames(self, rotation: FloatArray, shift: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Interpolate local rigid motions ``x ↦ x R + t`` to all vertices of the mesh.

        `rotation` (c, 3, 3); `shift` (c, 3); gives rotation (n, 3, 3), shift (n, 3).

        References
        ----------
        Sumner, Schmid and Pauly, "Embedded Deformation for Shape Manipulation", 2007, doi:10.1145/1276377.1276478.
        """
        motion = self.prolong(np.column_stack([rotation.reshape(-1, 9), shift]))  # (n, 12)
        return motion[:, :9].reshape(-1, 3, 3), motion[:, 9:]

    def moved(self, points: FloatArray, monitor: Monitor) -> WorkingSurface:
        """Return the same vertices and triangles in another shape of the mesh. `points` (n, 3)."""
        own = points[self.kept]
        return replace(self, points=own, triangulation=intrinsic_delaunay(triangulated(own, self.faces), monitor))

    def with_slack(self, slack: float, monitor: Monitor) -> WorkingSurface:
        """Lengthen every edge a little further, for solvers that fail on degenerate triangles."""
        return replace(self, triangulation=intrinsic_delaunay(triangulated(self.points, self.faces, slack), monitor))


class Reduced(Protocol):
    """The interface of a function that reduces a mesh, as `working_surface` does."""

    def __call__(
        self,
        points: FloatArray,
        faces: IntArray,
        target: int | None = None,
        *,
        fixed: IntArray | None = None,
        monitor: Monitor | None = None,
    ) -> WorkingSurface:
        """Reduce a mesh."""


def working_surface(
    points: FloatArray,
    faces: IntArray,
    target: int | None = None,
    *,
    fixed: IntArray | None = None,
    monitor: Monitor | None = None,
) -> WorkingSurface:
    """Reduce a mesh to about `target` vertices and find its intrinsic Delaunay triangulation.

    `points` (n, 3); `faces` (m, 3); `target`: number of working vertices; all if omitted, or if there are hardly
    more; `fixed` (k,).

    Examples
    --------
    >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
    >>> surface = working_surface(square, np.array([[0, 1, 2], [1, 3, 2]]))
    >>> surface.coarse, surface.prolong(np.arange(4.0)).tolist()
    (False, [0.0, 1.0, 2.0, 3.0])
    """
    monitor = monitor or Monitor()
    coarsening, kept = None, np.arange(len(points))
    if target is not None and len(points) > WORTH_IT * target:
        with monitor.stage("Coarse mesh"):
            coarsening = coarsened(points, faces, target, fixed=fixed, monitor=monitor)
            kept, faces = coarsening.kept, coarsening.faces
            points = points[kept]
    with monitor.stage("Triangulation"):
        triangulation = intrinsic_delaunay(triangulated(points, faces), monitor)
    stuck = target is not None and len(points) > STUCK * target
    return WorkingSurface(points, faces, kept, triangulation, stuck, coarsening, np.empty((0, 3), dtype=np.int64))
