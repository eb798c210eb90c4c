"""Entry point for skin that has grown together: where two parts of a human body have become one surface."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from .assembly.opening import OPENING, known_bodies
from .assembly.unfolded_bodies import unfolded_bodies
from .fused.contact_faces import contact_faces, contacts_between
from .fused.explained_skin import explained_skin
from .fused.on_given import given_of, rows_on_given, shape_on_given
from .mesh.geometry import checked_arrays, surface_area
from .mesh.tables import rows_in
from .method_api.settings import Settings
from .modelling.mannequins import mannequin
from .numerics.arrays import FloatArray, IntArray
from .results import CanonicalForm, Contacts, Match, PosedLike, Rigged
from .rigging.candidates import candidates
from .rigging.reference_rig import mannequin_rig
from .rigging.references import Reference, unfolded_reference
from .run.kept_stages import KeptStages
from .run.messages import Message, message
from .run.monitor import Cancelled, Monitor, Progress

if TYPE_CHECKING:
    from .fused.parting import PartedMesh

Found = TypeVar("Found", "CanonicalForm", "PosedLike", "Rigged")
Result = TypeVar("Result", "CanonicalForm", "PosedLike")

_UNFOLDED = 0.4  # of the work
_LOOKED_FOR = 0.8  # the same, where something is computed afterwards
_FOREIGN = 0.012  # residual above which the mannequin does not explain the body: humans have .006 to .009
_REPAIRS = ("repeated_corners", "coincident_borders", "duplicate_faces", "inconsistent_faces", "rounded_positions")
_PLAN = {"Ways to face": 3, "Limbs": 3, "Contacts": 1}


def find_contacts(
    vertices: ArrayLike,
    faces: ArrayLike,
    settings: Settings | None = None,
    *,
    keep: KeptStages | None = None,
    progress: Progress | None = None,
    cancelled: Cancelled | None = None,
) -> Contacts:
    """Find where the skin of a human body has grown together, as in scans, voxel sculpts and generated meshes.

    The skeleton of a mannequin is fitted to the largest body, its arms by search, as no match knows where they are.
    So every vertex gets a place on the mannequin, which stands with arms and legs spread. Skin between places that lie
    far apart has grown together if the way round over the surface is as long as that.

    Parameters
    ----------
    vertices : (n, 3) array_like of float
        Vertex positions, any unit of length.
    faces : (m, 3) array_like of int
        Triangles, in any state that docs/any-mesh.md lists.
    settings : Settings, optional
        Options of the form by which the mannequin is matched.
    keep : KeptStages, optional
        Results of earlier runs.
    progress : callable, optional
        Called with the fraction done (0 to 1) and the name of the stage.
    cancelled : callable, optional
        Polled at least twice a second; the computation stops when it returns True.

    Returns
    -------
    Contacts
        The triangles in which it has; `parted` opens them. A body of several parts, or one that is not human, is left
        as it is.

    Raises
    ------
    CanonicalFormError
        As in `canonical_form`.

    Examples
    --------
    >>> from addon.core import mannequin
    >>> find_contacts(*mannequin()).gone.any()  # doctest: +SKIP
    False

    References
    ----------
    Bronstein, Bronstein and Kimmel, "Topology-Invariant Similarity of Nonrigid Shapes", 2009,
    doi:10.1007/s11263-008-0172-2, describes the weakness; docs/appendix.md tells how it was made.
    """
    return contacts_of(vertices, faces, settings or Settings(), keep or KeptStages(), Monitor(progress, cancelled))


def contacts_of(
    vertices: ArrayLike, faces: ArrayLike, settings: Settings, kept: KeptStages, monitor: Monitor
) -> Contacts:
    """Find contacts as `find_contacts` does, as a part of a longer run.

    Parameters
    ----------
    vertices, faces, settings
        As in `find_contacts`.
    kept : KeptStages
        Results of earlier runs.
    monitor : Monitor
        Of this part.

    Returns
    -------
    Contacts
        The contacts.

    Raises
    ------
    CanonicalFormError
        As in `find_contacts`.
    """
    bodies, surfaces = unfolded_bodies(vertices, faces, settings, monitor.piece(0.0, _UNFOLDED, OPENING))
    largest = int(np.argmax([surface_area(body.points, body.faces) for body in bodies.bodies]))
    body, one = bodies.bodies[largest], surfaces[largest]
    piece = monitor.piece(_UNFOLDED, 1.0, _PLAN)
    gone, places = np.zeros(len(bodies.faces), dtype=bool), bodies.vertices / body.size
    between: list[tuple[int, int]] = []
    explained, residual = False, float("nan")
    human: Reference | None = None
    if len(body.parts) < 2:  # parts that touch are apart already
        with piece.stage("Ways to face"):
            figure = kept.take("Mannequin", [], lambda: mannequin_rig(*mannequin()), piece.warnings)
            human = kept.take(
                "Mannequin unfolded", [figure, repr(settings)],
                lambda: unfolded_reference(figure, settings, Monitor(cancelled=piece.is_cancelled)), piece.warnings
            )  # fmt: skip
            best = candidates(one, human, lambda: [], piece, fused=True)[0]
        own, held, residual = explained_skin(one, human, best.fit.bones, piece)
        explained = residual <= _FOREIGN
        if explained:
            with piece.stage("Contacts"):
                places[body.vertices] = own
                here = contact_faces(one.found.whole_points, body.faces, own, piece)
                between = contacts_between(body.faces[here], held)
            gone[rows_in(body.vertices[body.faces[here]], bodies.faces)] = True
    names = [] if human is None else human.whole.skeleton.names
    told = [*bodies.pieces.repairs, *bodies.apart]
    return Contacts(
        bodies.vertices,
        bodies.pieces.representative,
        bodies.faces,
        body.size,
        gone,
        places,
        [(names[one], names[two]) for one, two in between],
        explained,
        residual,
        monitor.timings,
        [*told, message("contacts_largest")] if len(bodies.bodies) > 1 else told,
    )


def computed_open(
    compute: Callable[..., Found],
    on_given: Callable[[Found, PartedMesh, Contacts], Found],
    vertices: ArrayLike,
    faces: ArrayLike,
    settings: Settings,
    keep: KeptStages | None,
    progress: Progress | None,
    cancelled: Cancelled | None,
) -> Found:
    """Find contacts, and compute something on the mesh that is parted there.

    Parameters
    ----------
    compute : callable
        Takes vertices, faces and settings, if they are parted that mesh and the contacts, and `keep`, `progress` and
        `cancelled` by name.
    on_given : callable
        Takes its result, the parted mesh and the contacts, and gives the result on the mesh as given.
    vertices, faces, keep, progress, cancelled
        As in `find_contacts`.
    settings : Settings
        Options of the computation.

    Returns
    -------
    CanonicalForm, PosedLike or Rigged
        The result; a warning says in how many places the mesh was parted, or that nothing is known of it.

    Raises
    ------
    CanonicalFormError
        As in `find_contacts`, and of the computation.
    """
    kept, monitor = keep or KeptStages(), Monitor(progress, cancelled)
    points, corners = (each.copy() for each in checked_arrays(vertices, faces))  # what is kept must not change
    chosen = settings.feature_points
    if chosen is not None:  # rejected before the search, not after it
        known_bodies(points, corners, Monitor(cancelled=cancelled), together=settings.together, features=chosen)
    plain = Settings(pieces=settings.pieces, memory_limit=settings.memory_limit)  # whatever unfolds it later
    piece = monitor.piece(0.0, _LOOKED_FOR, {})
    found: Contacts = kept.take(
        "Contacts",
        [points, corners, repr(plain)],
        lambda: contacts_of(points, corners, plain, kept, piece),
        [],
    )
    how: dict[str, Any] = {
        "keep": None if keep is None else kept.part("Parted"),
        "progress": lambda done, stage: monitor.report(_LOOKED_FOR + (1 - _LOOKED_FOR) * done, stage),
        "cancelled": cancelled,
    }
    settings = replace(settings, contacts="keep")
    if not found.gone.any():
        result = compute(points, corners, settings, **how)
        if not found.explained:
            result.warnings.append(message("contacts_unknown"))
        return result
    mesh = found.parted()
    if chosen is not None:
        numbers = rows_on_given(mesh, found.vertices, found.representative)
        settings = replace(settings, feature_points=[int(numbers[each]) for each in chosen])
    result = compute(mesh.vertices, mesh.faces, settings, mesh, found, **how)
    told: list[Message] = [each for each in result.warnings if each.kind not in _REPAIRS]  # of what was made here
    result.warnings[:] = [message("contacts_opened", count=len(found.between)), *told, *found.warnings]
    for stage, seconds in found.timings.items():
        result.timings[stage] = result.timings.get(stage, 0.0) + seconds
    whole = on_given(result, mesh, found)
    if chosen is not None and not isinstance(whole, Rigged):
        whole.feature_points[: len(chosen)] = chosen
    return whole


def surface_on_given(result: Result, mesh: PartedMesh, found: Contacts) -> Result:
    """Carry a form or a pose with its feature points and patches to the mesh as given.

    Parameters
    ----------
    result : CanonicalForm or PosedLike
        Of the parted mesh.
    mesh : PartedMesh
        That mesh.
    found : Contacts
        The contacts, with the mesh as given.

    Returns
    -------
    CanonicalForm or PosedLike
        The same on the vertices of the mesh as given.
    """
    return _surface_on_given(result, mesh, found, rows_on_given(mesh, found.vertices, found.representative))


def _surface_on_given(result: Result, mesh: PartedMesh, found: Contacts, rows: IntArray) -> Result:
    """Carry a form or a pose to the mesh as given, whose vertices are some rows of it, (n,)."""
    held = np.zeros(len(found.vertices), dtype=bool)
    held[found.faces.ravel()] = True
    held = held[found.representative]
    return replace(
        result,
        vertices=_shape_of_all(mesh, result.vertices, found),
        faces=found.faces.copy(),
        feature_points=given_of(mesh)[result.feature_points],
        patches=np.where(held, result.patches[rows], -1),
        adf=np.where(held, result.adf[rows], 0.0),
    )


def _match_on_given(result: Match, rows: IntArray) -> Match:
    """Carry a match to the mesh as given; borders that coincide in the other one stay as they are."""
    return replace(
        result,
        vertices=result.vertices[rows],
        faces=result.faces[rows],
        weights=result.weights[rows],
        confidence=result.confidence[rows],
        seams=None,
    )


def pose_on_given(result: PosedLike, mesh: PartedMesh, found: Contacts) -> PosedLike:
    """Carry a pose with its match to the mesh as given.

    Parameters
    ----------
    result : PosedLike
        Of the parted mesh.
    mesh : PartedMesh
        That mesh.
    found : Contacts
        The contacts, with the mesh as given.

    Returns
    -------
    PosedLike
        The same on the vertices of the mesh as given.
    """
    rows = rows_on_given(mesh, found.vertices, found.representative)
    return replace(_surface_on_given(result, mesh, found, rows), match=_match_on_given(result.match, rows))


def rig_on_given(result: Rigged, mesh: PartedMesh, found: Contacts) -> Rigged:
    """Carry a rig to the mesh as given.

    Parameters
    ----------
    result : Rigged
        Of the parted mesh.
    mesh : PartedMesh
        That mesh.
    found : Contacts
        The contacts, with the mesh as given.

    Returns
    -------
    Rigged
        The same on the vertices of the mesh as given.
    """
    rows, posed = rows_on_given(mesh, found.vertices, found.representative), _shape_of_all(mesh, result.vertices, found)
    return replace(result, vertices=posed, weights=result.weights[rows], match=_match_on_given(result.match, rows))


def form_on_parted(mesh: PartedMesh, form: CanonicalForm) -> CanonicalForm:
    """Carry a form of the mesh as given to the parted one, so that another form of it is aligned to it.

    Parameters
    ----------
    mesh : PartedMesh
        The parted mesh.
    form : CanonicalForm
        The form of the mesh as given.

    Returns
    -------
    CanonicalForm
        The same on the vertices of the parted mesh; that of the mesh as given, if a feature point lies in a contact.
    """
    given, first, bodies = given_of(mesh), mesh.copies(len(form.vertices)), []
    for body in form.bodies:
        vertices = np.flatnonzero(np.isin(given, body.vertices))
        tips = first[body.vertices[body.tips]]
        if (tips < 0).any():  # a tip lies inside of a contact
            return form
        bodies.append(body._replace(vertices=vertices, tips=np.searchsorted(vertices, tips)))
    return replace(form, vertices=form.vertices[given], faces=mesh.faces, bodies=bodies)


def _shape_of_all(mesh: PartedMesh, shape: FloatArray, found: Contacts) -> FloatArray:
    """Carry positions to all vertices as given: copies at seams too, and what is of no face stays. `shape` (n', 3)."""
    whole, used = found.vertices.copy(), np.unique(found.faces)
    whole[used] = shape_on_given(mesh, shape, len(whole), found.faces)[used]
    return whole[found.representative]
