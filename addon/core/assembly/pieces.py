"""The connected pieces of a mesh."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ..mesh.connectivity import component_labels
from ..mesh.geometry import component_areas, of_unit_area
from ..mesh.repair import repaired
from ..numerics.arrays import FloatArray, IntArray
from ..run.errors import InvalidMeshError
from ..run.messages import Message, message
from ..run.monitor import Monitor
from .strays import drawn_in, stray_vertices

MEASURED = 100  # largest pieces, whose distances from each other are all measured; the others ride on what is nearest
MOST_PIECES = 500  # more are loose faces, unless one is large enough to carry the others, like a head cards of hair
_MOST_CARRIED, _CARRIES = 20_000, 0.05  # pieces then, and least share of the largest in the whole area
NO_AREA = 1e-12  # in squares of half the size; rounding errors are a thousandth of it
_ALIKE = 1e-6  # share of the whole area within which two pieces count as equally large


@dataclass(frozen=True, eq=False)
class Piece:
    """One connected surface.

    Attributes
    ----------
    vertices : (p,) ndarray of int
        Its vertices among those of the mesh, ascending.
    points : (p, 3) ndarray of float
        Their positions.
    faces : (q, 3) ndarray of int
        Its triangles; corners index `vertices`.
    """

    vertices: IntArray
    points: FloatArray
    faces: IntArray

    @cached_property
    def size(self) -> float:
        """Square root of its area, in the unit of the points."""
        return of_unit_area(self.points, self.faces)[2]


@dataclass(frozen=True, eq=False)
class Pieces:
    """A mesh as connected surfaces.

    Attributes
    ----------
    pieces : list of Piece
        The surfaces, largest area first.
    vertices : (n, 3) ndarray of float
        Positions of all vertices, as given.
    faces : (m, 3) ndarray of int
        Triangles of all pieces, as corners of the mesh.
    unjoined : (m, 3) ndarray of int
        The same triangles with the vertices that they have in the mesh as given: of coincident ones each its own.
    representative : (n,) ndarray of int
        The vertex that each vertex is identified with: itself, or the first at its position along a seam.
    repairs : list of Message
        Differences from the mesh as given.
    dropped : int
        Number of components left out because they have no area.
    loose : int
        Number of vertices that belong to no face.
    strays : (s,) ndarray of int
        Vertices far from their neighbours.
    drawn_in : (n, 3) ndarray of float
        Positions that the surfaces have: strays in the middle of their neighbours, all others as given.
    """

    pieces: list[Piece]
    vertices: FloatArray
    faces: IntArray
    unjoined: IntArray
    representative: IntArray
    repairs: list[Message]
    dropped: int
    loose: int
    strays: IntArray
    drawn_in: FloatArray

    @property
    def left_out(self) -> list[Message]:
        """Messages on pieces without area, vertices without a face and stray vertices."""
        counts = {
            "pieces_without_area": self.dropped,
            "loose_vertices": self.loose,
            "stray_vertices": len(self.strays),
        }
        return [message(kind, count=count) for kind, count in counts.items() if count]


def connected_pieces(
    vertices: ArrayLike,
    faces: ArrayLike,
    monitor: Monitor | None = None,
) -> Pieces:
    """Find the connected surfaces in a mesh.

    `vertices` (n, 3); `faces` (m, 3).

    Examples
    --------
    >>> corner = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    >>> two = connected_pieces(corner + [[x, y, 1] for x, y, _ in corner], [[0, 1, 2], [3, 4, 5]])
    >>> len(two.pieces), two.left_out
    (2, [])
    """
    monitor = monitor or Monitor()
    mesh = repaired(vertices, faces, monitor)
    points, corners = mesh.vertices, mesh.faces
    label = component_labels(len(points), np.concatenate([corners[:, :2], corners[:, 1:]]))[corners[:, 0]]
    monitor.check()
    start, first = np.zeros(min(len(corners), 1), dtype=np.int64), label[:1]
    if (label != label[:1]).any():
        order = np.argsort(label, kind="stable")
        corners, start = corners[order], np.concatenate([start, np.flatnonzero(np.diff(label[order])) + 1])
        first = label[order][start]
    if len(start) > _MOST_CARRIED:
        raise InvalidMeshError("too_many_pieces", count=len(start), most=_MOST_CARRIED)
    area, size = component_areas(points, corners, start)
    monitor.check()
    order = _largest_first(area, size)
    if not len(order):
        raise InvalidMeshError("no_area")
    strays = stray_vertices(points, mesh.faces)
    if len(strays):
        points = drawn_in(points, mesh.faces, strays)
    monitor.check()
    groups = np.split(corners, start[1:])
    pieces = [_piece(points, groups[index]) for index in order]
    dropped = len(groups) - len(pieces)
    used = np.isin(label, first[order]) if dropped else slice(None)
    on_surface = np.zeros(len(points), dtype=bool)
    on_surface[corners] = True
    loose = int(np.count_nonzero(~on_surface[mesh.representative]))
    return Pieces(
        pieces,
        mesh.vertices,
        mesh.faces[used],
        mesh.unjoined[used],
        mesh.representative,
        mesh.warnings,
        dropped,
        loose,
        strays,
        points,
    )


def _largest_first(area: FloatArray, size: FloatArray) -> IntArray:
    """Sort components that have any area by descending area; equally large ones keep the order of the mesh."""
    usable = np.flatnonzero(area > NO_AREA)
    if len(usable) < 2:
        return usable
    areas = area[usable] * (size[usable] / size[usable].max()) ** 2
    share = areas / areas.sum()
    if len(usable) > MOST_PIECES and share.max() < _CARRIES:
        raise InvalidMeshError("too_many_pieces", count=len(usable), most=MOST_PIECES)
    return usable[np.argsort(-np.round(share / _ALIKE), kind="stable")]


def _piece(points: FloatArray, faces: IntArray) -> Piece:
    """Make a piece of some triangles, with its own vertex numbers."""
    if faces.size < len(points):
        vertices, corners = np.unique(faces, return_inverse=True)
        return Piece(vertices, points[vertices], corners.reshape(-1, 3).astype(np.int64))
    used = np.zeros(len(points), dtype=bool)
    used[faces] = True
    vertices = np.flatnonzero(used)
    if len(vertices) == len(points):
        return Piece(vertices, points, faces)
    number = np.cumsum(used) - 1
    return Piece(vertices, points[vertices], number[faces])
