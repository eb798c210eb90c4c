"""Bodies found in the rest pose of a rig, where nothing touches by chance, put into the pose that is unfolded."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from ..mesh.geometry import checked_arrays, of_unit_area, surface_area
from ..numerics.arrays import FloatArray
from ..run.errors import InvalidMeshError
from ..run.monitor import Monitor
from .bodies import Bodies, bodies_of
from .body import Body
from .pieces import Piece
from .strays import drawn_in


def bodies_at_rest(
    vertices: ArrayLike,
    faces: ArrayLike,
    rest: ArrayLike,
    monitor: Monitor,
    *,
    together: bool = True,
    features: Sequence[int] | None = None,
) -> Bodies:
    """Find the bodies in a mesh in the rest pose of its rig, and put them into its pose.

    `vertices` (n, 3); `faces` (m, 3); `rest` (n, 3): positions in the rest pose; `together`, `features`: as in
    `bodies_of`. Neighbouring pieces are one body, since one rig moves them.

    Examples
    --------
    >>> corner = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    >>> bodies_at_rest(corner + 5, [[0, 1, 2]], corner, Monitor()).bodies[0].points.min()
    5.0
    """
    bodies = bodies_of(rest, faces, monitor, together=together, features=features, one_body=True)
    places, _ = checked_arrays(vertices, faces)
    if len(places) != len(bodies.vertices):
        raise InvalidMeshError("rest_shape", count=len(places))
    return bodies if np.array_equal(places, bodies.vertices) else _all_posed(bodies, places)


def _all_posed(bodies: Bodies, vertices: FloatArray) -> Bodies:
    """Put bodies that were found in another pose into this one."""
    pieces = bodies.pieces
    strays = pieces.strays
    places = drawn_in(vertices, pieces.faces, strays) if len(strays) else vertices
    if surface_area(places, pieces.faces) <= 0:
        raise InvalidMeshError("no_area")
    here = [Piece(each.vertices, places[each.vertices], each.faces) for each in pieces.pieces]
    return replace(
        bodies,
        bodies=[_posed(body, places) for body in bodies.bodies],
        pieces=replace(pieces, pieces=here, vertices=vertices, drawn_in=places),
    )


def _posed(body: Body, places: FloatArray) -> Body:
    """Put a body into a pose; its bridges stay those of the rest pose."""
    used, corners = np.unique(body.all_faces, return_inverse=True)
    _, centre, unit = of_unit_area(places[used], corners.reshape(-1, 3))
    scaled = (places - centre) / unit
    points = scaled[body.vertices]
    parts = [
        (own, triangles, samples._replace(points=samples.on(points[own]))) for own, triangles, samples in body.parts
    ]
    riders = [
        rider._replace(
            piece=Piece(rider.piece.vertices, places[rider.piece.vertices], rider.piece.faces),
            samples=rider.samples._replace(points=rider.samples.on(scaled[rider.piece.vertices])),
        )
        for rider in body.riders
    ]
    return Body(
        body.vertices, places[body.vertices], body.faces, parts, riders, (centre, unit) if parts else body.frame,
        body.points,
    )  # fmt: skip
