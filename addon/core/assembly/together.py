"""Bodies of several pieces: which pieces belong together, and one body made of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..mesh.geometry import of_unit_area
from ..numerics.arrays import FloatArray, IntArray
from ..run.monitor import Monitor
from .body import Body, Rider, single
from .contacts import Contact, Samples, contacts_between, sampled
from .crowd import crowd_contacts, crowds
from .pieces import Piece, Pieces
from .riding import is_rigid
from .roles import TOUCH, Roles, roles_of


def bodies_together(pieces: Pieces, monitor: Monitor, *, one_body: bool = False) -> tuple[list[Body], int]:
    """Find the pieces that belong together, among neighbouring ones scaled to unit area.

    `pieces`: the connected surfaces of a mesh; `one_body`: as in `roles_of`, of neighbouring ones; gives bodies, crowd.

    Examples
    --------
    >>> from addon.core.assembly.pieces import connected_pieces
    >>> corner = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    >>> pieces = connected_pieces([*corner, *([x, y, 9] for x, y, _ in corner)], [[0, 1, 2], [3, 4, 5]])
    >>> bodies, crowd = bodies_together(pieces, Monitor())
    >>> len(bodies), crowd
    (2, 0)
    """
    bodies = []
    groups = crowds(pieces.pieces)
    for neighbours, crowd in groups:
        if len(neighbours) + len(crowd) == 1:
            bodies.append(single(neighbours[0]))
            continue
        faces = np.concatenate([piece.vertices[piece.faces] for piece in neighbours])
        used, corners = np.unique(faces, return_inverse=True)
        _, centre, unit = of_unit_area(pieces.vertices[used], corners.reshape(-1, 3))
        scaled = [Piece(piece.vertices, (piece.points - centre) / unit, piece.faces) for piece in neighbours + crowd]
        samples = [sampled(piece.points, piece.faces) for piece in scaled]
        measured = slice(0, len(neighbours))
        contacts = contacts_between(scaled[measured], samples[measured], monitor)
        roles = roles_of(scaled[measured], samples[measured], contacts, one_body=one_body)
        for index, (carrier, contact) in enumerate(
            crowd_contacts(samples[len(neighbours) :], samples[measured], monitor), len(neighbours)
        ):
            roles.riders.append((index, carrier))
            contacts[index, carrier] = contact
        bodies += [
            body_of(neighbours + crowd, samples, contacts, roles, group, (centre, unit)) for group in roles.bodies
        ]
    return bodies, sum(len(crowd) for _, crowd in groups)


def body_of(
    pieces: Sequence[Piece],
    samples: Sequence[Samples],
    contacts: Mapping[tuple[int, int], Contact],
    roles: Roles,
    group: Sequence[int],
    frame: tuple[FloatArray, float],
) -> Body:
    """Combine the pieces of one body.

    `pieces`: all pieces of the mesh; `samples`: samples of each, on the mesh scaled to unit area; `contacts`: the
    distances between the pieces; `roles`: their roles; `group`: the parts of this body; `frame`: centre and unit of
    that scaling.

    Examples
    --------
    >>> from addon.core.assembly.contacts import sampled
    >>> piece = Piece(np.arange(3), np.eye(3), np.array([[0, 1, 2]]))
    >>> samples = [sampled(piece.points, piece.faces)]
    >>> body_of([piece], samples, {}, Roles([[0]], []), [0], (np.zeros(3), 1.0)).vertices.tolist()
    [0, 1, 2]
    """
    parts, first, begun = [], 0, 0
    numbers: dict[int, int] = {}  # index of each piece that can carry: parts and riders
    carriers = {}  # vertices of the body's surface that carry those of each piece
    for index in group:
        piece = pieces[index]
        own = slice(first, first + len(piece.vertices)), slice(begun, begun + len(piece.faces))
        parts.append((*own, samples[index]))
        numbers[index] = len(numbers)
        carriers[index] = np.arange(own[0].start, own[0].stop)
        first, begun = own[0].stop, own[1].stop
    every = list(range(len(group)))
    total = sum(each.area for each in samples)
    riders = []
    for index, carrier in roles.riders:
        if carrier not in numbers:
            continue
        piece, contact = pieces[index], contacts[index, carrier]
        covered = float(np.mean(contact.distances < TOUCH))
        rigid = is_rigid(samples[index].points, samples[index].area / total, covered)
        under = carriers[carrier][samples[carrier].nearest_corners[contact.nearest]]  # of every sample
        if rigid:
            carriers[index] = np.full(len(piece.vertices), under[np.argmin(contact.distances)])
        else:
            carriers[index] = under[_nearest(samples[index], piece, contact, frame)]
        ground = [numbers[carrier]] if rigid else sorted({*every, numbers[carrier]})
        riders.append(Rider(piece, carriers[index], samples[index], ground, rigid))
        numbers[index] = len(numbers)
    return Body(
        np.concatenate([pieces[index].vertices for index in group]),
        np.concatenate([pieces[index].points for index in group]),
        np.concatenate([pieces[index].faces + own.start for index, (own, _, _) in zip(group, parts, strict=True)]),
        parts,
        riders,
        frame,
    )


def _nearest(samples: Samples, piece: Piece, contact: Contact, frame: tuple[FloatArray, float]) -> IntArray:
    """Find, for each vertex of a piece, the nearest sample that has something under it."""
    from scipy.spatial import KDTree

    known = np.flatnonzero(np.isfinite(contact.distances))
    centre, unit = frame
    return known[KDTree(samples.points[known]).query((piece.points - centre) / unit)[1]]
