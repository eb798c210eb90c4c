"""Where the pieces of a mesh lie near each other, measured between samples spread evenly over their surfaces."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..mesh.geometry import area_vectors, of_unit_area
from ..numerics.arrays import FloatArray, IntArray
from ..run.monitor import Monitor
from .pieces import Piece

if TYPE_CHECKING:
    from scipy.spatial import KDTree

SPACING = 0.008  # of the samples, in sqrt(area) of all pieces; vertices alone miss contacts of large faces
FARTHEST = 0.1  # largest distance between pieces that is measured, in the same unit
_FEWEST = 24  # samples of a piece
_ROUGH = 0.02  # spacing of the samples that decide what may belong together, in sqrt(area) of the piece
_GOLDEN = np.array([0.7548776662466927, 0.5698402909980532])  # of a plane: 1 / p, 1 / p² with p³ = p + 1


class Samples(NamedTuple):
    """Points spread evenly over a surface, as positions on its triangles.

    Attributes
    ----------
    corners : (s, 3) ndarray of int
        The corners of the triangle that each sample lies on, vertices of the piece.
    weights : (s, 3) ndarray of float
        Barycentric coordinates.
    points : (s, 3) ndarray of float
        Positions.
    normals : (s, 3) ndarray of float
        Unit normals of the triangles; 0 where a triangle has no area.
    area : float
        Area of the surface.
    """

    corners: IntArray
    weights: FloatArray
    points: FloatArray
    normals: FloatArray
    area: float

    def on(self, vertices: FloatArray) -> FloatArray:
        """Compute the positions of the samples after the vertices have moved. `vertices` (p, 3); gives (s, 3)."""
        return np.einsum("ij,ijk->ik", self.weights, vertices[self.corners])

    @property
    def nearest_corners(self) -> IntArray:
        """The corner nearest to each sample, a vertex of the piece, (s,)."""
        return self.corners[np.arange(len(self.corners)), np.argmax(self.weights, axis=1)]


class Contact(NamedTuple):
    """The distances of one piece from another.

    Attributes
    ----------
    distances : (s,) ndarray of float
        Distance of each sample from the nearest sample of the other; inf beyond `FARTHEST`.
    nearest : (s,) ndarray of int
        That sample; 0 where there is none.
    """

    distances: FloatArray
    nearest: IntArray

    @property
    def gap(self) -> float:
        """The smallest distance."""
        return float(self.distances.min())


def sampled(points: FloatArray, faces: IntArray, spacing: float = SPACING) -> Samples:
    """Spread samples evenly over a surface: one per square of the spacing, along the triangles in their order.

    `points` (n, 3); `faces` (m, 3); `spacing`: mean distance between samples.

    Examples
    --------
    >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
    >>> samples = sampled(square, np.array([[0, 1, 2], [1, 3, 2]]), 0.1)
    >>> samples.points.shape, np.allclose(samples.on(2 * square), 2 * samples.points)
    ((100, 3), True)

    References
    ----------
    The points inside a triangle follow the additive recurrence of the plastic number; the square is folded onto the
    triangle as by Osada, Funkhouser, Chazelle and Dobkin, "Shape Distributions", 2002, doi:10.1145/571647.571648.
    """
    normals = area_vectors(points, faces)
    areas = np.linalg.norm(normals, axis=1)
    ends = np.cumsum(areas)
    count = max(_FEWEST, round(float(ends[-1]) / spacing**2))
    face = np.searchsorted(ends, (np.arange(count) + 0.5) * ends[-1] / count)
    u, v = ((np.arange(1, count + 1)[:, None] * _GOLDEN) % 1.0).T
    over = u + v > 1
    u, v = np.where(over, 1 - u, u), np.where(over, 1 - v, v)
    weights = np.column_stack([1 - u - v, u, v])
    corners = faces[face]
    unit = normals[face] / np.maximum(areas[face], np.finfo(float).tiny)[:, None]
    return Samples(corners, weights, np.einsum("ij,ijk->ik", weights, points[corners]), unit, float(ends[-1]))


def contacts_between(
    pieces: Sequence[Piece], samples: Sequence[Samples], monitor: Monitor
) -> dict[tuple[int, int], Contact]:
    """Measure the distances between the pieces.

    `pieces`: the pieces, of unit area in total; `samples`: samples of each.

    Examples
    --------
    >>> triangle = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    >>> pieces = [Piece(np.arange(3), triangle + [0, 0, z], np.array([[0, 1, 2]])) for z in (0, 0.05, 9)]
    >>> samples = [sampled(piece.points, piece.faces, 0.02) for piece in pieces]
    >>> found = contacts_between(pieces, samples, Monitor())
    >>> list(found), round(found[0, 1].gap, 3)
    ([(0, 1), (1, 0)], 0.05)
    """
    from scipy.spatial import KDTree

    boxes = _boxes(pieces)
    trees = [KDTree(each.points) for each in samples]
    found = {}
    for i in range(len(pieces)):
        monitor.check()
        for j in np.flatnonzero(box_gaps(boxes, boxes[i]) < FARTHEST).tolist():
            if j == i:
                continue
            distances, nearest = trees[j].query(samples[i].points, distance_upper_bound=FARTHEST)
            here = np.isfinite(distances)
            if here.any():
                found[i, j] = Contact(distances, np.where(here, nearest, 0))
    return {pair: contact for pair, contact in found.items() if pair[::-1] in found}


def neighbourhoods(pieces: Sequence[Piece]) -> list[list[Piece]]:
    """Group the pieces that may belong together: those close to each other, relative to the size of the larger.

    Bounding boxes, which depend on the orientation of the mesh, only save measurements.

    `pieces`: the pieces, largest area first, in any unit.

    Examples
    --------
    >>> triangle = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    >>> pieces = [Piece(np.arange(3), triangle + [0, 0, z], np.array([[0, 1, 2]])) for z in (0, 0.05, 9)]
    >>> [len(group) for group in neighbourhoods(pieces)]
    [2, 1]
    """
    from scipy.spatial import KDTree

    boxes = _boxes(pieces)
    sizes = np.array([piece.size for piece in pieces])
    corners: dict[int, KDTree] = {}
    clouds: dict[int, KDTree] = {}
    label = np.arange(len(pieces))
    for i in range(len(pieces) - 1):
        within = FARTHEST * np.maximum(sizes[i], sizes[i + 1 :])
        for j in (i + 1 + np.flatnonzero(box_gaps(boxes[i + 1 :], boxes[i]) < within)).tolist():
            if label[i] == label[j]:
                continue
            reach = FARTHEST * max(sizes[i], sizes[j]) / sizes.max()
            for piece in {i, j} - corners.keys():
                corners[piece] = KDTree(pieces[piece].points / sizes.max())
            near = _come_near(corners[i], corners[j], reach)  # which is most often so, and takes less time
            for piece in {i, j} - clouds.keys() if not near else ():
                clouds[piece] = KDTree(cloud(pieces[piece], float(sizes.max())))
            if near or _come_near(clouds[i], clouds[j], reach):
                label[label == label[j]] = label[i]
    groups: dict[int, list[Piece]] = {}
    for piece, each in zip(pieces, label.tolist(), strict=True):
        groups.setdefault(each, []).append(piece)
    return list(groups.values())


def box_gaps(boxes: FloatArray, box: FloatArray) -> FloatArray:
    """Measure the distances of bounding boxes from one of them, which those of what they contain exceed.

    `boxes` (p, 2, 3): lowest and highest corners; `box` (2, 3); gives (p,).

    Examples
    --------
    >>> cube = np.array([[0.0, 0, 0], [1, 1, 1]])
    >>> box_gaps(np.array([cube, cube + [4, 5, 0]]), cube).tolist()
    [0.0, 5.0]
    """
    beside = np.maximum(np.maximum(boxes[:, 0] - box[1], box[0] - boxes[:, 1]), 0.0)
    return np.asarray(np.linalg.norm(beside, axis=1))


def _boxes(pieces: Sequence[Piece]) -> FloatArray:
    """Bound the pieces, (p, 2, 3)."""
    return np.array([[piece.points.min(axis=0), piece.points.max(axis=0)] for piece in pieces])


def cloud(piece: Piece, unit: float) -> FloatArray:
    """Spread some samples over a piece.

    `piece`: the piece; `unit`: unit of length of the result; one in which no distance underflows; gives (s, 3).

    Examples
    --------
    >>> cloud(Piece(np.arange(3), np.eye(3), np.array([[0, 1, 2]])), 2.0).sum(axis=1).round(6).max().item()
    0.5
    """
    points, centre, size = of_unit_area(piece.points, piece.faces)
    return sampled(points, piece.faces, _ROUGH).points * (size / unit) + centre / unit


def _come_near(one: KDTree, two: KDTree, within: float) -> bool:
    """Check whether a point of one cloud lies within a distance of one of the other."""
    few, many = sorted((one, two), key=lambda cloud: cloud.n)
    return bool(np.isfinite(many.query(few.data, distance_upper_bound=within)[0]).any())
