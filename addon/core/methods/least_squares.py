"""Least-squares multidimensional scaling of geodesic distances: SMACOF with unit weights (Elad and Kimmel)."""

from __future__ import annotations

import numpy as np

from ..embedding.smacof import minimise_stress
from ..embedding.stress import Stress, pair_set
from ..numerics.arrays import FloatArray
from ..run.monitor import Monitor
from ..unfolding.embedding import Embedding
from ..unfolding.samples import Samples, WholeSurface
from ..unfolding.settings import Settings
from .classical import scaled_classically


def unit_smacof(
    distances: FloatArray, start: FloatArray, settings: Settings, monitor: Monitor
) -> tuple[FloatArray, FloatArray]:
    """Lower the stress of all pairs with unit weights; V⁺ is then a division by n.

    Parameters
    ----------
    distances : (n, n) ndarray of float
        Wanted distances, symmetric.
    start : (n, 3) ndarray of float
        First embedding.
    settings : Settings
        Iterations, tolerance and extrapolation.
    monitor : Monitor
        Told the progress and asked whether to stop.

    Returns
    -------
    embedding : (n, 3) ndarray of float
        The points, centred.
    history : (s + 1,) ndarray of float
        Stress before each step and after the last.

    Raises
    ------
    CancelledError
        If the monitor says so.
    """
    count = len(distances)
    pairs = pair_set(np.arange(count), distances, lambda _rows, _columns, wanted: np.ones_like(wanted))
    return minimise_stress(
        Stress(count, [pairs], monitor),
        lambda pull: (pull - pull.mean(axis=0)) / count,
        start,
        settings.iterations,
        settings.tolerance,
        settings.extrapolation,
        monitor,
    )


def fitted(samples: Samples, settings: Settings, monitor: Monitor) -> tuple[FloatArray, FloatArray]:
    """Embed all vertices by least squares, from the classical embedding.

    Parameters
    ----------
    samples : Samples
        Geodesic distances.
    settings : Settings
        Iterations, tolerance and extrapolation.
    monitor : Monitor
        Told the progress and asked whether to stop.

    Returns
    -------
    form : (n, 3) ndarray of float
        All vertices. Those that are no samples are placed by their distances from the samples.
    history : (s + 1,) ndarray of float
        Stress of the samples.

    Raises
    ------
    CancelledError
        If the monitor says so.
    """
    start = scaled_classically(samples)
    placed, history = unit_smacof(samples.between, start[samples.vertices], settings, monitor)
    placed = placed + start[samples.vertices].mean(axis=0)
    return samples.spread(placed, start), history


def least_squares_form(whole: WholeSurface, settings: Settings, monitor: Monitor) -> Embedding:
    """Unfold a surface by SMACOF on its geodesic distances.

    Parameters
    ----------
    whole : WholeSurface
        The mesh.
    settings : Settings
        At quality 'full' all pairs are used, otherwise landmarks carry the rest; iterations, tolerance and
        extrapolation.
    monitor : Monitor
        Told the progress and asked whether to stop.

    Returns
    -------
    Embedding
        The form.

    Raises
    ------
    TooLargeError
        If all pairs do not fit into the memory limit.
    CancelledError
        If the monitor says so.

    References
    ----------
    Elad and Kimmel, "On bending invariant signatures for surfaces", 2003; De Leeuw, "Applications of convex analysis
    to multidimensional scaling", 1977.
    """
    with monitor.stage("Distances", 0.6):
        samples = whole.samples()
    with monitor.stage("Embedding", 0.95):
        form, history = fitted(samples, settings, monitor)
        return whole.embedding(form, history, samples.distances.size)
