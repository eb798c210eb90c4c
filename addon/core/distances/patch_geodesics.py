"""Geodesic distances between all vertices of a patch (paper section 3.3)."""

from __future__ import annotations

import numpy as np

from ..numerics.arrays import FloatArray
from ..numerics.blocks import columns_at_once, symmetrise
from ..run.monitor import Monitor
from ..surface.triangulation import Triangulation
from .heat import HeatMethod


def all_geodesics(
    surface: Triangulation,
    *,
    smooth: float | None = None,
    monitor: Monitor | None = None,
    done: float = 0.0,
    share: float = 1.0,
) -> FloatArray:
    """Measure geodesic distances between all vertices of a patch by the heat method (paper section 3.3).

    Parameters
    ----------
    surface : Triangulation
        The patch, connected, with its natural (Neumann) border.
    smooth : float, optional
        Diffusion time of smoothed distances; see `HeatMethod`. Without, the triangles are refined for accuracy.
    monitor : Monitor, optional
        Receives progress; polled for cancellation.
    done, share : float
        The fraction of the present stage that is done before, and that this call is worth.

    Returns
    -------
    (p, p) ndarray of float
        Distances, symmetric (the mean of both ways), diagonal 0.

    Raises
    ------
    CancelledError
        If the run is cancelled.

    Examples
    --------
    >>> from addon.core.surface.triangulation import triangulated
    >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
    >>> distance = all_geodesics(triangulated(square, np.array([[0, 1, 2], [1, 3, 2]])))
    >>> np.array_equal(distance, distance.T), np.allclose(distance[0, 3], np.sqrt(2), rtol=0.05)
    (True, True)
    """
    monitor, count = monitor or Monitor(), surface.vertex_count
    heat = HeatMethod(surface, smooth, refine=smooth is None, monitor=monitor)
    distance = np.empty((count, count))
    chunk = columns_at_once(count)
    for start in range(0, count, chunk):
        block = np.arange(start, min(start + chunk, count))
        distance[block] = heat.distances(block).T  # by rows: a column of a large matrix touches every page of it
        monitor.tick(done + share * (block[-1] + 1) / count)
    symmetrise(distance, monitor.check)
    np.fill_diagonal(distance, 0.0)
    return distance
