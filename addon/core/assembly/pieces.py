"""The connected pieces of a mesh: each is worked on by itself, and the results are gathered on all vertices."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from ..mesh.connectivity import component_labels
from ..mesh.geometry import component_areas
from ..mesh.repair import repaired
from ..numerics.arrays import FloatArray, IntArray
from ..run.errors import InvalidMeshError, InvalidSettingsError
from ..run.messages import Message, message
from ..run.monitor import Monitor, Plan

Result = TypeVar("Result")

_MOST = 500  # pieces; more are loose faces, or cards of hair and leaves, whose patches nobody could use
_SHOWN = 5  # warnings about pieces that are passed on one by one
_NO_AREA = 1e-12  # squares of half the size; rounding leaves a thousandth of it
_ALIKE = 1e-6  # share of the whole area within which two pieces count as equally large


@dataclass(frozen=True, eq=False)
class Piece:
    """One connected surface.

    Attributes
    ----------
    vertices : (p,) ndarray of int
        Its vertices among those of the mesh, rising.
    points : (p, 3) ndarray of float
        Their positions.
    faces : (q, 3) ndarray of int
        Its triangles; corners index `vertices`.
    """

    vertices: IntArray
    points: FloatArray
    faces: IntArray


@dataclass(frozen=True, eq=False)
class Chosen:
    """Vertices that the user chose, as far as they lie in one piece.

    Attributes
    ----------
    positions : (t,) ndarray of int
        Their places in the list that the user gave, rising.
    vertices : (t,) ndarray of int
        The same as vertices of the piece.
    """

    positions: IntArray
    vertices: IntArray


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
    chosen : list of Chosen or None
        Feature points chosen by hand, one item per piece; None where they are to be detected.
    repairs : list of Message
        What was different from the mesh as given.
    dropped : int
        Number of components left out because they have no area.
    loose : int
        Number of vertices that belong to no face.
    """

    pieces: list[Piece]
    vertices: FloatArray
    faces: IntArray
    chosen: list[Chosen | None]
    repairs: list[Message]
    dropped: int
    loose: int
    _representative: IntArray
    _given: Sequence[int] | None

    def map(self, work: Callable[..., Result], monitor: Monitor, plan: Plan, *of_each: Sequence[Any]) -> list[Result]:
        """Work on every piece, one after the other, and pass on what it warns of.

        Parameters
        ----------
        work : callable
            Takes a piece, one item of each further sequence, and a monitor for its share of the whole.
        monitor : Monitor
            Of the whole: its stages so far are done.
        plan : mapping of str to float
            The stages of the work on a piece.
        *of_each : sequences
            One item per piece, handed to the work.

        Returns
        -------
        list
            What the work returned, one per piece.

        Raises
        ------
        CancelledError
            If the run is cancelled.

        Examples
        --------
        >>> square = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]
        >>> pieces = connected_pieces(square, [[0, 1, 2], [1, 3, 2]])
        >>> pieces.map(lambda piece, own: len(piece.faces), Monitor(), {})
        [2]
        """
        ends = np.cumsum([0, *(len(piece.vertices) for piece in self.pieces)])
        shares = ends / ends[-1]
        warnings: list[Message] = []
        results = []
        for index, piece in enumerate(self.pieces):
            own = monitor.piece(float(shares[index]), float(shares[index + 1]), plan)
            results.append(work(piece, *(items[index] for items in of_each), own))
            own.tick(1.0)  # also where there was nothing to do
            warnings += [each for each in own.warnings if each not in warnings]
        monitor.extend(warnings[:_SHOWN])
        if len(warnings) > _SHOWN:
            monitor.warn("more_warnings", count=len(warnings) - _SHOWN)
        return results

    def gathered(self, values: Sequence[np.ndarray], others: np.ndarray) -> np.ndarray:
        """Gather values of the pieces on all vertices of the mesh.

        Parameters
        ----------
        values : sequence of (p, ...) ndarray
            Values on the vertices of each piece.
        others : (n, ...) ndarray
            Values of vertices that are in no piece.

        Returns
        -------
        (n, ...) ndarray
            Values on all vertices; those that were taken as one have the same.
        """
        whole = others.copy()
        for piece, each in zip(self.pieces, values, strict=True):
            whole[piece.vertices] = each
        copies = np.flatnonzero(self._representative != np.arange(len(whole)))
        whole[copies] = whole[self._representative[copies]]
        return whole

    def sources(self, given: ArrayLike) -> list[Chosen]:
        """Locate the vertices to start from in the pieces.

        Parameters
        ----------
        given : (s,) array_like of int
            Vertices of the mesh.

        Returns
        -------
        list of Chosen
            One per piece.

        Raises
        ------
        InvalidSettingsError
            If they are not vertices of the mesh.
        """
        try:
            wanted = np.atleast_1d(np.asarray(given))
        except ValueError:  # lists of several lengths
            wanted = np.zeros((0, 0))
        if wanted.ndim != 1 or not np.issubdtype(wanted.dtype, np.integer) or not wanted.size:
            raise InvalidSettingsError("source_list")
        if wanted.min() < 0 or wanted.max() >= len(self.vertices):
            raise InvalidSettingsError("source_range", last=len(self.vertices) - 1)
        return _located(self.pieces, self._representative, wanted)

    def gathered_features(
        self, found: Sequence[tuple[IntArray, IntArray, FloatArray]]
    ) -> tuple[IntArray, IntArray, FloatArray]:
        """Gather the features of the pieces on the whole mesh.

        Parameters
        ----------
        found : sequence of tuple
            Feature points, cells and Auto Diffusion Function of each piece, as its vertices.

        Returns
        -------
        features : (k,) ndarray of int
            Vertices of the mesh: those chosen by hand in their order, then the others, piece by piece.
        patches : (n,) ndarray of int
            Patch of every vertex; -1 for vertices of no piece.
        adf : (n,) ndarray of float
            Auto Diffusion Function of every vertex; 0 for vertices of no piece.
        """
        count = len(self.vertices)
        features = [piece.vertices[points] for piece, (points, _, _) in zip(self.pieces, found, strict=True)]
        first = np.cumsum([0, *[len(each) for each in features]])
        place = [
            count + start + np.arange(len(each)) if chosen is None else chosen.positions
            for start, each, chosen in zip(first[:-1], features, self.chosen, strict=True)
        ]
        order = np.argsort(np.concatenate(place), kind="stable")
        number = np.empty(len(order), dtype=np.int64)
        number[order] = np.arange(len(order))
        cells = [number[start + own] for start, (_, own, _) in zip(first[:-1], found, strict=True)]
        points = np.concatenate(features)[order]
        if self._given is not None:
            points[: len(self._given)] = self._given  # which may be copies, along a seam, of those found
        patches = self.gathered(cells, np.full(count, -1))
        return points, patches, self.gathered([adf for _, _, adf in found], np.zeros(count))

    @property
    def apart(self) -> list[Message]:
        """What becomes of loose pieces and of vertices without a face in a form."""
        several = len(self.pieces) if len(self.pieces) > 1 else 0
        counts = {"pieces_without_area": self.dropped, "several_pieces": several, "loose_vertices": self.loose}
        return [message(kind, count=count) for kind, count in counts.items() if count]

    @property
    def largest(self) -> int:
        """Number of vertices of the piece that has most."""
        return max(len(piece.vertices) for piece in self.pieces)

    @property
    def detected_elsewhere(self) -> int:
        """Number of pieces without any of the feature points that were chosen by hand."""
        return 0 if self._given is None else sum(each is None for each in self.chosen)


