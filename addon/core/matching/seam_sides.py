"""The two sides of a seam in a match: copies of one place, and what lies on either side of the other mesh's seam."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..mesh.edges import edge_table
from ..numerics.arrays import FloatArray, IntArray


class CutSurface(NamedTuple):
    """A surface that seams cut.

    Attributes
    ----------
    points : (n, 3) ndarray of float
        Positions.
    joined : (n,) ndarray of int
        The vertex that stands for each: itself, or the first at its place.
    faces : (m, 3) ndarray of int
        Triangles of vertices that stand for others.
    unjoined : (m, 3) ndarray of int
        The same triangles with the vertices of the mesh as given.
    """

    points: FloatArray
    joined: IntArray
    faces: IntArray
    unjoined: IntArray


class SeamSides(NamedTuple):
    """Vertices along a seam of one mesh that match a seam of the other, each on its own side.

    Attributes
    ----------
    vertices : (k,) ndarray of int
        The vertices, copies of others.
    faces : (k,) ndarray of int
        The triangle of the other mesh on the same side of its seam.
    weights : (k, 3) ndarray of float
        Barycentric coordinates there of a point on the seam, one for all copies of a place.
    """

    vertices: IntArray
    faces: IntArray
    weights: FloatArray


class _Seam(NamedTuple):
    """Edges along which triangles do not share their vertices: ends (e, 2), half-edges on either side (2, e)."""

    ends: IntArray
    halves: IntArray


def seam_sides(here: CutSurface, there: CutSurface, faces: IntArray, weights: FloatArray) -> SeamSides:
    """Find the copies of one place whose surroundings match different sides of a seam, and give each its side.

    `here`, `there`: the mesh and the other; `faces` (n,); `weights` (n, 3): the match.

    Examples
    --------
    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0], [0, 1, 0]])
    >>> cut = CutSurface(points, np.array([0, 1, 2, 3, 1, 2]), np.array([[0, 1, 2], [1, 3, 2]]),
    ...                  np.array([[0, 1, 2], [4, 3, 5]]))
    >>> at = np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, 1], [0, 1, 0], [0, 1, 0], [0, 0, 1]])
    >>> found = seam_sides(cut, cut, np.array([0, 0, 0, 1, 0, 0]), at)
    >>> found.vertices.tolist(), found.faces.tolist()
    ([1, 2, 4, 5], [0, 0, 1, 1])
    """
    copies = np.flatnonzero((np.bincount(here.joined)[here.joined] > 1) & (faces >= 0))
    seam = _seam(there)
    nothing = SeamSides(copies[:0], copies[:0], np.zeros((0, 3)))
    if not len(copies) or not len(seam.ends):
        return nothing
    places, place = np.unique(here.joined[copies], return_inverse=True)
    edge, share = _nearest_edge(there, seam, faces[places], weights[places])
    known = edge[place] >= 0
    copies, place = copies[known], place[known]
    edge, share = edge[place], share[place]
    matched = np.einsum("ij,ijk->ik", weights, there.points[there.faces[faces]])  # (n, 3)
    around = _mean_around(here.unjoined, np.where((faces >= 0)[:, None], matched, np.nan))[copies]
    beyond = _mean_around(there.unjoined, there.points)
    apart = np.array([np.linalg.norm(around - beyond[own], axis=1) for own in _corners(there, seam, edge, share)])
    side = np.where(apart[1] < apart[0], 1, 0)
    count = len(places)
    mixed = (np.bincount(place[side == 0], minlength=count) > 0) & (np.bincount(place[side == 1], minlength=count) > 0)
    own = np.flatnonzero(mixed[place])
    if not len(own):
        return nothing
    half = seam.halves[side[own], edge[own]]
    forward = there.faces.ravel()[half] == seam.ends[edge[own], 0]
    at_tail = np.where(forward, 1 - share[own], share[own])
    at = np.zeros((len(own), 3))
    rows = np.arange(len(own))
    at[rows, half % 3], at[rows, (half + 1) % 3] = at_tail, 1 - at_tail
    return SeamSides(copies[own], half // 3, at)


def _seam(surface: CutSurface) -> _Seam:
    """List the edges whose two triangles have different vertices at one of its ends."""
    table = edge_table(surface.faces)
    start = table.start[table.count == 2]
    one, other = table.order[start], table.order[start + 1]
    follower = np.arange(len(table.order)).reshape(-1, 3)[:, [1, 2, 0]].ravel()
    corner = surface.unjoined.ravel()
    like = table.tail[one] == table.tail[other]
    tails = np.where(like, corner[other], corner[follower[other]])
    heads = np.where(like, corner[follower[other]], corner[other])
    cut = (corner[one] != tails) | (corner[follower[one]] != heads)
    return _Seam(np.column_stack([table.tail[one], table.head[one]])[cut], np.stack([one, other])[:, cut])


def _nearest_edge(there: CutSurface, seam: _Seam, faces: IntArray, weights: FloatArray) -> tuple[IntArray, FloatArray]:
    """Find the seam's edge that is nearest to each point among those at the corners of its triangle, -1 for none."""
    corners = there.faces[faces]  # (q, 3)
    points = np.einsum("ij,ijk->ik", weights, there.points[corners])
    order = np.argsort(seam.ends, axis=None, kind="stable")
    vertex, edge = seam.ends.ravel()[order], order // 2
    first, last = (np.searchsorted(vertex, corners.ravel(), side) for side in ("left", "right"))  # type: ignore[call-overload]
    number = last - first
    point = np.repeat(np.repeat(np.arange(len(faces)), 3), number)
    run = np.arange(number.sum()) - np.repeat(np.cumsum(number) - number, number)
    candidate = edge[np.repeat(first, number) + run]
    start, end = there.points[seam.ends[candidate].T]
    along = end - start
    squared = np.maximum(np.einsum("ij,ij->i", along, along), np.finfo(float).tiny)
    share = np.clip(np.einsum("ij,ij->i", points[point] - start, along) / squared, 0, 1)
    apart = np.linalg.norm(points[point] - start - share[:, None] * along, axis=1)
    best = np.lexsort((candidate, apart, point))
    best = best[np.concatenate([[True], np.diff(point[best]) > 0])] if len(best) else best
    found, at = np.full(len(faces), -1), np.zeros(len(faces))
    found[point[best]], at[point[best]] = candidate[best], share[best]
    return found, at


def _mean_around(faces: IntArray, places: FloatArray) -> FloatArray:
    """Average places (n, 3) over the other corners of the triangles of each vertex, as far as they are known."""
    vertex, other = faces[:, [0, 0, 1, 1, 2, 2]].ravel(), faces[:, [1, 2, 2, 0, 0, 1]].ravel()
    known = np.isfinite(places[other, 0])
    vertex, other = vertex[known], other[known]
    count = np.maximum(np.bincount(vertex, minlength=len(places)), 1)
    return np.column_stack([np.bincount(vertex, places[other, axis], len(places)) / count for axis in range(3)])


def _corners(there: CutSurface, seam: _Seam, edge: IntArray, share: FloatArray) -> IntArray:
    """List the copies (2, k) on either side of edges at the nearer end, or at the other if the seam ends there."""
    halves = seam.halves[:, edge]
    follower = halves // 3 * 3 + (halves + 1) % 3
    corner = there.unjoined.ravel()
    forward = there.faces.ravel()[halves] == seam.ends[edge, 0]
    start, end = (
        np.where(forward, corner[one], corner[other]) for one, other in ((halves, follower), (follower, halves))
    )
    at_start = np.where(share < 0.5, start[0] != start[1], end[0] == end[1])
    return np.where(at_start, start, end)
