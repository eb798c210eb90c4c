"""A mesh parted along triangles that are taken out, or along edges: both lips are closed by caps."""

from __future__ import annotations

import heapq
from typing import NamedTuple

import numpy as np

from ..mesh.connectivity import component_labels
from ..mesh.edges import EdgeTable, edge_table, undirected_keys, vertex_pairs
from ..mesh.geometry import area_vectors
from ..numerics.arrays import BoolArray, FloatArray, IntArray

_OLD = 0.5  # share of a border that is of a hole of before, from which it stays open
_LEAST = 0.01  # of the area: what comes off and is smaller is left out
_TAKEN = 10.0  # cost of an ear whose diagonal is an edge already: it would have four triangles
_POSE = 0.2  # weight of the length of a cap's edges in the pose, beside that at rest
_LONGEST = 0.03  # sqrt(area): inner edges of caps are split until they are shorter
_ROUNDS = 4  # of splitting
_INWARD = 0.12  # way of a doubled vertex to the middle of its own triangles, so that repair does not join it again


class PartedMesh(NamedTuple):
    """A mesh that was parted.

    Attributes
    ----------
    vertices : (n', 3) ndarray of float
        Its vertices.
    faces : (m', 3) ndarray of int
        Its triangles; those of the caps come last.
    origin : (n',) ndarray of int
        The vertex of the given mesh that each is; -1 for those of caps.
    caps : int
        How many caps it has.
    first_of_caps : int
        The number of their first triangle.
    """

    vertices: FloatArray
    faces: IntArray
    origin: IntArray
    caps: int
    first_of_caps: int

    def copies(self, count: int) -> IntArray:
        """Return the first copy of each of `count` given vertices, -1 for those that are gone."""
        first, own = np.full(count, -1), np.flatnonzero(self.origin >= 0)[::-1]
        first[self.origin[own]] = own
        return first


class OpenMesh(NamedTuple):
    """A mesh that was parted and is not closed yet.

    Attributes
    ----------
    vertices : (n', 3) ndarray of float
        Its vertices, where they were.
    faces : (m', 3) ndarray of int
        Its triangles.
    origin : (n',) ndarray of int
        The vertex of the given mesh that each is.
    lips : list of list of int
        The borders at which it was parted, each in the direction of triangles that would close it.
    """

    vertices: FloatArray
    faces: IntArray
    origin: IntArray
    lips: list[list[int]]

    @property
    def apart(self) -> FloatArray:
        """The vertices, with lips moved apart so that repair does not join them again, (n', 3)."""
        return _moved_apart(self.vertices, self.faces, self.origin)


def laid_open(vertices: FloatArray, faces: IntArray, gone: BoolArray, cut: IntArray, unit: float) -> OpenMesh:
    """Take triangles out of a mesh, and part edges and what only a vertex holds together.

    `vertices` (n, 3), `faces` (m, 3); `gone` (m,): triangles to take out; `cut` (e, 2): edges to part; `unit`:
    sqrt(area) of the body.

    Examples
    --------
    >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    >>> found = laid_open(square, np.array([[0, 1, 2], [0, 2, 3]]), np.zeros(2, dtype=bool), np.array([[0, 2]]), 1.0)
    >>> len(found.vertices), [len(each) for each in found.lips]
    (6, [])
    """
    count = len(vertices)
    areas = np.linalg.norm(area_vectors(vertices, faces), axis=1)
    cuts = undirected_keys(cut[:, 0], cut[:, 1], count)
    open_before = _border_keys(faces, count)
    gone = _without_flaps(faces, gone, open_before, count)
    kept = faces[~gone]
    piece, before = _pieces(kept, cuts, count), _pieces(faces, cuts[:0], count)
    large = np.bincount(piece, areas[~gone])[piece] > _LEAST * unit**2
    speck = np.bincount(before, areas)[before][~gone] <= _LEAST * unit**2  # it was small from the beginning
    corners, origin = _split_at_vertices(kept[large | speck], cuts, count)
    points, lips = vertices[origin], []
    for loop in _border_loops(corners):
        own, sides = origin[loop], np.linalg.norm(points[loop] - points[np.roll(loop, -1)], axis=1)
        known = np.isin(undirected_keys(own, np.roll(own, -1), count), open_before)
        if len(loop) > 2 and sides[known].sum() < _OLD * sides.sum():
            lips.append(loop)
    return OpenMesh(points, corners, origin, lips)


