"""Geodesic distances between the vertices of a patch (paper section 4)."""

from __future__ import annotations

import numpy as np

from ..numerics.arrays import FloatArray, IntArray
from ..numerics.blocks import columns_at_once, symmetrise
from ..run.monitor import Monitor
from ..surface.delaunay import intrinsic_delaunay, refined
from ..surface.triangulation import Triangulation
from .heat import FEWEST, HeatMethod


def all_geodesics(
    surface: Triangulation,
    *,
    smooth: float | None = None,
    monitor: Monitor | None = None,
    done: float = 0.0,
    share: float = 1.0,
) -> FloatArray:
    """Measure geodesic distances between all vertices of a patch by the heat method (paper section 4).

    `surface`: the patch, connected, with its natural (Neumann) border; `smooth`: diffusion time of smoothed
    distances; see `HeatMethod`; `done, share`: the fraction of the present stage that is done before, and that this
    call is worth; gives (p, p).

    Examples
    --------
    >>> from addon.core.surface.triangulation import triangulated
    >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
    >>> distance = all_geodesics(triangulated(square, np.array([[0, 1, 2], [1, 3, 2]])))
    >>> np.array_equal(distance, distance.T), np.allclose(distance[0, 3], np.sqrt(2), rtol=0.05)
    (True, True)
    """
    everything = np.arange(surface.vertex_count)
    return geodesics(surface, everything, everything, smooth=smooth, monitor=monitor, done=done, share=share)


def geodesics(
    surface: Triangulation,
    sources: IntArray,
    vertices: IntArray,
    *,
    smooth: float | None = None,
    monitor: Monitor | None = None,
    done: float = 0.0,
    share: float = 1.0,
) -> FloatArray:
    """Measure geodesic distances of some vertices of a patch from some of them.

    `sources` (s,); `vertices` (p,); gives (s, p).

    Examples
    --------
    >>> from addon.core.surface.triangulation import triangulated
    >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
    >>> surface = triangulated(square, np.array([[0, 1, 2], [1, 3, 2]]))
    >>> geodesics(surface, np.array([3]), np.array([3, 0, 1])).round(1).tolist()
    [[0.0, 1.4, 1.0]]
    """
    monitor = monitor or Monitor()
    fine = intrinsic_delaunay(surface, monitor)  # the triangles cut out for a patch need not be
    if smooth is None:
        fine = refined(fine, FEWEST, monitor)
    heat = HeatMethod(fine, smooth, count=surface.vertex_count, monitor=monitor)
    distance = np.empty((len(sources), len(vertices)))
    chunk = columns_at_once(surface.vertex_count)
    for start in range(0, len(sources), chunk):
        block = sources[start : start + chunk]
        # by rows: a column of a large matrix touches every page of it
        distance[start : start + chunk] = heat.distances(block)[vertices].T
        monitor.tick(done + share * (start + len(block)) / len(sources))
    symmetrise(distance[:, : len(sources)], monitor.check)
    np.fill_diagonal(distance, 0.0)
    return distance
