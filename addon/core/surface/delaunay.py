"""Intrinsic Delaunay triangulation and midpoint refinement: the same surface under better triangles."""

from __future__ import annotations

import numpy as np

from ..numerics.arrays import FloatArray, IntArray
from ..run.monitor import Monitor
from .triangulation import Triangulation, corner_cotangents, face_areas

_TIE = 1e-9  # cotangent sums above minus this count as Delaunay: squares are left as they are
_ROUNDS = 10_000  # of simultaneous flips; meshes with more vertices may take as many as they have


def intrinsic_delaunay(
    surface: Triangulation, monitor: Monitor | None = None, max_rounds: int | None = None
) -> Triangulation:
    """Flip edges inside the surface until every edge is locally Delaunay.

    The surface does not change: a flipped edge runs straight over the two triangles it crosses. Many edges are
    flipped at once, the worst first, never two in one triangle. Borders and edges of more than two triangles stay.

    `surface`: triangles of positive area; `max_rounds`: upper bound on the rounds of simultaneous flips, which
    rounding could otherwise continue forever; if omitted, 10,000 or the number of vertices, whichever is larger.

    Examples
    --------
    >>> from addon.core.surface.triangulation import triangulated
    >>> kite = np.array([[-2.0, 0, 0], [2, 0, 0], [0, -1, 0], [0, 1, 0]])
    >>> surface = triangulated(kite, np.array([[0, 2, 1], [0, 1, 3]]))
    >>> float(surface.lengths.max()), round(float(intrinsic_delaunay(surface).lengths.max()), 6)
    (4.0, 2.236068)

    References
    ----------
    Fisher, Springborn, Bobenko and Schroeder, "An Algorithm for the Construction of Intrinsic Delaunay
    Triangulations", 2006; Sharp and Crane, 2020, section 4.
    """
    faces, lengths, edges = surface.faces.copy(), surface.lengths.copy(), surface.edges.copy()
    twin = _twins(faces, edges)
    active = np.arange(len(faces))  # faces whose edges may have changed since they were last checked
    monitor = monitor or Monitor()
    for _ in range(max(_ROUNDS, surface.vertex_count) if max_rounds is None else max_rounds):
        monitor.check()
        chosen = _flippable(lengths, twin, active)
        if chosen.size == 0:
            break
        active = _flip(faces, lengths, edges, twin, chosen)
    else:
        monitor.warn("flips_exhausted")
    return Triangulation(surface.vertex_count, faces, lengths, edges)


def midpoint_refined(surface: Triangulation) -> Triangulation:
    """Split every triangle into four similar ones at the midpoints of its edges.

    `surface`: the surface.

    Examples
    --------
    >>> from addon.core.surface.triangulation import triangulated
    >>> triangle = triangulated(np.array([[0.0, 0, 0], [2, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]]))
    >>> fine = midpoint_refined(triangle)
    >>> fine.vertex_count, face_areas(fine.lengths).round(6).tolist()
    (6, [0.25, 0.25, 0.25, 0.25])
    """
    n, edge_count = surface.vertex_count, int(surface.edges.max()) + 1
    corner, opposite = surface.faces, surface.edges  # (m, 3)
    middle = n + opposite
    m = len(corner)
    inner = 2 * edge_count + 3 * np.arange(m)[:, None] + np.arange(3)  # edge inside the face, facing corner i
    side = np.roll(corner, -1, axis=1) > np.roll(corner, -2, axis=1)  # which half of edge i touches corner i + 1
    loop = np.roll(corner, -1, axis=1) == np.roll(corner, -2, axis=1)
    side = np.where(loop, _second_of_loop(surface), side).astype(np.int64)
    near_next, near_last = 2 * opposite + side, 2 * opposite + 1 - side  # halves of edge i at corners i + 1, i + 2
    half = surface.lengths / 2
    faces, lengths, edges = [middle], [half], [inner]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        faces.append(np.column_stack([corner[:, i], middle[:, k], middle[:, j]]))
        lengths.append(half[:, [i, j, k]])
        edges.append(np.column_stack([inner[:, i], near_last[:, j], near_next[:, k]]))
    return Triangulation(n + edge_count, np.concatenate(faces), np.concatenate(lengths), np.concatenate(edges))


def refined(surface: Triangulation, fewest: int, monitor: Monitor | None = None) -> Triangulation:
    """Split every triangle in four and make the parts Delaunay, until there are at least `fewest` vertices.

    The vertices of the surface come first.

    Examples
    --------
    >>> from addon.core.surface.triangulation import triangulated
    >>> triangle = triangulated(np.array([[0.0, 0, 0], [2, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]]))
    >>> refined(triangle, 0).vertex_count, refined(triangle, 7).vertex_count
    (6, 15)
    """
    fine = intrinsic_delaunay(midpoint_refined(surface), monitor)
    return fine if fine.vertex_count >= fewest else refined(fine, fewest, monitor)


