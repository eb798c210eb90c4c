"""Fast multidimensional scaling: FastMap on geodesic distances, with a few fields and no minimisation.

Faloutsos and Lin, "FastMap: a fast algorithm for indexing, data-mining and visualization", 1995,
doi:10.1145/223784.223812.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..embedding.classical_scaling import raw_stress
from ..method_api.catalogue import Method
from ..method_api.method_result import MethodResult
from ..method_api.settings import Settings
from ..method_api.surface_features import SurfaceFeatures
from ..method_api.whole_surface import WholeSurface
from ..numerics.arrays import FloatArray
from ..run.monitor import Monitor

_ROUNDS = 5  # of the search for two points that lie far apart, as the authors advise


def fast_map(
    distances_from: Callable[[int], FloatArray], first: int, dimensions: int = 3
) -> tuple[FloatArray, list[int]]:
    """Embed points by their distances from two pivots per axis.

    `distances_from`: returns the distances of all n points from one of them, (n,); `first`: the point where the
    search for pivots starts; `dimensions`: dimension d of the embedding; gives embedding (n, d), pivots.

    Examples
    --------
    >>> places = np.array([0.0, 1, 5])
    >>> embedding, pivots = fast_map(lambda point: np.abs(places - places[point]), 0, 1)
    >>> embedding.ravel().round(6).tolist(), pivots
    ([0.0, 1.0, 5.0], [0, 2])

    References
    ----------
    Faloutsos and Lin, "FastMap: a fast algorithm for indexing, data-mining and visualization", 1995,
    doi:10.1145/223784.223812.
    """
    known: dict[int, FloatArray] = {}

    def squared_from(point: int) -> FloatArray:
        if point not in known:
            known[point] = np.asarray(distances_from(point), dtype=np.float64) ** 2
        flat = embedding[:, :axis] - embedding[point, :axis]
        return np.maximum(known[point] - (flat**2).sum(axis=1), 0.0)  # what remains after the axes so far

    axis, pivots = 0, []
    embedding = np.zeros((len(np.asarray(distances_from(first))), dimensions))
    for axis in range(dimensions):
        near = far = first
        for _ in range(_ROUNDS):
            near, far = far, int(np.argmax(squared_from(far)))
        from_near, from_far = squared_from(near), squared_from(far)
        between = (from_near[far] + from_far[near]) / 2
        if not between > 0:
            break
        pivots += [near, far]
        embedding[:, axis] = (from_near + between - from_far) / (2 * np.sqrt(between))
    return embedding, pivots


def _form(found: SurfaceFeatures, settings: Settings, monitor: Monitor) -> MethodResult:
    """Unfold a surface by FastMap: a few distance fields and no minimisation."""
    whole = WholeSurface(found, settings, monitor)
    fields: dict[int, FloatArray] = {}

    def distances_from(point: int) -> FloatArray:
        if point not in fields:
            monitor.check()
            fields[point] = np.maximum(whole.heat.distances([point])[:, 0], 0.0)
        return fields[point]

    with monitor.stage("Embedding"):
        form, pivots = fast_map(distances_from, whole.summit)
        between = np.column_stack([fields[point][pivots] for point in pivots])
        stress = raw_stress(form[pivots], (between + between.T) / 2)
        return whole.embedding(form, [stress], len(fields) * len(form))


METHODS = (
    Method(
        name="fast",
        label="Fast MDS",
        help="FastMap: one pair of pivots per axis (Faloutsos and Lin 1995)",
        source="FastMap, Faloutsos and Lin 1995",
        unfold=_form,
        stages={"Embedding": 59},
        rank=4,
    ),
)
