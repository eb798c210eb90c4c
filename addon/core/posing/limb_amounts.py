"""How far each vertex moves when the pose is removed from selected limbs only."""

from __future__ import annotations

import numpy as np

from ..mesh.connectivity import component_labels
from ..mesh.edges import vertex_pairs
from ..mesh.geometry import of_unit_area
from ..numerics.arrays import FloatArray, IntArray
from ..numerics.ramps import smooth_ramp

_BAND = 0.15  # half the width of the band in which a limb's form blends into the pose, in sqrt(area)
_DEEPEST = 0.5  # maximum of it, as a share of the distance from the border of a limb to its tip


def limb_amounts(points: FloatArray, faces: IntArray, chosen: np.ndarray) -> FloatArray:
    """Compute how far each vertex moves when the pose is removed from selected limbs only.

    `points` (n, 3); `faces` (m, 3); `chosen` (n,); gives (n,).

    Examples
    --------
    >>> points = np.array([[x, y, 0.0] for x in range(9) for y in (0, 1)])
    >>> faces = np.array([[i, i + 2, i + 1] for i in range(16)])
    >>> amounts = limb_amounts(points, faces, points[:, 0] < 4)
    >>> amounts.min().item(), amounts.max().item()
    (0.0, 1.0)
    """
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import dijkstra

    if chosen.all() or not chosen.any():
        return chosen.astype(np.float64)
    points = of_unit_area(points, faces)[0]
    pairs = vertex_pairs(faces)
    length = np.linalg.norm(points[pairs[:, 0]] - points[pairs[:, 1]], axis=1)
    graph = coo_matrix((length, (pairs[:, 0], pairs[:, 1])), shape=(len(points), len(points))).tocsr()
    border = pairs[chosen[pairs[:, 0]] != chosen[pairs[:, 1]]].ravel()

    def depth(side: np.ndarray) -> FloatArray:
        """Compute the distance from the other side's vertices along the border."""
        sources = np.unique(border[~side[border]])
        return dijkstra(graph, directed=False, indices=sources, min_only=True)

    same = pairs[chosen[pairs[:, 0]] == chosen[pairs[:, 1]]]
    part = component_labels(len(points), same)  # each limb, and each piece of the rest, has a band of its own
    distance = np.where(chosen, depth(chosen), depth(~chosen))
    deepest = np.zeros(int(part.max()) + 1)
    np.maximum.at(deepest, part, distance)
    half = np.minimum(_BAND, _DEEPEST * deepest[part])
    signed = np.where(chosen, distance, -distance) / half
    return smooth_ramp(signed, -1.0, 1.0)
