"""The search for contacts on the largest body of a mesh."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from ..assembly.bodies import Bodies
from ..assembly.opening import OPENING, known_bodies
from ..assembly.unfolded_bodies import unfolded_bodies
from ..matching.unfolded import Unfolded
from ..mesh.tables import rows_in
from ..method_api.settings import Settings
from ..run.kept_stages import KeptStages
from ..run.messages import message
from ..run.monitor import Monitor
from .contact_faces import contact_faces, contacts_between
from .explained_skin import Explained, explained_by_mannequin
from .found_contacts import Contacts
from .suspicion import is_tall
from .whole_body import Known, WholeBody, explained_by, known_body

_UNFOLDED = 0.4  # of the work
_NO_EDGES = np.empty((0, 2), dtype=np.int64)
_PLAN = {"Ways to face": 3, "Limbs": 3, "Contacts": 1}


def contacts_of(
    vertices: ArrayLike,
    faces: ArrayLike,
    settings: Settings,
    kept: KeptStages,
    monitor: Monitor,
    whole: WholeBody | None = None,
) -> Contacts:
    """Find contacts as `find_contacts` does, as a part of a longer run.

    `vertices` (n, 3), `faces` (m, 3): the mesh; `settings`: of the forms; `kept`: results of earlier runs;
    `monitor`: of this part; `whole`: a body like it that is whole, by which they are found if it is not human.
    """
    bodies, surfaces = unfolded_bodies(vertices, faces, settings, monitor.piece(0.0, _UNFOLDED, OPENING))
    largest = bodies.largest_body
    body, one = bodies.bodies[largest], surfaces[largest]
    piece = monitor.piece(_UNFOLDED, 1.0, _PLAN)
    found = _without(bodies, monitor)
    if len(bodies.bodies) > 1:
        found.warnings.append(message("contacts_largest"))
    if len(body.parts) > 1:  # parts that touch are apart already
        return found
    explained = _explained(one, settings, kept, piece, whole)
    if explained is None:
        return found
    if not explained.convinces:
        return replace(found, residual=explained.residual)
    with piece.stage("Contacts"):
        found.places[body.vertices] = explained.places
        here = contact_faces(one.found.whole_points, body.faces, explained.places, piece)
        between = contacts_between(body.faces[here], explained.held)
    found.gone[rows_in(body.vertices[body.faces[here]], bodies.faces)] = True
    names = explained.names
    pairs = [(names[first], names[second]) for first, second in between]
    return replace(found, between=pairs, explained=True, residual=explained.residual)


def none_found(vertices: ArrayLike, faces: ArrayLike, settings: Settings, monitor: Monitor) -> Contacts:
    """Read a mesh for what is marked on it, without a search."""
    return _without(known_bodies(vertices, faces, monitor, together=settings.together), monitor)


def _without(bodies: Bodies, monitor: Monitor) -> Contacts:
    """Describe a mesh of which nothing is known."""
    size = bodies.bodies[bodies.largest_body].size
    return Contacts(
        bodies.vertices,
        bodies.pieces.representative,
        bodies.faces,
        size,
        np.zeros(len(bodies.faces), dtype=bool),
        _NO_EDGES,
        bodies.vertices / size,
        [],
        False,
        float("nan"),
        monitor.timings,
        [*bodies.pieces.repairs, *bodies.apart],
    )


def _explained(
    one: Unfolded, settings: Settings, kept: KeptStages, monitor: Monitor, whole: WholeBody | None
) -> Explained | None:
    """Explain the skin of a body by the mannequin, or by another body; None if that one cannot be used."""
    if whole is None or is_tall(one.found.spectrum.eigenvalues):
        human = explained_by_mannequin(one, settings, kept, monitor)
        if whole is None or human.convinces:
            return human
    quiet = Monitor(cancelled=monitor.is_cancelled, keep=kept.part("Whole body"))
    with monitor.stage("Ways to face"):
        sources = [whole.vertices, whole.faces, whole.form, repr(settings)]
        known: Known | None = kept.take("Whole body", sources, lambda: known_body(whole, settings, quiet), [])
    return None if known is None else explained_by(one, known, monitor)