def capped(mesh: OpenMesh, rest: FloatArray, unit: float) -> PartedMesh:
    """Close the lips of a mesh; borders that it had before stay open.

    Caps are made of ears, first those that are short at rest, and not in the pose: there both lips lie against each
    other.

    `rest` (n', 3): its vertices at rest, in units of sqrt(area); `unit`: sqrt(area) of the body.

    Examples
    --------
    >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    >>> found = capped(OpenMesh(square, np.empty((0, 3), dtype=int), np.arange(4), [[0, 1, 2, 3]]), square, 100.0)
    >>> len(found.faces), found.caps
    (2, 1)
    """
    points, done = mesh.vertices, [mesh.faces]
    at_lip = np.zeros(len(points), dtype=bool)
    at_lip[[vertex for lip in mesh.lips for vertex in lip]] = True
    edges = vertex_pairs(mesh.faces)
    edges = edges[at_lip[edges].all(axis=1)]
    for lip in mesh.lips:
        cap = _ears(lip, rest, points / unit, _between(np.array(lip), edges))
        points, rest, cap = _refined(points, rest, cap, _LONGEST * unit)
        done.append(cap)
    triangles = np.concatenate(done)
    origin = np.append(mesh.origin, np.full(len(points) - len(mesh.vertices), -1))
    return PartedMesh(_moved_apart(points, triangles, origin), triangles, origin, len(mesh.lips), len(mesh.faces))


