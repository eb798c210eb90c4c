"""Bodies found in the rest pose of a rig, where nothing touches by chance, put into the pose that is unfolded."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..mesh.geometry import checked_arrays, component_areas, of_unit_area
from ..numerics.arrays import FloatArray
from ..run.errors import InvalidMeshError
from ..run.monitor import Monitor
from .bodies import Bodies, bodies_of
from .body import Body
from .contacts import Samples
from .pieces import NO_AREA, Piece, Pieces
from .strays import drawn_in, stray_vertices


def bodies_at_rest(
    vertices: ArrayLike,
    faces: ArrayLike,
    rest: ArrayLike,
    monitor: Monitor,
    *,
    together: bool = True,
    features: Sequence[int] | None = None,
    names: Sequence[str] | None = None,
) -> Bodies:
    """Find the bodies in a mesh in the rest pose of its rig, and put them into its pose.

    `vertices` (n, 3); `faces` (m, 3); `rest` (n, 3): positions in the rest pose; `together`, `features`,
    `names`: as in `bodies_of`. Neighbouring pieces are one body, since one rig moves them.

    Examples
    --------
    >>> corner = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    >>> bodies_at_rest(corner + 5, [[0, 1, 2]], corner, Monitor()).bodies[0].points.min()
    5.0
    """
    places, corners = checked_arrays(vertices, faces)
    bodies = bodies_of(rest, corners, monitor, together=together, features=features, names=names, one_body=True)
    if len(places) != len(bodies.vertices):
        raise InvalidMeshError("rest_shape", count=len(places))
    if np.array_equal(places, bodies.vertices):
        return bodies
    if bodies.pieces.dropped:  # hidden at rest, perhaps, and shown in this pose
        alone = bodies_of(places, corners, monitor, together=together, features=features, names=names)
        if alone.pieces.dropped < bodies.pieces.dropped:
            return alone
    flat = _without_area(bodies.pieces, places)
    if len(flat) == len(bodies.pieces.pieces):
        raise InvalidMeshError("no_area")
    if flat:  # hidden in this pose: left out, as what has no area in any
        hidden = np.isin(bodies.pieces.representative, np.concatenate([piece.vertices for piece in flat]))
        shown = corners[~hidden[corners].all(axis=1)]
        how: dict[str, Any] = {"together": together, "features": features, "names": names}
        rest_of = bodies_at_rest(vertices, shown, rest, monitor, **how)
        dropped, loose = bodies.pieces.dropped + len(flat), bodies.pieces.loose
        return replace(rest_of, pieces=replace(rest_of.pieces, dropped=dropped, loose=loose))
    return _all_posed(bodies, places)


def _without_area(pieces: Pieces, places: FloatArray) -> list[Piece]:
    """List the pieces that have no area in a pose (n, 3)."""
    start = np.cumsum([0, *(len(each.faces) for each in pieces.pieces[:-1])])
    faces = np.concatenate([each.vertices[each.faces] for each in pieces.pieces])
    area, _ = component_areas(places, faces, start)
    return [pieces.pieces[index] for index in np.flatnonzero(area <= NO_AREA)]


def _all_posed(bodies: Bodies, vertices: FloatArray) -> Bodies:
    """Put bodies that were found in another pose into this one."""
    pieces = bodies.pieces
    strays = np.union1d(pieces.strays, stray_vertices(vertices, pieces.faces))  # a rig leaves some behind
    places = drawn_in(vertices, pieces.faces, strays) if len(strays) else vertices
    here = [Piece(each.vertices, places[each.vertices], each.faces) for each in pieces.pieces]
    return replace(
        bodies,
        bodies=[_posed(body, places) for body in bodies.bodies],
        pieces=replace(pieces, pieces=here, vertices=vertices, strays=strays, drawn_in=places),
    )


def _posed(body: Body, places: FloatArray) -> Body:
    """Put a body into a pose; its bridges stay those of the rest pose."""
    used, corners = np.unique(body.all_faces, return_inverse=True)
    _, centre, unit = of_unit_area(places[used], corners.reshape(-1, 3))
    scaled = (places - centre) / unit
    points = scaled[body.vertices]
    return replace(
        body,
        points=places[body.vertices],
        parts=[(own, triangles, _moved(samples, points[own])) for own, triangles, samples in body.parts],
        riders=[
            rider._replace(
                piece=Piece(rider.piece.vertices, places[rider.piece.vertices], rider.piece.faces),
                samples=_moved(rider.samples, scaled[rider.piece.vertices]),
            )
            for rider in body.riders
        ],
        frame=(centre, unit),
        rest=body.points,
    )


def _moved(samples: Samples, points: FloatArray) -> Samples:
    """Move the samples of a piece with its vertices (p, 3)."""
    return samples._replace(points=samples.on(points))
