"""Least-squares multidimensional scaling of geodesic distances: SMACOF with unit weights.

Elad and Kimmel, "On bending invariant signatures for surfaces", 2003, doi:10.1109/TPAMI.2003.1233902; De Leeuw,
"Applications of convex analysis to multidimensional scaling", 1977.
"""

from __future__ import annotations

from ..embedding.smacof import smacof
from ..method_api.catalogue import PATIENT, Method
from ..method_api.method_result import MethodResult
from ..method_api.settings import Settings
from ..method_api.surface_features import SurfaceFeatures
from ..method_api.whole_surface import Samples, WholeSurface
from ..numerics.arrays import FloatArray
from ..run.monitor import Monitor


def fitted(samples: Samples, settings: Settings, monitor: Monitor) -> tuple[FloatArray, FloatArray]:
    """Embed all vertices by least squares, from the classical embedding; also the stress of the samples by step.

    Examples
    --------
    >>> import numpy as np
    >>> from scipy.spatial.distance import cdist
    >>> corners = np.array([[-1.0, -1, 0], [2, -1, 0], [-1, 2, 0]])
    >>> samples = Samples(np.arange(3), cdist(corners, corners))
    >>> form, history = fitted(samples, Settings(max_iterations=10), Monitor())
    >>> np.allclose(cdist(form, form), cdist(corners, corners))
    True
    """
    start = samples.classical_embedding()
    placed, history = smacof(
        samples.between,
        start[samples.vertices],
        max_iterations=settings.max_iterations,
        tolerance=PATIENT,
        monitor=monitor,
    )
    placed = placed + start[samples.vertices].mean(axis=0)
    return samples.spread(placed, start), history


def _form(found: SurfaceFeatures, settings: Settings, monitor: Monitor) -> MethodResult:
    """Unfold a surface by SMACOF on its geodesic distances."""
    whole = WholeSurface(found, settings, monitor)
    with monitor.stage("Distances"):
        samples = whole.samples()
    with monitor.stage("Embedding"):
        form, history = fitted(samples, settings, monitor)
        return whole.embedding(form, history, samples.distances.size)


METHODS = (
    Method(
        name="least_squares",
        label="Least-Squares MDS",
        help="SMACOF with unit weights on geodesics (Elad and Kimmel 2003)",
        source="Elad and Kimmel 2003",
        unfold=_form,
        stages={"Distances": 25, "Embedding": 34},
        uses=("landmark_count", "max_iterations"),
        pairs="all",
        rank=2,
    ),
)
