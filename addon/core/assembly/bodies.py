"""A mesh as bodies: pieces that belong together are processed as one, and the results are gathered on all vertices."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from ..numerics.arrays import FloatArray, IntArray
from ..run.errors import InvalidMeshError, InvalidSettingsError
from ..run.messages import Message, message
from ..run.monitor import Monitor, Plan
from .body import Body, Chosen, single
from .pieces import MOST_PIECES, Pieces, connected_pieces

Result = TypeVar("Result")

_SHOWN = 5  # warnings about bodies that are reported individually


@dataclass(frozen=True, eq=False)
class Bodies:
    """A mesh as bodies.

    Attributes
    ----------
    bodies : list of Body
        The bodies: by neighbourhood, in each the largest area first.
    pieces : Pieces
        The connected surfaces of the mesh.
    chosen : list of Chosen or None
        Feature points chosen by hand, one item per body; None where they are to be detected.
    together : bool
        Whether pieces that belong together are one body.
    given : sequence of int or None
        Feature points chosen by hand, as vertices of the mesh.
    crowd : int
        Number of pieces too small or too many to be compared with all others: they ride on what lies nearest.
    """

    bodies: list[Body]
    pieces: Pieces
    chosen: list[Chosen | None]
    together: bool
    given: Sequence[int] | None
    crowd: int

    @property
    def vertices(self) -> FloatArray:
        """Positions of all vertices, as given, (n, 3)."""
        return self.pieces.vertices

    @property
    def faces(self) -> IntArray:
        """Triangles of all pieces, (m, 3)."""
        return self.pieces.faces

    @property
    def unjoined(self) -> IntArray:
        """The same triangles with the vertices of the mesh as given, of coincident ones each its own, (m, 3)."""
        return self.pieces.unjoined

    def map(self, work: Callable[..., Result], monitor: Monitor, plan: Plan, *of_each: Sequence[Any]) -> list[Result]:
        """Process every body in turn, and pass on its warnings.

        `work`: takes a body, one item of each further sequence, and a monitor for its share of the whole; `plan`: the
        stages of the work on a body; `*of_each`: one item per body, passed to `work`.

        Examples
        --------
        >>> square = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]
        >>> bodies = bodies_of(square, [[0, 1, 2], [1, 3, 2]])
        >>> bodies.map(lambda body, own: len(body.faces), Monitor(), {})
        [2]
        """
        ends = np.cumsum([0, *(len(body.vertices) for body in self.bodies)])
        shares = ends / ends[-1]
        warnings: list[Message] = []
        results = []
        for index, body in enumerate(self.bodies):
            own = monitor.piece(float(shares[index]), float(shares[index + 1]), plan)
            results.append(work(body, *(items[index] for items in of_each), own))
            own.tick(1.0)  # also where there was nothing to do
            warnings += [each for each in own.warnings if each not in warnings]
        monitor.extend(warnings[:_SHOWN])
        if len(warnings) > _SHOWN:
            monitor.warn("more_warnings", count=len(warnings) - _SHOWN)
        return results

    def sources(self, given: ArrayLike) -> list[Chosen]:
        """Locate source vertices on the bodies. `given` (s,)."""
        try:
            wanted = np.atleast_1d(np.asarray(given))
        except ValueError:  # rows of different lengths
            wanted = np.zeros((0, 0))
        if wanted.ndim != 1 or not np.issubdtype(wanted.dtype, np.integer) or not wanted.size:
            raise InvalidSettingsError("source_list")
        if wanted.min() < 0 or wanted.max() >= len(self.vertices):
            raise InvalidSettingsError("source_range", last=len(self.vertices) - 1)
        return _located(self.bodies, self.pieces.representative, wanted)

    @property
    def apart(self) -> list[Message]:
        """Messages on how a form treats several bodies, pieces without area and vertices without a face."""
        told = list(self.pieces.left_out)
        if self.crowd:
            told.append(message("small_pieces_ride", count=self.crowd))
        if len(self.bodies) > 1:
            told.append(message("several_bodies" if self.together else "several_pieces", count=len(self.bodies)))
        return told

    @property
    def largest_body(self) -> int:
        """Number of the body with the largest area."""
        return int(np.argmax([body.size for body in self.bodies]))

    @property
    def largest(self) -> int:
        """Number of vertices of the body that has the most."""
        return max(len(body.vertices) for body in self.bodies)

    @property
    def detected_elsewhere(self) -> int:
        """Number of bodies without any of the feature points that were chosen by hand."""
        return 0 if self.given is None else sum(each is None for each in self.chosen)


def bodies_of(
    vertices: ArrayLike,
    faces: ArrayLike,
    monitor: Monitor | None = None,
    *,
    together: bool = True,
    features: Sequence[int] | None = None,
    names: Sequence[str] | None = None,
    one_body: bool = False,
) -> Bodies:
    """Find the bodies in a mesh.

    `vertices` (n, 3); `faces` (m, 3); `together`: whether pieces that belong together are one body; otherwise every
    piece is one; `features`: feature points chosen by hand, vertices of the mesh; `names`: of these; `one_body`:
    whether neighbouring pieces are known to be one body.

    Examples
    --------
    >>> corner = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    >>> two = [*corner, *([x, y, 9] for x, y, _ in corner)]
    >>> len(bodies_of(two, [[0, 1, 2], [3, 4, 5]]).bodies)
    2
    """
    monitor = monitor or Monitor()
    pieces = connected_pieces(vertices, faces, monitor)
    if together and len(pieces.pieces) > 1:
        from .together import bodies_together

        found, crowd = bodies_together(pieces, monitor, one_body=one_body)
    elif len(pieces.pieces) > MOST_PIECES:
        raise InvalidMeshError("too_many_pieces", count=len(pieces.pieces), most=MOST_PIECES)
    else:
        found, crowd = list(map(single, pieces.pieces)), 0
    return Bodies(found, pieces, _chosen_features(found, pieces, features, names), together, features, crowd)


def _chosen_features(
    bodies: list[Body], pieces: Pieces, given: Sequence[int] | None, names: Sequence[str] | None
) -> list[Chosen | None]:
    """Locate feature points chosen by hand on the bodies."""
    if given is None:
        return [None] * len(bodies)
    features, count = np.asarray(given), len(pieces.vertices)
    if features.ndim != 1 or not features.size or not np.issubdtype(features.dtype, np.integer):
        raise InvalidSettingsError("feature_list")
    if features.min() < 0 or features.max() >= count:
        raise InvalidSettingsError("vertex_range", name="feature_points", last=count - 1)
    if len(np.unique(features)) < len(features):
        raise InvalidSettingsError("feature_twice")
    located = _located(bodies, pieces.representative, features)
    if sum(len(chosen.positions) for chosen in located) < len(features):
        raise InvalidSettingsError("feature_off_surface")
    if any(len(np.unique(chosen.vertices)) < len(chosen.vertices) for chosen in located):
        raise InvalidSettingsError("feature_coincident")
    if names is not None:
        located = [each._replace(names=tuple(names[position] for position in each.positions)) for each in located]
    return [chosen if len(chosen.positions) else None for chosen in located]


def _located(bodies: list[Body], representative: IntArray, given: np.ndarray) -> list[Chosen]:
    """Locate vertices of the mesh on the bodies."""
    wanted = representative[given.astype(np.int64)]
    number = np.full(len(representative), -1, dtype=np.int64)
    found = []
    for body in bodies:
        number[body.vertices] = np.arange(len(body.vertices))
        for rider in body.riders:
            number[rider.piece.vertices] = rider.carriers
        here = np.flatnonzero(number[wanted] >= 0)
        found.append(Chosen(here, number[wanted[here]]))
        number[body.vertices] = -1
        for rider in body.riders:
            number[rider.piece.vertices] = -1
    return found
