"""Geodesic distance by the upwind scheme of fast marching, to compare the heat method with (paper section 4)."""

from __future__ import annotations

import numpy as np

from ..numerics.arrays import FloatArray, IntArray
from ..run.monitor import Monitor
from ..surface.delaunay import intrinsic_delaunay
from ..surface.triangulation import Triangulation

_SETTLED = 1e-12  # relative change below which a distance counts as final


def fast_marching(surface: Triangulation, sources: IntArray, monitor: Monitor | None = None) -> FloatArray:
    """Measure distances from a set of vertices by planar wave fronts that cross one triangle after the other.

    The scheme's values do not depend on the order in which triangles are visited, so a whole front is moved at once
    instead of one vertex from a queue.

    `surface`: the surface, connected; `sources` (s,); gives (n,).

    Examples
    --------
    >>> from addon.core.surface.triangulation import triangulated
    >>> points = np.array([[x, y, 0.0] for y in range(5) for x in range(5)])
    >>> corners = [5 * y + x for y in range(4) for x in range(4)]
    >>> faces = np.array([[i, i + a, i + b] for i in corners for a, b in ((1, 6), (6, 5))])
    >>> fast_marching(triangulated(points, faces), np.array([0])).round(6)[:5].tolist()
    [0.0, 1.0, 2.0, 3.0, 4.0]

    References
    ----------
    Kimmel and Sethian, "Computing Geodesic Paths on Manifolds", 1998. The triangles are made intrinsically Delaunay
    first, which leaves few of the obtuse corners that the scheme is poor at.
    """
    monitor = monitor or Monitor()
    fine = intrinsic_delaunay(surface, monitor)
    # every corner of every triangle may be reached across it: target C, the others A and B
    target = fine.faces.ravel()
    one, two = np.roll(fine.faces, -1, axis=1).ravel(), np.roll(fine.faces, -2, axis=1).ravel()
    to_one = np.roll(fine.lengths, -2, axis=1).ravel()  # |CA|: the edge opposite to B
    to_two = np.roll(fine.lengths, -1, axis=1).ravel()
    across = fine.lengths.ravel()
    cosine = np.clip((to_one**2 + to_two**2 - across**2) / (2 * to_one * to_two), -1.0, 1.0)
    ways = np.argsort(np.concatenate([one, two]), kind="stable")  # out of each vertex
    first = np.searchsorted(np.concatenate([one, two])[ways], np.arange(fine.vertex_count + 1))
    ways %= len(target)
    distance = np.full(fine.vertex_count, np.inf)
    distance[sources] = 0.0
    moved, reached = np.asarray(sources, dtype=np.int64), 0
    while len(moved):
        count = first[moved + 1] - first[moved]
        within = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
        way = np.unique(ways[np.repeat(first[moved], count) + within])
        found = _across(distance[one[way]], distance[two[way]], to_one[way], to_two[way], cosine[way])
        before = distance.copy()
        np.minimum.at(distance, target[way], found)
        moved = np.flatnonzero(distance < before * (1 - _SETTLED))
        reached = max(reached, int(np.isfinite(distance).sum()))
        monitor.tick(reached / len(distance))
    return distance[: surface.vertex_count]


def _across(one: FloatArray, two: FloatArray, to_one: FloatArray, to_two: FloatArray, cosine: FloatArray) -> FloatArray:
    """Carry a planar front from A and B over to C; along an edge where it does not come through the triangle."""
    along = np.minimum(one + to_one, two + to_two)
    both = np.flatnonzero(np.isfinite(one) & np.isfinite(two))
    swap = one[both] > two[both]
    near, far = np.minimum(one[both], two[both]), np.maximum(one[both], two[both])
    b = np.where(swap, to_two[both], to_one[both])  # from C to the nearer of the two
    a = np.where(swap, to_one[both], to_two[both])
    cos, u = cosine[both], far - near
    square = a * a + b * b - 2 * a * b * cos
    half = b * u * (a * cos - b)
    rest = b * b * (u * u - a * a * (1 - cos * cos))
    root = half * half - square * rest
    t = (-half + np.sqrt(np.maximum(root, 0.0))) / np.maximum(square, np.finfo(float).tiny)
    through = b * (t - u) / np.where(t > 0, t, 1.0)
    comes = (root >= 0) & (u < t) & (a * cos < through) & ((cos <= 0) | (through * cos < a))
    along[both[comes]] = np.minimum(along[both[comes]], (t + near)[comes])
    return along
