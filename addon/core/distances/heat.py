"""Geodesic distance by the heat method (paper section 4)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from ..numerics.arrays import FloatArray, IntArray
from ..numerics.factoring import Factor, factored
from ..run.errors import SolverError
from ..run.monitor import Monitor
from ..surface.laplacian import mass, stiffness
from ..surface.triangulation import Triangulation, face_areas
from .edge_paths import edge_graph

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

_FAINTEST = 1e-280  # heat that must reach one end of the surface from the other; a double ends at 1e-308
FEWEST = 400  # vertices that a refined surface has at least: on a tetrahedron heat would be a third off
WHOLE = 2500  # the same where distances all over a surface are all that is wanted
_BACKWARDS = 0.1  # of the largest distance that a distance may be below 0 before the field is given up
_TAKES_OVER = 2.0  # diffusion lengths of the first time from the source
_LONGER = 40  # most doublings of the time for that
_AT_ONCE = 500_000  # values of heat at once: bounds the memory and the time until a cancellation is noticed


class HeatMethod:
    """Geodesic distances from any vertex, with the two linear systems factored once.

    Three choices keep the error near 1.5 % on real meshes: the triangles are intrinsically Delaunay, each is
    split in four, and the direction of the flow is taken from the logarithm of the heat, which is close to linear in
    a triangle where the heat itself falls exponentially.

    `surface`: the surface, connected, Delaunay, split in four (`refined`) where the error, about a third lower, is
    worth three times the cost; `smooth`: a second diffusion time, a squared length, whose heat takes over two
    diffusion lengths away from the source: distances become smooth and hardly feel how the surface is bent there;
    `count`: number of vertices to measure at, the first of the surface; all if omitted.

    Examples
    --------
    >>> from addon.core.surface.delaunay import refined
    >>> from addon.core.surface.triangulation import triangulated
    >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
    >>> surface = refined(triangulated(square, np.array([[0, 1, 2], [1, 3, 2]])), FEWEST)
    >>> heat = HeatMethod(surface, count=4)
    >>> np.allclose(heat.distances([0])[:, 0], [0, 1, 1, np.sqrt(2)], rtol=0.05)
    True

    References
    ----------
    Crane, Weischedel and Wardetzky, "Geodesics in Heat", 2013, doi:10.1145/2516971.2516977; Sharp and Crane, 2020
    (intrinsic triangulation).
    """

    def __init__(
        self,
        surface: Triangulation,
        smooth: float | None = None,
        *,
        count: int | None = None,
        monitor: Monitor | None = None,
    ) -> None:
        from scipy.sparse import csr_matrix
        from scipy.sparse.csgraph import connected_components

        monitor = monitor or Monitor()
        self._monitor, self._fine, self._faces = monitor, surface, surface.faces
        self._vertex_count = surface.vertex_count if count is None else count
        area, base = face_areas(surface.lengths), surface.lengths[:, 2]
        # triangle laid out with corner 0 at the origin, corner 1 at (base, 0) and corner 2 at (foot, height)
        self._base, self._height = base[:, None], 2 * (area / base)[:, None]
        self._foot = ((surface.lengths[:, 1] ** 2 - surface.lengths[:, 0] ** 2 + base**2) / (2 * base))[:, None]
        m, n = len(surface.faces), surface.vertex_count
        across = area[:, None] / self._height
        slope = (self._foot / self._base) * across
        weights = np.concatenate(
            [
                np.column_stack([-area / base, area / base, np.zeros(m)]),
                np.column_stack([slope - across, -slope, across]),
            ]
        )
        start = np.arange(0, 6 * m + 1, 3)
        columns = np.concatenate([surface.faces, surface.faces]).ravel()
        self._divergence = csr_matrix((weights.ravel(), columns, start), shape=(2 * m, n)).T.tocsr()
        self._poisson: Factor | None = None
        try:
            self._factor(smooth)
        except SolverError as error:
            if connected_components(edge_graph(surface), directed=False, return_labels=False) > 1:
                raise SolverError("heat_disconnected") from error
            self._poisson = None  # edges without weight, by rounding

    def _factor(self, smooth: float | None) -> None:
        """Factor the systems, for the least time in which heat reaches all of the surface."""
        from scipy.sparse import diags
        from scipy.special import k0

        fine = self._fine
        L, M = stiffness(fine), diags(mass(fine))
        self._monitor.check()
        # the multiple of M only makes L invertible; right-hand sides sum to 0, so it does not show in the distances
        self._poisson = factored(L + 1e-9 / M.diagonal().sum() * M)
        self._monitor.check()
        L = _without_negative_weights(L)
        self._smooth = None
        time = 0.5 * float((fine.lengths**2).mean())
        probe = np.zeros(fine.vertex_count)
        probe[_far_end(fine)] = 1.0
        for _ in range(_LONGER):
            self._monitor.check()
            self._heat = factored(M + time * L)
            heat = self._heat.solve(probe)
            if heat.min() > _FAINTEST * heat.max():
                break
            time *= 2.0
        else:
            raise SolverError("singular")
        if smooth is not None and smooth > time:
            self._smooth = factored(M + smooth * L)
            # a point source in the plane leaves K₀(d / √t) / 2πt after one backward step
            self._share = (smooth / time) * k0(_TAKES_OVER) / k0(_TAKES_OVER * np.sqrt(time / smooth))

    def distances(self, sources: ArrayLike) -> FloatArray:
        """Measure the distance of every vertex from each of the sources. `sources` (s,); gives (n, s)."""
        source = np.atleast_1d(np.asarray(sources, dtype=np.int64))
        most = max(_AT_ONCE // self._fine.vertex_count, 1)
        if len(source) <= most:
            return self._distances(source)
        distance = np.empty((self._vertex_count, len(source)))
        for start in range(0, len(source), most):
            self._monitor.check()
            distance[:, start : start + most] = self._distances(source[start : start + most])
        return distance

    def _distances(self, source: IntArray) -> FloatArray:
        if self._poisson is None:
            return self._along_edges(source)
        column = np.arange(len(source))
        distance = self._from_sparks(source, column)
        distance -= distance[source, column]
        largest = np.abs(distance).max(axis=0)
        lost = np.flatnonzero(~(distance.min(axis=0) >= -_BACKWARDS * largest) | (largest == 0))
        if len(lost) and self._vertex_count > 1:
            distance[:, lost] = self._along_edges(source[lost])
        return distance

    def distance_to_set(self, sources: ArrayLike) -> FloatArray:
        """Measure the distance of every vertex from the nearest of many vertices, by one spread of heat from all.

        Where fronts from several sources meet, the error is larger than from each alone: 2 to 7 %.

        `sources` (s,); gives (n,).
        """
        source = np.unique(np.asarray(sources, dtype=np.int64))
        if self._poisson is None:
            return self._along_edges(source).min(axis=1)
        distance = self._from_sparks(source, np.zeros(len(source), dtype=np.int64))[:, 0]
        distance = np.maximum(distance - distance[source].mean(), 0.0)
        distance[source] = 0.0
        return distance

    def _along_edges(self, source: IntArray) -> FloatArray:
        from scipy.sparse.csgraph import dijkstra

        self._monitor.warn("heat_fallback")
        return np.asarray(dijkstra(edge_graph(self._fine), directed=False, indices=source)[:, : self._vertex_count].T)

    def _from_sparks(self, source: IntArray, column: IntArray) -> FloatArray:
        """Find distances, up to a constant, of every vertex from the sources of each column."""
        assert self._poisson is not None
        spark = np.zeros((self._divergence.shape[0], int(column[-1]) + 1))  # (n', s)
        spark[source, column] = 1.0
        heat = self._heat.solve(spark)
        if self._smooth is not None:
            heat += self._share * self._smooth.solve(spark)
        np.maximum(heat, np.finfo(np.float64).tiny, out=heat)
        np.log(heat, out=heat)
        origin = heat[self._faces[:, 0]]
        along = (origin - heat[self._faces[:, 1]]) / self._base  # (m', s)
        across = (origin - heat[self._faces[:, 2]] - self._foot * along) / self._height
        norm = np.sqrt(along * along + across * across)
        norm[norm == 0] = 1.0
        flow = np.concatenate([np.divide(along, norm, out=along), np.divide(across, norm, out=across)])
        return np.asarray(self._poisson.solve(self._divergence @ flow)[: self._vertex_count])


def _without_negative_weights(stiffness_matrix: csr_matrix) -> csr_matrix:
    """Drop the negative weights that obtuse corners at a border leave, so that heat is positive everywhere."""
    from scipy.sparse import diags

    weights = -stiffness_matrix
    weights.setdiag(0.0)
    weights = weights.maximum(0.0)
    return diags(np.asarray(weights.sum(axis=1)).ravel()) - weights


def _far_end(surface: Triangulation) -> int:
    """Find a vertex at one end of the surface: the farthest, along edges, from the farthest from any."""
    from scipy.sparse.csgraph import dijkstra

    graph = edge_graph(surface)
    end = int(np.argmax(dijkstra(graph, directed=False, indices=0)))
    return int(np.argmax(dijkstra(graph, directed=False, indices=end)))
