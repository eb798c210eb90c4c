"""A coarse mesh on some of the vertices of a fine one, and the way back from there to all vertices."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .monitor import Monitor
from .surface import FloatArray, IntArray, vertex_areas

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

_EVENNESS = 0.05  # weight of evenly spread vertices against the fit to the surface: fingers keep a few more
_SHARE = 0.6  # of the vertices, the cheapest, may go in one round
_TURN = 0.2  # least cosine between the normals of a triangle before and after
_THINNEST = 0.02  # least area of a triangle that a removal makes, in squares of its longest edge
_TIE = 1e-9  # costs as close as this count as equal, lower vertex first, so that rounding decides nothing


@dataclass(frozen=True, eq=False)
class Coarsening:
    """A coarse mesh and how every other vertex hangs between its neighbours.

    Attributes
    ----------
    vertex_count : int
        Number n of fine vertices.
    kept : (c,) ndarray of int
        The fine vertices that are left, in rising order.
    faces : (m, 3) ndarray of int
        Triangles of the coarse mesh; corners index `kept`.
    rounds : list of (ndarray, csr_matrix)
        Vertices removed together, in order of removal, and their weights ``(r, n)`` among the vertices left then.
    """

    vertex_count: int
    kept: IntArray
    faces: IntArray
    rounds: list[tuple[IntArray, csr_matrix]]

    def carried_back(self, values: FloatArray) -> FloatArray:
        """Interpolate values on the coarse vertices to all vertices, smoothly over the surface.

        Parameters
        ----------
        values : (c, d) or (c,) ndarray of float
            Values on the coarse vertices.

        Returns
        -------
        (n, d) or (n,) ndarray of float
            Values on all vertices, each an average with positive weights.
        """
        full = np.zeros((self.vertex_count, *values.shape[1:]))
        full[self.kept] = values
        for removed, weights in reversed(self.rounds):
            full[removed] = weights @ full
        return full


def coarsened(
    points: FloatArray, faces: IntArray, target: int, fixed: IntArray | None = None, monitor: Monitor | None = None
) -> Coarsening:
    """Remove vertices until about `target` are left, keeping the shape and spreading the rest evenly.

    Many vertices go at once: each is drawn onto the neighbour where it harms least (squared distance from the planes
    of the surface it stands for, plus a term for evenness), never two that share an edge, and only where the surface
    stays a surface and no triangle turns over.

    Parameters
    ----------
    points : (n, 3) ndarray of float
        Vertices.
    faces : (m, 3) ndarray of int
        Triangles.
    target : int
        Number of vertices wanted.
    fixed : (k,) ndarray of int, optional
        Vertices that stay.
    monitor : Monitor, optional
        Told the progress and asked whether to stop.

    Returns
    -------
    Coarsening
        The coarse mesh; more vertices than `target` are left where no more can go.

    Raises
    ------
    CancelledError
        If the monitor says so.

    References
    ----------
    Garland and Heckbert, "Surface Simplification Using Quadric Error Metrics", 1997; Hoppe, "Progressive Meshes",
    1996; Floater, "Mean Value Coordinates", 2003 (the weights).
    """
    monitor = monitor or Monitor()
    count = len(points)
    quadrics = _quadrics(points, faces)  # (n, 10)
    areas = vertex_areas(points, faces)
    patience = np.zeros(count)  # how often a vertex could not go where it wanted to
    if fixed is not None:
        patience[fixed] = np.inf
    alive = np.ones(count, dtype=bool)
    left = count
    rounds: list[tuple[IntArray, csr_matrix]] = []
    stuck = 0
    while left > target and stuck < 4:
        monitor.tick(np.log(count / left) / np.log(count / target))
        links = _Links(faces, count)
        monitor.check()
        leaving, onto, cost = _wishes(points, links, quadrics, areas, patience)
        monitor.check()
        chosen = _independent(leaving, cost, links, count)
        monitor.check()
        leaving, onto, cost = leaving[chosen], onto[chosen], cost[chosen]
        good = _harmless(points, faces, links, leaving, onto, cost)
        patience[leaving[~good]] += 1
        leaving, onto, cost = leaving[good], onto[good], cost[good]
        stuck = stuck + 1 if len(leaving) < 0.005 * left else 0
        if len(leaving) > left - target:
            first = np.sort(np.argsort(cost, kind="stable")[: left - target])
            leaving, onto = leaving[first], onto[first]
        if not len(leaving):
            continue
        monitor.check()
        rounds.append((leaving, _mean_value_weights(points, faces, leaving, count)))
        np.add.at(quadrics, onto, quadrics[leaving])
        np.add.at(areas, onto, areas[leaving])
        alive[leaving] = False
        left -= len(leaving)
        goes_to = np.arange(count)
        goes_to[leaving] = onto
        faces = goes_to[faces]
        flat = (faces == np.roll(faces, 1, axis=1)).any(axis=1)
        faces = faces[~flat]
    kept = np.flatnonzero(alive)
    number = np.full(count, -1, dtype=np.int64)
    number[kept] = np.arange(len(kept))
    return Coarsening(count, kept, number[faces], rounds)


class _Links:
    """The edges of the present mesh, both ways, sorted by their tail, and on how many triangles each lies."""

    def __init__(self, faces: IntArray, count: int) -> None:
        tail, head = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
        one_way = np.minimum(tail, head) * count + np.maximum(tail, head)
        keys, triangles = np.unique(one_way, return_counts=True)
        low, high = keys // count, keys % count
        order = np.argsort(np.concatenate([keys, high * count + low]), kind="stable")
        self.tail = np.concatenate([low, high])[order]
        self.head = np.concatenate([high, low])[order]
        self.key = self.tail * count + self.head
        self.triangles = np.concatenate([triangles, triangles])[order]
        self.first = np.searchsorted(self.tail, np.arange(count + 1))
        self.count = count

    def out_of(self, vertices: IntArray) -> tuple[IntArray, IntArray]:
        """List the edges out of some vertices: position of the vertex in the list, and number of the edge."""
        degree = self.first[vertices + 1] - self.first[vertices]
        owner = np.repeat(np.arange(len(vertices)), degree)
        within = np.arange(len(owner)) - np.repeat(np.cumsum(degree) - degree, degree)
        return owner, self.first[vertices][owner] + within

    def hold(self, key: IntArray) -> np.ndarray:
        """Tell which keys are edges."""
        at = np.minimum(np.searchsorted(self.key, key), len(self.key) - 1)
        return self.key[at] == key


def _quadrics(points: FloatArray, faces: IntArray) -> FloatArray:
    """Sum, over the triangles of each vertex, area times the squared distance from their planes."""
    a, b, c = (points[faces[:, i]] for i in range(3))
    normal = np.cross(b - a, c - a)
    area = np.linalg.norm(normal, axis=1)
    normal /= np.maximum(area, np.finfo(float).tiny)[:, None]
    plane = np.column_stack([normal, -np.einsum("ij,ij->i", normal, a)])
    row, column = np.triu_indices(4)
    terms = plane[:, row] * plane[:, column] * (area / 6)[:, None]  # (m, 10)
    return np.column_stack(
        [np.bincount(faces.ravel(), np.repeat(terms[:, k], 3), minlength=len(points)) for k in range(10)]
    )


def _wishes(
    points: FloatArray, links: _Links, quadrics: FloatArray, areas: FloatArray, patience: FloatArray
) -> tuple[IntArray, IntArray, FloatArray]:
    """Find for every vertex that may go the neighbour where it harms least, and the harm; the cheaper share of them."""
    u, v = links.tail, links.head
    rim = links.triangles != 2
    rims = np.bincount(u[rim], minlength=links.count)
    wild = np.bincount(u[links.triangles > 2], minlength=links.count) > 0
    may = (patience[u] < np.inf) & np.where(
        rims[u] == 0, True, (rims[u] == 2) & ~wild[u] & rim
    )  # along a border, or off the inside
    u, v = u[may], v[may]
    x, y, z = points[v].T
    q = quadrics[u].T
    harm = q[0] * x * x + q[4] * y * y + q[7] * z * z + q[9]
    harm += 2 * (q[1] * x * y + q[2] * x * z + q[5] * y * z + q[3] * x + q[6] * y + q[8] * z)
    length = ((points[u] - points[v]) ** 2).sum(axis=1)
    cost = np.maximum(harm, 0.0) + _EVENNESS * length * areas[u]
    order = np.lexsort((cost, u))
    start = np.flatnonzero(np.concatenate([[True], u[order][1:] != u[order][:-1]]))
    size = np.diff(np.append(start, len(u)))
    turn = patience[u[order][start]].astype(np.int64)
    pick = order[start + turn % np.maximum(size, 1)]  # those that could not go try the next best
    cost = cost[pick] * 2.0**turn
    cheap = cost <= np.quantile(cost, _SHARE) if len(cost) else np.zeros(0, bool)
    pick, cost = pick[cheap], cost[cheap]
    return u[pick], v[pick], cost


def _independent(leaving: IntArray, cost: FloatArray, links: _Links, count: int) -> IntArray:
    """Choose vertices of which no two share an edge, cheap ones first, and none onto which another goes."""
    order = np.argsort(cost, kind="stable")
    jump = np.concatenate([[0], np.cumsum(np.diff(cost[order]) > _TIE * cost[order][1:])])
    rank = np.full(count, count + 1, dtype=np.int64)
    rank[leaving[order[np.lexsort((leaving[order], jump))]]] = np.arange(len(order))
    free = rank <= count
    chosen = np.zeros(count, dtype=bool)
    for _ in range(2):
        between = free[links.tail] & free[links.head]
        tail, head = links.tail[between], links.head[between]
        beaten = np.zeros(count, dtype=bool)
        beaten[tail[rank[tail] > rank[head]]] = True
        new = free & ~beaten
        chosen |= new
        free &= ~new
        free[links.head[new[links.tail]]] = False
    return np.flatnonzero(chosen[leaving])


def _harmless(
    points: FloatArray, faces: IntArray, links: _Links, leaving: IntArray, onto: IntArray, cost: FloatArray
) -> np.ndarray:
    """Tell which removals leave a surface a surface and turn no triangle over."""
    count = links.count
    place = np.full(count, -1, dtype=np.int64)
    place[leaving] = np.arange(len(leaving))
    good = np.ones(len(leaving), dtype=bool)
    # the edges that a removal makes must be new, apart from those beside the edge that closes
    owner, edge = links.out_of(leaving)
    other = links.head[edge] != onto[owner]
    closing = links.triangles[edge[~other]]  # one a vertex, in order
    owner, ring = owner[other], links.head[edge[other]]
    made = np.minimum(onto[owner], ring) * count + np.maximum(onto[owner], ring)
    old = links.hold(made)
    good &= np.bincount(owner[old], minlength=len(leaving)) == closing
    # and no two removals may make the same one: the cheaper stays
    owner, made = owner[~old], made[~old]
    order = np.lexsort((cost[owner], made))
    again = np.flatnonzero(made[order][1:] == made[order][:-1]) + 1
    good[owner[order[again]]] = False
    corner = np.flatnonzero(place[faces].ravel() >= 0)
    face, at = corner // 3, corner % 3
    u = faces[face, at]
    one, two = faces[face, (at + 1) % 3], faces[face, (at + 2) % 3]
    v = onto[place[u]]
    stays = (one != v) & (two != v)
    face, u, v, one, two = face[stays], u[stays], v[stays], one[stays], two[stays]
    before = np.cross(points[one] - points[u], points[two] - points[u])
    after = np.cross(points[one] - points[v], points[two] - points[v])
    size_before, size_after = np.linalg.norm(before, axis=1), np.linalg.norm(after, axis=1)
    turned = np.einsum("ij,ij->i", before, after) < _TURN * size_before * size_after
    longest = np.maximum.reduce(
        [((points[a] - points[b]) ** 2).sum(axis=1) for a, b in ((one, two), (one, v), (two, v))]
    )
    thin = (size_after < _THINNEST * longest) & (size_after < size_before)
    good[place[u[turned | thin]]] = False
    return good


def _mean_value_weights(points: FloatArray, faces: IntArray, leaving: IntArray, count: int) -> csr_matrix:
    """Weigh the neighbours of each vertex so that it is their mean, seen along the surface."""
    from scipy.sparse import coo_matrix, diags

    place = np.full(count, -1, dtype=np.int64)
    place[leaving] = np.arange(len(leaving))
    corner = np.flatnonzero(place[faces].ravel() >= 0)
    face, at = corner // 3, corner % 3
    u, one, two = faces[face, at], faces[face, (at + 1) % 3], faces[face, (at + 2) % 3]
    to_one, to_two = points[one] - points[u], points[two] - points[u]
    tiny = np.finfo(float).tiny
    length_one = np.maximum(np.linalg.norm(to_one, axis=1), 1e-12)
    length_two = np.maximum(np.linalg.norm(to_two, axis=1), 1e-12)
    cosine = np.einsum("ij,ij->i", to_one, to_two) / (length_one * length_two)
    tangent = np.sqrt(np.maximum(1 - cosine, 0) / np.maximum(1 + cosine, 1e-6))  # of half the corner's angle
    row = np.tile(place[u], 2)
    weight = np.concatenate([tangent / length_one, tangent / length_two]) + tiny
    matrix = coo_matrix((weight, (row, np.concatenate([one, two]))), shape=(len(leaving), count)).tocsr()
    return diags(1 / np.asarray(matrix.sum(axis=1)).ravel()) @ matrix
