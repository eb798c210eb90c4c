"""A body: the pieces that are unfolded as one surface, and those that ride on it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..mesh.geometry import of_unit_area
from ..method_api.settings import Settings
from ..numerics.arrays import FloatArray, IntArray
from ..run.monitor import Monitor
from .pieces import Piece

if TYPE_CHECKING:
    from ..method_api.surface_features import SurfaceFeatures
    from ..surface.working_surface import WorkingSurface
    from ..symmetry.limbs import Limbs
    from .contacts import Samples


class Rider(NamedTuple):
    """A piece that rides on a body.

    Attributes
    ----------
    piece : Piece
        The piece.
    carriers : (p,) ndarray of int
        The vertex of the body's surface that carries each of its vertices.
    samples : Samples
        Samples of it, on the mesh scaled to unit area.
    ground : list of int
        What it rides on: indices of parts of the body, then of earlier riders.
    rigid : bool
        Whether it moves rigidly.
    """

    piece: Piece
    carriers: IntArray
    samples: Samples
    ground: list[int]
    rigid: bool


class Chosen(NamedTuple):
    """Those of the vertices chosen by the user that lie on one body.

    Attributes
    ----------
    positions : (t,) ndarray of int
        Their positions in the list that the user gave, ascending.
    vertices : (t,) ndarray of int
        The same as vertices of the body's surface; for one on a rider, the vertex that carries it.
    names : tuple of str
        Their names, "" for none; empty where none was given.
    """

    positions: IntArray
    vertices: IntArray
    names: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Body(Piece):
    """Pieces that are unfolded as one surface, and what rides on it.

    Attributes
    ----------
    vertices : (p,) ndarray of int
        Vertices of its surface among those of the mesh, part by part.
    points : (p, 3) ndarray of float
        Their positions.
    faces : (q, 3) ndarray of int
        Its triangles, part by part; corners index `vertices`.
    parts : list of (slice, slice, Samples)
        Vertices, triangles and samples of each part; the samples are on the mesh scaled to unit area.
    riders : list of Rider
        The pieces that ride on it, each after what carries it.
    frame : tuple of (3,) ndarray of float and float
        Centre and unit of that scaling.
    rest : (p, 3) ndarray of float, optional
        Positions in the rest pose, where the parts are bridged; None for those that they have.
    """

    parts: list[tuple[slice, slice, Samples]]
    riders: list[Rider]
    frame: tuple[FloatArray, float]
    rest: FloatArray | None = None

    @property
    def all_faces(self) -> IntArray:
        """Triangles of its surface and of all riders, as corners of the mesh, (f, 3)."""
        return np.concatenate([each.vertices[each.faces] for each in (self, *(rider.piece for rider in self.riders))])

    def working_surface(
        self,
        points: FloatArray,
        faces: IntArray,
        target: int | None = None,
        *,
        fixed: IntArray | None = None,
        monitor: Monitor | None = None,
    ) -> WorkingSurface:
        """Reduce the body to about `target` vertices of one connected surface.

        `points` (p, 3); `faces` (q, 3); `target`: number of working vertices; all if omitted, or if there are hardly
        more; `fixed` (k,).
        """
        if len(self.parts) < 2:
            from ..surface.working_surface import working_surface

            return working_surface(points, faces, target, fixed=fixed, monitor=monitor)
        from .joined_surface import joined_surface

        rest = None if self.rest is None else of_unit_area(self.rest, faces)[0]
        return joined_surface(points, faces, self.parts, target, fixed=fixed, rest=rest, monitor=monitor or Monitor())

    def features(self, chosen: Chosen | None, settings: Settings, monitor: Monitor) -> SurfaceFeatures:
        """Find the feature points and patches of the body. `chosen`: by hand; `settings`: options of the method.

        With a rest pose, its feature points, their numbers and their names are those of all poses.
        """
        from ..method_api.surface_features import detected

        limbs: Limbs | None = None
        points, names = (None, ()) if chosen is None else chosen[1:]
        if self.rest is not None:
            own = monitor.piece(0.0, 0.0, {})  # whose results are kept apart from those of the pose
            resting = detected(self.rest, self.faces, points, settings, own, reduced=self.working_surface, names=names)
            monitor.extend(own.warnings)
            points, limbs = resting.whole_features, resting.limbs
        reduced = self.working_surface
        return detected(self.points, self.faces, points, settings, monitor, reduced=reduced, limbs=limbs, names=names)

    def with_riders(self, shape: FloatArray, monitor: Monitor) -> list[FloatArray]:
        """Move the riders with the surface. `shape` (p, 3)."""
        from .riding import ground_of, ridden

        centre, unit = self.frame
        shapes = dict(enumerate((shape[vertices] - centre) / unit for vertices, _, _ in self.parts))
        samples = [each for _, _, each in self.parts] + [rider.samples for rider in self.riders]
        pieces = [Piece(piece.vertices, (piece.points - centre) / unit, piece.faces) for piece, *_ in self.riders]
        sharing: dict[tuple[bool, tuple[int, ...]], list[int]] = {}  # the first comes after all that carries them
        for index, rider in enumerate(self.riders):
            sharing.setdefault((rider.rigid, tuple(rider.ground)), []).append(index)
        for (rigid, under), riding in sharing.items():
            ground = ground_of([samples[at] for at in under], [shapes[at] for at in under])
            own = [self.riders[index].samples for index in riding]
            moved = ridden([pieces[index] for index in riding], own, ground, rigid=rigid, monitor=monitor)
            shapes.update(zip((len(self.parts) + index for index in riding), moved, strict=True))
        return [shapes[len(self.parts) + index] * unit + centre for index in range(len(self.riders))]


def single(piece: Piece) -> Body:
    """Make a body of one piece.

    `piece`: the piece.

    Examples
    --------
    >>> single(Piece(np.arange(3), np.eye(3), np.array([[0, 1, 2]]))).riders
    []
    """
    return Body(piece.vertices, piece.points, piece.faces, [], [], (np.zeros(3), 1.0))