def connected_pieces(
    vertices: ArrayLike,
    faces: ArrayLike,
    monitor: Monitor | None = None,
    *,
    features: Sequence[int] | None = None,
) -> Pieces:
    """Find the connected surfaces in a mesh.

    Parameters
    ----------
    vertices : (n, 3) array_like of float
        Vertex positions, any unit of length.
    faces : (m, 3) array_like of int
        Triangles as vertex indices.
    monitor : Monitor, optional
        Polled for cancellation.
    features : sequence of int, optional
        Feature points chosen by hand, vertices of the mesh.

    Returns
    -------
    Pieces
        The surfaces.

    Raises
    ------
    InvalidMeshError
        If the mesh cannot be used; the message says what to do.
    InvalidSettingsError
        If a feature point chosen by hand is not a vertex of a surface, or is given twice.
    CancelledError
        If the run is cancelled.

    Examples
    --------
    >>> corner = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    >>> two = connected_pieces(corner + [[x, y, 1] for x, y, _ in corner], [[0, 1, 2], [3, 4, 5]])
    >>> len(two.pieces), two.apart[0].kind
    (2, 'several_pieces')
    """
    monitor = monitor or Monitor()
    mesh = repaired(vertices, faces, monitor)
    points, corners = mesh.vertices, mesh.faces
    label = component_labels(len(points), np.concatenate([corners[:, :2], corners[:, 1:]]))[corners[:, 0]]
    monitor.check()
    start = np.zeros(min(len(corners), 1), dtype=np.int64)
    if (label != label[:1]).any():
        order = np.argsort(label, kind="stable")
        corners, start = corners[order], np.concatenate([start, np.flatnonzero(np.diff(label[order])) + 1])
    if len(start) > _MOST:
        raise InvalidMeshError("too_many_pieces", count=len(start), most=_MOST)
    area, size = component_areas(points, corners, start)
    monitor.check()
    order = _largest_first(area, size)
    if not len(order):
        raise InvalidMeshError("no_area")
    groups = np.split(corners, start[1:])
    pieces = [_piece(points, groups[index]) for index in order]
    dropped = len(groups) - len(pieces)
    used = np.concatenate([piece.vertices[piece.faces] for piece in pieces]) if dropped else mesh.faces
    on_surface = np.zeros(len(points), dtype=bool)
    on_surface[corners] = True
    loose = int(np.count_nonzero(~on_surface[mesh.representative]))
    chosen = _chosen_features(pieces, mesh.representative, features)
    return Pieces(pieces, points, used, chosen, mesh.warnings, dropped, loose, mesh.representative, features)


