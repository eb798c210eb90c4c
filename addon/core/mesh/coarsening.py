"""A coarse mesh on some of the vertices of a fine one, and the way back from there to all vertices."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..numerics.arrays import FloatArray, IntArray
from ..numerics.blocks import AT_ONCE
from ..numerics.vectors import cross, dot, gathered
from ..run.monitor import Monitor
from .edges import half_edges, pair_counts, undirected_keys
from .geometry import area_vectors, vertex_areas

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

_EVENNESS = 0.05  # weight of evenly spread vertices against the fit to the surface: fingers keep a few more
_FAR = 20  # times the target: while more vertices are left, the smallest go, as many as can at once,
_MANY, _NEAR = 32_000, 2  # and while more than so many and this times the target are: fine meshes are even anyway
_SHARE = 0.6  # of the vertices, the cheapest, may go in one round
_FEW = 0.05  # of the vertices that may go in a round; fewer do not thin the mesh out
_COMPACT = 0.6  # share of the vertices left below which arrays are made smaller
_TURN = 0.2  # least cosine between the normals of a triangle before and after
_THINNEST = 0.02  # least area of a triangle that a removal makes, in squares of its longest edge
_TIE = 1e-8  # costs as close as this count as equal, lower vertex first, so that rounding decides nothing


class Coarsening(NamedTuple):
    """A coarse mesh and how every other vertex hangs between its neighbours."""

    vertex_count: int  # n, of the fine mesh
    kept: IntArray  # (c,) the fine vertices that are left, rising
    faces: IntArray  # (m, 3) corners index `kept`
    rounds: list[tuple[IntArray, csr_matrix]]  # removed together, in order; weights (r, n) among those left then

    def prolong(self, values: FloatArray) -> FloatArray:
        """Interpolate values on the coarse vertices to all vertices, smoothly over the surface.

        `values` (c, d); gives (n, d).
        """
        full = np.zeros((self.vertex_count, *values.shape[1:]))
        full[self.kept] = values
        for removed, weights in reversed(self.rounds):
            full[removed] = weights @ full
        return full


def coarsened(
    points: FloatArray,
    faces: IntArray,
    target: int,
    *,
    fixed: IntArray | None = None,
    monitor: Monitor | None = None,
) -> Coarsening:
    """Remove vertices until about `target` are left, keeping the shape and spreading the rest evenly.

    Many vertices go at once: each is drawn onto the neighbour where it harms least (squared distance from the planes
    of the surface it stands for, plus a term for evenness), never two that share an edge, and only where the surface
    stays a surface and no triangle turns over.

    `points` (n, 3); `faces` (m, 3); `target`: number of vertices wanted; `fixed` (k,).

    Examples
    --------
    >>> points = np.array([[x, y, 0.0] for y in range(5) for x in range(5)])
    >>> corners = [5 * y + x for y in range(4) for x in range(4)]
    >>> faces = np.array([[i, i + a, i + b] for i in corners for a, b in ((1, 6), (6, 5))])
    >>> coarse = coarsened(points, faces, 12, fixed=np.array([0, 4, 20, 24]))
    >>> len(coarse.kept) < 25, bool(np.isin([0, 4, 20, 24], coarse.kept).all())
    (True, True)
    >>> np.allclose(coarse.prolong(np.ones(len(coarse.kept))), 1)
    True

    References
    ----------
    Garland and Heckbert, "Surface Simplification Using Quadric Error Metrics", 1997, doi:10.1145/258734.258849; Hoppe,
    "Progressive Meshes", 1996, doi:10.1145/237170.237216; Floater, "Mean Value Coordinates", 2003,
    doi:10.1016/S0167-8396(03)00002-5 (the weights).
    """
    monitor = monitor or Monitor()
    total = count = len(points)
    number = np.arange(total)  # of the vertices that are left, in the fine mesh
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
        monitor.tick(np.log(total / left) / np.log(total / target))
        if left < _COMPACT * count:
            kept, place = _renumbered(alive)
            faces, number = place[faces], number[kept]
            points, quadrics, areas, patience = points[kept], quadrics[kept], areas[kept], patience[kept]
            alive, count = np.ones(left, dtype=bool), left
        links = _Links(faces, count)
        monitor.check()
        far = left > min(_FAR * target, max(_NEAR * target, _MANY))
        some = np.flatnonzero((np.diff(links.first) > 0) & (patience < np.inf))
        if far:  # the smallest, before any cost is computed: six edges in seven need none
            some = some[_independent(some, _ranks(areas[some] * 2.0 ** patience[some]), links, most=True)]
            monitor.check()
        edge, cost = _wishes(points, links, quadrics, areas, patience, some)
        monitor.check()
        if not far:
            cheap = np.flatnonzero(cost <= (1 + _TIE) * np.quantile(cost, _SHARE)) if len(cost) else np.arange(0)
            cheap = cheap[_independent(links.tail[edge[cheap]], _ranks(cost[cheap]), links, most=False)]
            edge, cost = edge[cheap], cost[cheap]
            monitor.check()
        leaving, onto, rank = links.tail[edge], links.head[edge], _ranks(cost)
        corners = _corners(faces, leaving, count)
        good = _harmless(points, corners, links, leaving, onto, rank)
        good &= ~_strands(corners, links, leaving, onto, np.bincount(faces.ravel(), minlength=count))
        patience[leaving[~good]] += 1
        stuck = stuck + 1 if np.count_nonzero(good) < 0.005 * left else 0
        going = np.flatnonzero(good)
        if len(going) > left - target:
            going = np.sort(going[np.argsort(rank[going], kind="stable")[: left - target]])
        if not len(going):
            continue
        monitor.check()
        rounds.append((number[leaving[going]], _mean_value_weights(points, corners, leaving, number, total)[going]))
        leaving, onto = leaving[going], onto[going]
        terms = (onto[:, None] * quadrics.shape[1] + np.arange(quadrics.shape[1])).ravel()
        np.add.at(quadrics.reshape(-1), terms, quadrics[leaving].ravel())  # in one dimension it is faster
        np.add.at(areas, onto, areas[leaving])
        alive[leaving] = False
        left -= len(leaving)
        goes_to = np.arange(count)
        goes_to[leaving] = onto
        faces = goes_to[faces]
        one, two, three = faces.T
        flat = (one == two) | (two == three) | (three == one)
        faces = faces[~flat]
    kept, place = _renumbered(alive)
    return Coarsening(total, number[kept], place[faces], rounds)


def _renumbered(alive: np.ndarray) -> tuple[IntArray, IntArray]:
    """List the vertices that are left, and the new number of each vertex."""
    kept = np.flatnonzero(alive)
    return kept, np.cumsum(alive) - 1


class _Links:
    """The edges of the present mesh, both ways, sorted by their tail, and on how many triangles each lies."""

    def __init__(self, faces: IntArray, count: int) -> None:
        own = pair_counts(*half_edges(faces), count)
        self._both = own + own.T.tocsr()
        self.head, self.first = self._both.indices.astype(np.int64), self._both.indptr.astype(np.int64)
        self.triangles = np.minimum(self._both.data.astype(np.int64), 3)
        self.tail = np.repeat(np.arange(count), np.diff(self.first))
        self.count = count

    def out_of(self, vertices: IntArray) -> tuple[IntArray, IntArray]:
        """List the edges out of some vertices: position of the vertex in the list, and number of the edge."""
        degree = self.first[vertices + 1] - self.first[vertices]
        owner = np.repeat(np.arange(len(vertices)), degree)
        within = np.arange(len(owner)) - np.repeat(np.cumsum(degree) - degree, degree)
        return owner, self.first[vertices][owner] + within

    def triangles_on(self, tail: IntArray, head: IntArray) -> IntArray:
        """Look up on how many triangles some edges lie, up to three; 0 where there is no edge."""
        return np.minimum(np.asarray(self._both[tail, head], dtype=np.int64).ravel(), 3)


def _quadrics(points: FloatArray, faces: IntArray) -> FloatArray:
    """Sum, over the triangles of each vertex, area times the squared distance from their planes."""
    normal = area_vectors(points, faces)
    area = np.linalg.norm(normal, axis=1)
    unit = np.ascontiguousarray(normal.T) / np.maximum(area, np.finfo(float).tiny)
    plane = (*unit, -dot(unit, gathered(points, faces[:, 0])))
    corners, third = np.ascontiguousarray(faces.T), area / 3
    sums = np.empty((len(points), 10))
    for term, (i, j) in enumerate(zip(*np.triu_indices(4), strict=True)):
        each = plane[i] * plane[j] * third
        sums[:, term] = sum(np.bincount(corner, each, len(points)) for corner in corners)
    return sums


def _wishes(
    points: FloatArray, links: _Links, quadrics: FloatArray, areas: FloatArray, patience: FloatArray, among: IntArray
) -> tuple[IntArray, FloatArray]:
    """Find for some vertices the edge to the neighbour where each harms least, if it has any, and its cost."""
    owner, edge = links.out_of(among)
    first = np.searchsorted(owner, np.arange(len(among) + 1))
    cost = _costs(points, links, edge, quadrics, areas)
    rim = links.triangles != 2
    if rim.any():  # along a border, or off the inside
        rims = np.bincount(links.tail[rim], minlength=links.count)[among][owner]
        wild = (np.bincount(links.tail[links.triangles > 2], minlength=links.count) > 0)[among][owner]
        cost[~np.where(rims == 0, True, (rims == 2) & ~wild & rim[edge])] = np.inf
    least = np.minimum.reduceat(cost, first[:-1]) if len(among) else np.zeros(0)
    pick = np.flatnonzero((cost <= ((1 + _TIE) * least)[owner]) & (cost < np.inf))
    pick = pick[np.diff(owner[pick], prepend=-1) > 0]  # the first of equals
    turn = patience[among][owner[pick]].astype(np.int64)
    again = np.flatnonzero(turn)  # those that could not go try the next best
    trying = np.zeros(len(among), dtype=bool)
    trying[owner[pick[again]]] = True
    at = np.flatnonzero(trying[owner] & (cost < np.inf))
    order = at[np.lexsort((_ranks(cost[at]), owner[at]))]
    start, end = (np.searchsorted(owner[at], owner[pick[again]], side) for side in ("left", "right"))
    pick[again] = order[start + turn[again] % (end - start)]
    return edge[pick], cost[pick] * 2.0**turn


def _costs(points: FloatArray, links: _Links, edge: IntArray, quadrics: FloatArray, areas: FloatArray) -> FloatArray:
    """Compute what it costs to draw the tail of each of some edges onto its head."""
    tail, head = links.tail[edge], links.head[edge]
    cost = np.empty(len(edge))
    for start in range(0, len(cost), AT_ONCE):
        some = slice(start, start + AT_ONCE)
        u, v = tail[some], head[some]
        there, q = gathered(points, v), quadrics.take(u, axis=0).T
        x, y, z = there
        harm = q[0] * x * x + q[4] * y * y + q[7] * z * z + q[9]
        harm += 2 * (q[1] * x * y + q[2] * x * z + q[5] * y * z + q[3] * x + q[6] * y + q[8] * z)
        way = gathered(points, u) - there
        cost[some] = np.maximum(harm, 0.0) + _EVENNESS * dot(way, way) * areas.take(u)
    return cost


def _ranks(cost: FloatArray) -> IntArray:
    """Rank costs from the lowest; those that only rounding tells apart get one rank."""
    order = np.argsort(cost)
    rising = cost[order]
    rank = np.empty(len(cost), dtype=np.int64)
    rank[order] = np.concatenate([[0], np.cumsum(np.diff(rising) > _TIE * rising[1:])])[: len(cost)]
    return rank


def _independent(leaving: IntArray, rank: IntArray, links: _Links, *, most: bool) -> IntArray:
    """Choose vertices of which no two share an edge: those of lowest rank around, or as many as can be if `most`."""
    count = links.count
    place = np.full(count, count + 1, dtype=np.int64)  # in the order of going, the lower vertex first in a tie
    place[np.sort(rank * count + leaving) % count] = np.arange(len(leaving))
    free = place <= count
    chosen = np.zeros(count, dtype=bool)
    tail, head = links.tail, links.head
    for turn in range(6):
        enough = np.count_nonzero(chosen) >= _FEW * len(leaving)
        if turn == 2 and enough and not most:
            break
        if turn == 2 and not enough:
            # costs rise steadily along the surface, and few are cheaper than all around: draw lots
            place[place <= count] = np.random.default_rng(0).permutation(len(leaving))[place[place <= count]]
        between = np.flatnonzero(free[tail] & free[head])
        tail, head = tail[between], head[between]
        beaten = np.zeros(count, dtype=bool)
        beaten[tail[place[tail] > place[head]]] = True
        new = free & ~beaten
        chosen |= new
        free &= ~new
        free[head[new[tail]]] = False
    return np.flatnonzero(chosen[leaving])


def _corners(faces: IntArray, leaving: IntArray, count: int) -> tuple[IntArray, IntArray, IntArray]:
    """List the triangles around some vertices: whose, by place in the list, and the other two corners in order."""
    place = np.full(count, -1, dtype=np.int64)
    place[leaving] = np.arange(len(leaving))
    owner = place[faces].ravel()
    corner = np.flatnonzero(owner >= 0)
    face, at = corner // 3, corner % 3
    return owner[corner], faces[face, (at + 1) % 3], faces[face, (at + 2) % 3]


def _harmless(
    points: FloatArray,
    corners: tuple[IntArray, IntArray, IntArray],
    links: _Links,
    leaving: IntArray,
    onto: IntArray,
    rank: IntArray,
) -> np.ndarray:
    """Tell which removals leave a surface a surface and turn no triangle over."""
    count = links.count
    good = np.ones(len(leaving), dtype=bool)
    # the edges that a removal makes must be new, apart from those beside the edge that closes
    owner, edge = links.out_of(leaving)
    other = links.head[edge] != onto[owner]
    closing = links.triangles[edge[~other]]  # one a vertex, in order
    owner, ring = owner[other], links.head[edge[other]]
    made = undirected_keys(onto[owner], ring, count)
    old = links.triangles_on(onto[owner], ring) > 0
    good &= np.bincount(owner[old], minlength=len(leaving)) == closing
    # and no two removals may make the same one: the cheaper stays
    owner, made = owner[~old], made[~old]
    sorted_made = np.sort(made)
    twice = np.isin(made, sorted_made[1:][sorted_made[1:] == sorted_made[:-1]])
    owner, made = owner[twice], made[twice]
    order = np.lexsort((leaving[owner], rank[owner], made))
    again = np.flatnonzero(made[order][1:] == made[order][:-1]) + 1
    good[owner[order[again]]] = False
    owner, one, two = corners
    stays = (one != onto[owner]) & (two != onto[owner])
    owner, one, two = owner[stays], one[stays], two[stays]
    for start in range(0, len(owner), AT_ONCE):
        some = slice(start, start + AT_ONCE)
        from_one, from_two = gathered(points, one[some]), gathered(points, two[some])
        here, there = gathered(points, leaving[owner[some]]), gathered(points, onto[owner[some]])
        spoils = _spoils(from_one, from_two, here, there)
        good[owner[some][spoils]] = False
    return good


def _spoils(one: FloatArray, two: FloatArray, here: FloatArray, there: FloatArray) -> np.ndarray:
    """Tell which triangles of `one`, `two` and `here` turn over or get thin when that corner goes `there`."""
    to_one, to_two, between = one - there, two - there, one - two
    before, after = cross(one - here, two - here), cross(to_one, to_two)
    size_before, size_after = np.sqrt(dot(before, before)), np.sqrt(dot(after, after))
    turned = dot(before, after) < _TURN * size_before * size_after
    longest = np.maximum.reduce([dot(side, side) for side in (between, to_one, to_two)])
    return np.asarray(turned | ((size_after < _THINNEST * longest) & (size_after < size_before)))


def _strands(
    corners: tuple[IntArray, IntArray, IntArray], links: _Links, leaving: IntArray, onto: IntArray, valence: IntArray
) -> np.ndarray:
    """Tell which removals would leave a vertex without a triangle, or take off what hangs on one vertex alone."""
    owner, one, two = corners
    closes = (one == onto[owner]) | (two == onto[owner])
    owner, tip = owner[closes], np.where(one == onto[owner], two, one)[closes]
    lost = np.bincount(tip, minlength=len(valence)) + np.bincount(onto[owner], minlength=len(valence))
    brought = valence[leaving] - np.bincount(owner, minlength=len(leaving))
    stranded = (brought < 1) & (lost[onto] >= valence[onto])
    kept, edge = np.unique(undirected_keys(onto[owner], tip, len(valence)), return_inverse=True)
    left = np.zeros(len(kept), dtype=np.int64)  # triangles on the edge between where a vertex goes and the tip
    left[edge] = links.triangles_on(onto[owner], tip)
    np.add.at(left, edge, links.triangles_on(leaving[owner], tip) - 2)  # one closes on either of its edges
    stranded[owner[left[edge] < 1]] = True
    return stranded


def _mean_value_weights(
    points: FloatArray, corners: tuple[IntArray, IntArray, IntArray], leaving: IntArray, number: IntArray, total: int
) -> csr_matrix:
    """Weigh the neighbours of each vertex so that it is their mean, seen along the surface."""
    from scipy.sparse import coo_matrix

    owner, one, two = corners
    pair = np.empty((2, len(owner)))
    for start in range(0, len(owner), AT_ONCE):
        some = slice(start, start + AT_ONCE)
        here = gathered(points, leaving[owner[some]])
        to_one, to_two = gathered(points, one[some]) - here, gathered(points, two[some]) - here
        length_one = np.maximum(np.sqrt(dot(to_one, to_one)), 1e-12)
        length_two = np.maximum(np.sqrt(dot(to_two, to_two)), 1e-12)
        cosine = dot(to_one, to_two) / (length_one * length_two)
        tangent = np.sqrt(np.maximum(1 - cosine, 0) / np.maximum(1 + cosine, 1e-6))  # of half the corner's angle
        pair[:, some] = tangent / length_one, tangent / length_two
    row = np.tile(owner, 2)
    weight = pair.ravel() + np.finfo(float).tiny
    weight /= np.bincount(row, weight, minlength=len(leaving))[row]
    return coo_matrix((weight, (row, number[np.concatenate([one, two])])), shape=(len(leaving), total)).tocsr()
