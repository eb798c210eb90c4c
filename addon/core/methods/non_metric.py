"""Non-metric multidimensional scaling: only the order of the geodesic distances is kept.

Below quality 'full' the landmarks are embedded, and the monotone function that was found for them converts the other
vertices' distances from them into those by which they are placed.

Kruskal, "Nonmetric multidimensional scaling: a numerical method", 1964, doi:10.1007/BF02289694.
"""

from __future__ import annotations

import numpy as np

from ..method_api.catalogue import PATIENT, Method
from ..method_api.method_result import MethodResult
from ..method_api.settings import Settings
from ..method_api.surface_features import SurfaceFeatures
from ..method_api.whole_surface import WholeSurface
from ..numerics.arrays import FloatArray
from ..run.monitor import Monitor


def non_metric_scaling(
    distances: FloatArray,
    start: FloatArray,
    *,
    max_iterations: int = 300,
    tolerance: float = 1e-6,
    monitor: Monitor | None = None,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Alternate between the best monotone function of the distances and a majorisation step towards its values.

    The function's values, the disparities, keep the sum of squares of the given distances, so that the points cannot
    collapse. Where two given distances are equal, the first in the matrix comes first (the secondary approach to ties
    makes no difference to geodesics, which are hardly ever equal).

    `distances` (n, n); `start` (n, d); `max_iterations`: maximum number of steps; `tolerance`: stop when a step
    reduces the stress by less than this fraction; gives embedding (n, d), history (s + 1,), disparities.

    Examples
    --------
    >>> line = np.array([[0.0], [1.0], [3.0]])
    >>> embedding, history, _ = non_metric_scaling((line - line.T) ** 2, line, max_iterations=10)
    >>> round(float(history[-1]), 6)
    0.0

    References
    ----------
    Kruskal, "Nonmetric multidimensional scaling: a numerical method", 1964, doi:10.1007/BF02289694; De Leeuw, 1977 (the
    steps).
    """
    from scipy.optimize import isotonic_regression
    from scipy.spatial.distance import pdist, squareform

    monitor = monitor or Monitor()
    given = squareform(distances, checks=False)
    order = np.argsort(given, kind="stable")
    monitor.check()
    size = np.sqrt((given**2).sum())
    points = start - start.mean(axis=0)

    def disparities_of(straight: FloatArray) -> FloatArray:
        rising = np.empty_like(straight)
        rising[order] = isotonic_regression(straight[order]).x
        monitor.check()
        return rising * (size / np.sqrt((rising**2).sum()))

    straight = pdist(points)
    wanted = disparities_of(straight)
    history = [float(((wanted - straight) ** 2).sum())]
    for step in range(max_iterations):
        ratio = squareform(wanted / np.maximum(straight, 1e-12 * size))
        trial = (ratio.sum(axis=1)[:, None] * points - ratio @ points) / len(points)  # n⁻¹ B(X) X
        monitor.check()
        trial_straight = pdist(trial)
        trial_wanted = disparities_of(trial_straight)
        value = float(((trial_wanted - trial_straight) ** 2).sum())
        if value > history[-1]:  # only rounding remains
            break
        points, straight, wanted = trial, trial_straight, trial_wanted
        history.append(value)
        monitor.tick((step + 1) / max_iterations)
        if history[-2] - value < tolerance * history[-2]:
            break
    return points, np.array(history), wanted


def _form(found: SurfaceFeatures, settings: Settings, monitor: Monitor) -> MethodResult:
    """Unfold a surface so that the order of its distances is kept."""
    from scipy.spatial.distance import squareform

    whole = WholeSurface(found, settings, monitor)
    with monitor.stage("Distances"):
        samples = whole.samples()
    with monitor.stage("Embedding"):
        start = samples.classical_embedding()
        placed, history, wanted = non_metric_scaling(
            samples.between,
            start[samples.vertices],
            max_iterations=settings.max_iterations,
            tolerance=PATIENT,
            monitor=monitor,
        )
        given = squareform(samples.between, checks=False)
        order = np.argsort(given, kind="stable")
        known = np.concatenate([[0.0], given[order]]), np.concatenate([[0.0], wanted[order]])
        targets = None if samples.complete else np.interp(samples.distances, *known)
        placed = placed + start[samples.vertices].mean(axis=0)
        return whole.embedding(samples.spread(placed, start, targets), history, samples.distances.size)


METHODS = (
    Method(
        name="non_metric",
        label="Non-metric MDS",
        help="The order of geodesics only (Kruskal 1964)",
        source="Kruskal 1964",
        unfold=_form,
        stages={"Distances": 15, "Embedding": 44},
        uses=("landmark_count", "max_iterations"),
        pairs="all",
        rank=3,
    ),
)