def _largest_first(area: FloatArray, size: FloatArray) -> IntArray:
    """Sort components that have any area by falling area; of those equally large the first in the mesh comes first."""
    usable = np.flatnonzero(area > _NO_AREA)
    if len(usable) < 2:
        return usable
    areas = area[usable] * (size[usable] / size[usable].max()) ** 2
    return usable[np.argsort(-np.round(areas / areas.sum() / _ALIKE), kind="stable")]


def _piece(points: FloatArray, faces: IntArray) -> Piece:
    """Give the vertices of some triangles numbers of their own."""
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


def _chosen_features(pieces: list[Piece], representative: IntArray, given: Sequence[int] | None) -> list[Chosen | None]:
    """Find feature points chosen by hand in the pieces."""
    if given is None:
        return [None] * len(pieces)
    features, count = np.asarray(given), len(representative)
    if features.ndim != 1 or not features.size or not np.issubdtype(features.dtype, np.integer):
        raise InvalidSettingsError("feature_list")
    if features.min() < 0 or features.max() >= count:
        raise InvalidSettingsError("feature_range", last=count - 1)
    if len(np.unique(features)) < len(features):
        raise InvalidSettingsError("feature_twice")
    located = _located(pieces, representative, features)
    if sum(len(chosen.positions) for chosen in located) < len(features):
        raise InvalidSettingsError("feature_off_surface")
    if any(len(np.unique(chosen.vertices)) < len(chosen.vertices) for chosen in located):
        raise InvalidSettingsError("feature_coincident")
    return [chosen if len(chosen.positions) else None for chosen in located]


def _located(pieces: list[Piece], representative: IntArray, given: np.ndarray) -> list[Chosen]:
    """Find vertices of the mesh in the pieces."""
    wanted = representative[given.astype(np.int64)]
    found = []
    for piece in pieces:
        at = np.minimum(np.searchsorted(piece.vertices, wanted), len(piece.vertices) - 1)
        here = np.flatnonzero(piece.vertices[at] == wanted)
        found.append(Chosen(here, at[here]))
    return found