def _without_flaps(faces: IntArray, gone: BoolArray, open_before: IntArray, count: int) -> BoolArray:
    """Take out also what hangs on the rest by one edge: a cap would lay the same triangle over it."""
    gone = gone.copy()
    while True:
        left = np.flatnonzero(~gone)
        table = edge_table(faces[left])
        alone = table.alone
        keys = undirected_keys(table.tail[alone], table.head[alone], count)
        new = np.bincount(alone[~np.isin(keys, open_before)] // 3, minlength=len(left))
        flaps = left[new > 1]
        if len(flaps) == 0 or not gone.any():
            return gone
        gone[flaps] = True


def _joints(faces: IntArray, cuts: IntArray, count: int) -> tuple[EdgeTable, IntArray, IntArray]:
    """Return the half-edges of triangles, and those pairs of them that join two triangles, by number.

    `cuts`: keys of the edges, of `count` vertices, that join nothing.
    """
    table = edge_table(faces)
    rank = np.arange(3 * len(faces)) - np.repeat(table.start, table.count)
    later = np.flatnonzero(rank > 0)
    one, two = table.order[later - 1], table.order[later]
    if len(cuts):
        whole = ~np.isin(undirected_keys(table.tail[one], table.head[one], count), cuts)
        one, two = one[whole], two[whole]
    return table, one, two


def piece_count(faces: IntArray) -> int:
    """Count the pieces of a mesh, which are connected over edges.

    `faces` (m, 3).

    Examples
    --------
    >>> piece_count(np.array([[0, 1, 2], [2, 3, 4]]))
    2
    """
    return int(_pieces(faces, np.empty(0, dtype=np.int64), int(faces.max(initial=0)) + 1).max(initial=-1)) + 1


def _pieces(faces: IntArray, cuts: IntArray, count: int) -> IntArray:
    """Label triangles that are connected over edges, (m,)."""
    _, one, two = _joints(faces, cuts, count)
    return component_labels(len(faces), np.column_stack([one // 3, two // 3]))


def _split_at_vertices(faces: IntArray, cuts: IntArray, count: int) -> tuple[IntArray, IntArray]:
    """Double the vertices where several fans meet, so that each border vertex lies on one border.

    Gives the triangles, and the given vertex that each vertex is.
    """
    table, one, two = _joints(faces, cuts, count)  # half-edges, which begin at a corner of the same number
    corner = np.arange(3 * len(faces))
    following = 3 * (corner // 3) + (corner + 1) % 3  # next corner of the triangle
    ends = [(each, following[each]) for each in (one, two)]
    alike = table.tail[one] == table.tail[two]
    second = [np.where(alike, ends[1][0], ends[1][1]), np.where(alike, ends[1][1], ends[1][0])]
    pairs = np.column_stack([np.concatenate(ends[0]), np.concatenate(second)])
    fan = component_labels(len(corner), pairs)
    _, first, corners = np.unique(fan, return_index=True, return_inverse=True)
    return corners.reshape(-1, 3), faces.ravel()[first]


def _border_keys(faces: IntArray, count: int) -> IntArray:
    """List the edges at borders."""
    table = edge_table(faces)
    return undirected_keys(table.tail[table.alone], table.head[table.alone], count)


def _border_loops(faces: IntArray) -> list[list[int]]:
    """List the borders as loops, in the direction of triangles that would close them."""
    table = edge_table(faces)
    after = dict(zip(table.head[table.alone].tolist(), table.tail[table.alone].tolist(), strict=True))
    loops = []
    while after:
        start, at = after.popitem()
        loop = [start]
        while at != start and at in after:
            loop.append(at)
            at = after.pop(at)
        if at == start:
            loops.append(loop)
    return loops


def _between(loop: IntArray, edges: IntArray) -> set[tuple[int, int]]:
    """List the pairs of a border, by their positions in it, that one of some edges joins. `edges` (e, 2)."""
    order = np.argsort(loop)
    ends = order[np.minimum(np.searchsorted(loop, edges, sorter=order), len(loop) - 1)]
    here = (loop[ends] == edges).all(axis=1)
    return {(min(pair), max(pair)) for pair in ends[here].tolist()}


def _ears(loop: list[int], rest: FloatArray, points: FloatArray, taken: set[tuple[int, int]]) -> IntArray:
    """Close a border by ears, those with the shortest diagonal first.

    `rest`, `points` (n, 3); `taken`: pairs of positions in the border that an edge joins already; gives (t, 3).
    """
    count = len(loop)
    before, after = [(k - 1) % count for k in range(count)], [(k + 1) % count for k in range(count)]
    there, here = rest[loop], points[loop]

    def cost(ear: int) -> float:
        one, two = before[ear], after[ear]
        own = _TAKEN if (min(one, two), max(one, two)) in taken else 0.0
        return float(own + np.linalg.norm(there[one] - there[two]) + _POSE * np.linalg.norm(here[one] - here[two]))

    queue = [(cost(k), k, 0) for k in range(count)]
    heapq.heapify(queue)
    age, found, left = [0] * count, [], count
    while left > 3:
        _, ear, known = heapq.heappop(queue)
        if known != age[ear]:
            continue
        one, two = before[ear], after[ear]
        found.append((loop[one], loop[ear], loop[two]))
        age[ear], after[one], before[two], left = -1, two, one, left - 1
        for each in (one, two):
            age[each] += 1
            heapq.heappush(queue, (cost(each), each, age[each]))
    last = next(k for k in range(count) if age[k] >= 0)
    found.append((loop[before[last]], loop[last], loop[after[last]]))
    return np.array(found)


def _refined(
    points: FloatArray, rest: FloatArray, cap: IntArray, longest: float
) -> tuple[FloatArray, FloatArray, IntArray]:
    """Split the inner edges of a cap that are long in the pose; its border stays."""
    for _ in range(_ROUNDS):
        table = edge_table(cap)
        first = table.order[table.start]
        ends = np.column_stack([table.tail[first], table.head[first]])
        split = (table.count == 2) & (np.linalg.norm(points[ends[:, 0]] - points[ends[:, 1]], axis=1) > longest)
        if not split.any():
            break
        middle = np.full(len(ends), -1)
        middle[split] = len(points) + np.arange(split.sum())
        points, rest = (np.concatenate([each, each[ends[split]].mean(axis=1)]) for each in (points, rest))
        edge = np.empty(3 * len(cap), dtype=np.int64)
        edge[table.order] = np.repeat(np.arange(len(ends)), table.count)
        cap = np.array([each for face, own in zip(cap, middle[edge].reshape(-1, 3), strict=True)
                        for each in _divided(face.tolist(), own.tolist())])  # fmt: skip
    return points, rest, cap


def _divided(face: list[int], middle: list[int]) -> list[tuple[int, ...]]:
    """Divide a triangle at the middles of its edges; -1 where an edge is whole."""
    a, b, c = face
    x, y, z = middle
    if min(middle) >= 0:
        return [(a, x, z), (x, b, y), (z, y, c), (x, y, z)]
    ring = [each for each in (a, x, b, y, c, z) if each >= 0]
    start = next((k for k, each in enumerate(ring) if each in middle), 0)
    ring = ring[start:] + ring[:start]
    return [(ring[0], ring[k], ring[k + 1]) for k in range(1, len(ring) - 1)]


def _moved_apart(points: FloatArray, faces: IntArray, origin: IntArray) -> FloatArray:
    """Move copies of one vertex a little to the middle of their own triangles."""
    copies = np.bincount(origin[origin >= 0], minlength=int(origin.max(initial=-1)) + 1)
    doubled = (origin >= 0) & (copies[origin] > 1)
    around = np.bincount(faces.ravel(), minlength=len(points))
    middle = np.repeat(points[faces].mean(axis=1), 3, axis=0)
    own = np.column_stack([np.bincount(faces.ravel(), middle[:, axis], len(points)) for axis in range(3)])
    own = own / np.maximum(around, 1)[:, None]
    return np.where(doubled[:, None], points + _INWARD * (own - points), points)