def _second_of_loop(surface: Triangulation) -> np.ndarray:
    """Distinguish the two sides of an edge that joins a vertex to itself by the order of their faces."""
    flat = surface.edges.ravel()
    second = np.ones(len(flat), dtype=bool)
    second[np.unique(flat, return_index=True)[1]] = False
    return second.reshape(-1, 3)


def _twins(faces: IntArray, edges: IntArray) -> IntArray:
    """Match the half-edges (numbered 3·face + opposite corner) in pairs; -1 where there is no single partner."""
    order = np.argsort(edges.ravel(), kind="stable")
    _, start, count = np.unique(edges.ravel()[order], return_index=True, return_counts=True)
    first, second = order[start[count == 2]], order[start[count == 2] + 1]
    tail = np.roll(faces, -1, axis=1).ravel()
    opposed = tail[first] != tail[second]  # edges between oppositely oriented neighbours cannot be flipped
    twin = np.full(faces.size, -1, dtype=np.int64)
    twin[first[opposed]], twin[second[opposed]] = second[opposed], first[opposed]
    return twin


def _flippable(lengths: FloatArray, twin: IntArray, active: IntArray) -> IntArray:
    """Choose half-edges that violate the Delaunay condition, at most one per triangle, the worst first."""
    half = (3 * active[:, None] + np.arange(3)).ravel()
    half = half[twin[half] >= 0]
    half = np.unique(np.minimum(half, twin[half]))
    half = half[half // 3 != twin[half] // 3]
    left, right = half // 3, twin[half] // 3
    cotangents = corner_cotangents(lengths[left])[np.arange(len(half)), half % 3]
    cotangents += corner_cotangents(lengths[right])[np.arange(len(half)), twin[half] % 3]
    bad = cotangents < -_TIE
    half, left, right, cotangents = half[bad], left[bad], right[bad], cotangents[bad]
    rank = np.empty(len(half), dtype=np.int64)
    rank[np.argsort(cotangents, kind="stable")] = np.arange(len(half))
    best = np.full(len(lengths), len(half), dtype=np.int64)
    np.minimum.at(best, left, rank)
    np.minimum.at(best, right, rank)
    return half[(best[left] == rank) & (best[right] == rank)]


def _flip(faces: IntArray, lengths: FloatArray, edges: IntArray, twin: IntArray, half: IntArray) -> IntArray:
    """Flip the given half-edges in place and return the faces whose edges have to be checked again."""
    other = twin[half]
    left, right = half // 3, other // 3
    i, j = half % 3, other % 3
    i1, i2, j1, j2 = (i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3
    # left is (c, a, b) and right is (d, b, a), seen from the corners opposite to the edge a-b
    c, a, b, d = faces[left, i], faces[left, i1], faces[left, i2], faces[right, j]
    ab, bc, ca = lengths[left, i], lengths[left, i1], lengths[left, i2]
    ad, db = lengths[right, j1], lengths[right, j2]
    # lay both triangles out in the plane, a at the origin and b on the first axis
    c_along, d_along = (ca**2 - bc**2 + ab**2) / (2 * ab), (ad**2 - db**2 + ab**2) / (2 * ab)
    c_across = 2 * face_areas(np.column_stack([ab, bc, ca])) / ab
    d_across = 2 * face_areas(np.column_stack([ab, ad, db])) / ab
    cd = np.hypot(c_along - d_along, c_across + d_across)
    # the new triangles: left is (a, d, c), right is (b, c, d); the four outer half-edges move
    outer = np.concatenate([3 * left + i1, 3 * left + i2, 3 * right + j1, 3 * right + j2])
    moved = np.concatenate([3 * right + 2, 3 * left + 1, 3 * left + 2, 3 * right + 1])
    flat = edges.ravel()
    diagonal, rim = flat[half], flat[outer]
    new_slot = np.arange(len(twin))
    new_slot[outer] = moved
    partner = np.where(twin[outer] >= 0, new_slot[twin[outer]], -1)
    faces[left], faces[right] = np.column_stack([a, d, c]), np.column_stack([b, c, d])
    lengths[left], lengths[right] = np.column_stack([cd, ca, ad]), np.column_stack([cd, db, bc])
    flat[moved], flat[3 * left], flat[3 * right] = rim, diagonal, diagonal
    twin[moved] = partner
    twin[partner[partner >= 0]] = moved[partner >= 0]
    twin[3 * left], twin[3 * right] = 3 * right, 3 * left
    return np.unique(np.concatenate([left, right]))
