"""Pulls the surfaces of a body apart where a change of pose made them pass through each other."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..measures.crossings import crossings, passes
from ..mesh.coarsening import coarsened
from ..mesh.edges import edge_table, undirected_keys, vertex_pairs
from ..numerics.arrays import FloatArray, IntArray
from ..run.monitor import Monitor

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

_LARGE, _COARSE = 20_000, 10_000  # vertices of a mesh that is untangled coarsely first, and then
_ROUNDS = 30
_MOST = 1.0  # pairs that cross per triangle, beyond which a body is not touched but folded
_IDLE = 10  # rounds without fewer crossings, after which it ends
_STEP = 0.5  # of the length of the edges around a vertex, the farthest that it moves in a round
_RINGS = 3  # of triangles around those that cross, which move
_SMOOTHINGS = 4  # of the motion in each round
_FLAT = 0.1  # least sine of the angle between an edge and the triangle that it passes through
_SIDES = np.array([0.5, 0.5, -0.5, -0.5, -0.5])  # an edge and a triangle move apart, each by half
_LIGHT = 0.3  # weight of a vertex above which it moves by the mean of its motions
_FEW = 0.25  # share of neighbours that move, from which the mean motion is not reduced
_SHORT = 1e-3  # of the mean length, below which edges are equally stiff


class _Region(NamedTuple):
    """The part of a mesh that may move, with vertices and triangles of its own numbering."""

    vertices: IntArray  # in the whole mesh
    faces: IntArray
    size: FloatArray  # mean length of the edges at each vertex
    mean: csr_matrix  # (k, k), of a vertex and its neighbours, most of the nearest
    keys: IntArray  # (e,), ascending, of the edges
    thirds: IntArray  # (e, 2), third corners of the two triangles at each; -1 where there is only one


def untangled(before: FloatArray, after: FloatArray, faces: IntArray, monitor: Monitor) -> FloatArray:
    """Move vertices until triangles cross that crossed before, and as few others as possible.

    The line along which two parts of a surface pass through each other is shortened step by step: where an edge passes
    through a triangle, the two are moved relative to each other in the direction in which the line becomes shorter
    fastest, and the surface around them follows smoothly. It needs neither an inside nor an outside. Parts that pass
    through each other deeply may remain so: of all steps the one with the fewest crossings is returned. A body most of
    which crosses itself is returned as it is.

    `before` (n, 3); `after` (n, 3); `faces` (m, 3); gives (n, 3).

    Examples
    --------
    >>> before = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0], [1, 1, 1], [1, 1, 2], [3, 3, 2]], dtype=float)
    >>> after, faces = before.copy(), np.array([[0, 1, 2], [3, 4, 5]])
    >>> after[3, 2] = -0.1
    >>> found = untangled(before, after, faces, Monitor())
    >>> len(crossings(after, faces)), len(crossings(found, faces))
    (1, 0)

    References
    ----------
    Volino and Magnenat-Thalmann, "Resolving Surface Collisions through Intersection Contour Minimization", 2006,
    doi:10.1145/1141911.1142007.
    """
    pairs = _added(before, after, faces, monitor)
    if not 0 < len(pairs) < _MOST * len(faces):
        return after
    if len(before) > _LARGE:
        coarse = coarsened(before, faces, _COARSE, monitor=monitor)
        start, end = before[coarse.kept], after[coarse.kept]
        moved = _apart(start, end, coarse.faces, _added(start, end, coarse.faces, monitor), monitor)
        after = after + coarse.prolong(moved - end)
        pairs = _added(before, after, faces, monitor)
    return _apart(before, after, faces, pairs, monitor)


def _apart(before: FloatArray, after: FloatArray, faces: IntArray, pairs: IntArray, monitor: Monitor) -> FloatArray:
    """Pull the surface apart on one mesh."""
    if not len(pairs):
        return after
    region = _region(before, faces, pairs)
    start, points = before[region.vertices], after[region.vertices]
    best, fewest, idle = points, len(pairs), 0
    for _ in range(_ROUNDS):
        pairs = _added(start, points, region.faces, monitor)
        if len(pairs) < fewest:
            best, fewest, idle = points, len(pairs), 0
        if not len(pairs) or idle == _IDLE:
            break
        idle += 1
        points = points + _motion(points, region, pairs)
    moved = after.copy()
    moved[region.vertices] = best
    return moved


def _added(before: FloatArray, after: FloatArray, faces: IntArray, monitor: Monitor) -> IntArray:
    """Find the pairs of triangles that cross, and did not before."""
    pairs = crossings(after, faces, monitor)
    added = np.ones(len(pairs), dtype=bool)
    added[passes(before, faces, pairs).pairs] = False
    return pairs[added]


def _region(before: FloatArray, faces: IntArray, pairs: IntArray) -> _Region:
    """Cut out the surface around crossing triangles."""
    from scipy.sparse import csr_matrix, diags

    near = np.zeros(len(before), dtype=bool)
    near[faces[pairs]] = True
    for _ in range(_RINGS):
        near[faces[near[faces].any(axis=1)]] = True
    inside = np.flatnonzero(near)
    around = faces[near[faces].any(axis=1)]  # with vertices beyond, which stay
    vertices = np.unique(around)
    i, j = vertex_pairs(np.searchsorted(vertices, around)).T
    length = np.linalg.norm(before[vertices[i]] - before[vertices[j]], axis=1)
    count = len(vertices)
    ends, lengths = np.append(i, j), np.append(length, length)
    size = np.bincount(ends, lengths, count) / np.bincount(ends, minlength=count)
    stiffness = 1 / np.maximum(length, _SHORT * length.mean() or 1.0) ** 2
    links = csr_matrix((np.append(stiffness, stiffness), (ends, np.append(j, i))), shape=(count, count))
    mean = (diags(np.ones(count)) + diags(1 / np.asarray(links.sum(axis=1)).ravel()) @ links).tocsr() / 2
    moving = np.searchsorted(vertices, inside)
    own = np.searchsorted(inside, around[near[around].all(axis=1)])
    edges = edge_table(own)
    third = np.roll(own, -2, axis=1).ravel()[edges.order]
    second = np.where(edges.count > 1, third[np.minimum(edges.start + 1, len(third) - 1)], -1)
    first = edges.order[edges.start]
    keys = undirected_keys(edges.tail[first], edges.head[first], len(inside))
    return _Region(
        inside,
        own,
        size[moving],
        mean[moving][:, moving],
        keys,
        np.column_stack([third[edges.start], second]),
    )


def _motion(points: FloatArray, region: _Region, pairs: IntArray) -> FloatArray:
    """Find the motion that shortens the lines along which triangles cross."""
    found = passes(points, region.faces, pairs)
    key = undirected_keys(found.edges[:, 0], found.edges[:, 1], len(points))
    _, once = np.unique(key * len(region.faces) + found.faces, return_index=True)  # both triangles at an edge cross
    edges, through, along = found.edges[once], region.faces[found.faces[once]], found.along[once]
    a, p = points[through[:, 0]], points[edges[:, 0]]
    edge = _unit(points[edges[:, 1]] - p)
    normal = _unit(np.cross(points[through[:, 1]] - a, points[through[:, 2]] - a))
    rise = _dot(edge, normal)
    rise = np.where(np.abs(rise) < _FLAT, np.copysign(_FLAT, rise), rise)
    way = np.zeros_like(p)
    for third in region.thirds[np.searchsorted(region.keys, key[once])].T:
        inwards = points[third] - p
        inwards -= _dot(inwards, edge) * edge
        line = _unit(np.cross(normal, np.cross(edge, inwards)))
        line *= np.sign(_dot(line, inwards))
        way += (third >= 0)[:, None] * (line - 2 * _dot(edge, line) / rise * normal)
    size = np.minimum(region.size[edges].mean(axis=1), region.size[through].mean(axis=1))
    way *= (_STEP * size)[:, None] / np.sqrt(1 + _dot(way, way))
    share = np.column_stack([1 - along, along, found.weights[once]])  # (k, 5)
    vertex = np.column_stack([edges, through]).ravel()
    moves = ((_SIDES * share)[:, :, None] * way[:, None]).reshape(-1, 3)
    weight = np.bincount(vertex, share.ravel(), len(points))
    motion = np.column_stack([np.bincount(vertex, each, len(points)) for each in moves.T])
    spread = np.column_stack([motion / np.maximum(weight, _LIGHT)[:, None], weight > 0])
    for _ in range(_SMOOTHINGS):
        spread = region.mean @ spread
    return spread[:, :3] / np.maximum(spread[:, 3:], _FEW)


def _unit(vectors: FloatArray) -> FloatArray:
    """Divide vectors by their lengths."""
    return vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), np.finfo(float).tiny)


def _dot(one: FloatArray, two: FloatArray) -> FloatArray:
    """Multiply vectors, row by row."""
    return np.einsum("ij,ij->i", one, two)[:, None]
