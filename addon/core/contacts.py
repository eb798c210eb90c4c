"""Entry point for skin that has grown together: where two parts of a human body have become one surface."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from .assembly.body import Body
from .assembly.opening import OPENING, known_bodies, opened
from .assembly.unfolded_bodies import unfolded_bodies
from .fused.contact_faces import contact_faces, contacts_between
from .fused.explained_skin import explained_skin
from .fused.marks import Marks, marks_on, require_marks
from .fused.on_given import Given, given_of, rows_on_given
from .fused.parting import piece_count
from .fused.suspicion import SUSPECT, unlike_whole_human
from .mesh.edges import vertex_pairs
from .mesh.geometry import checked_arrays
from .mesh.tables import rows_in
from .method_api.catalogue import DETECTION, method_named
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
    from .assembly.bodies import Bodies
    from .fused.parting import PartedMesh

Found = TypeVar("Found", "CanonicalForm", "PosedLike", "Rigged", "Match")

_UNFOLDED = 0.4  # of the work
_LOOKED_FOR = 0.8  # the same, where something is computed afterwards
_MARKED = 0.1  # the same, where nothing is searched for
_FEWEST = 3  # feature points of a body that may be human: head and feet; a tube has two
_WORSE = 1.1  # times as unlike a whole human: what is parted must not be
_DETECTED = 0.4  # the same, where feature points and patches are found
_NO_EDGES = np.empty((0, 2), dtype=np.int64)
_HOPELESS = 0.016  # residual by a match above which limbs need not be searched for: humans have up to .0126
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
    largest = _largest(bodies)
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
        own, held, residual = places[body.vertices], np.empty(0, dtype=np.int64), best.residual
        if residual <= _HOPELESS:
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
        _NO_EDGES,
        places,
        [(names[one], names[two]) for one, two in between],
        explained,
        residual,
        monitor.timings,
        [*told, message("contacts_largest")] if len(bodies.bodies) > 1 else told,
    )


def computed_open(
    compute: Callable[..., Found],
    on_given: Callable[[Found, PartedMesh, Given], Found],
    vertices: ArrayLike,
    faces: ArrayLike,
    settings: Settings,
    keep: KeptStages | None,
    progress: Progress | None,
    cancelled: Cancelled | None,
    rest: ArrayLike | None = None,
) -> Found:
    """Find contacts, and compute something on the mesh that is parted there.

    Parameters
    ----------
    compute : callable
        Takes vertices, faces and settings, if they are parted that mesh and the contacts, and `keep`, `progress` and
        `cancelled` by name.
    on_given : callable
        Takes its result, the parted mesh and the mesh as given, and gives the result on that.
    vertices, faces, keep, progress, cancelled
        As in `find_contacts`.
    settings : Settings
        Options of the computation.
    rest : (n, 3) array_like of float, optional
        Positions in the rest pose of a rig, as in `canonical_form`: only what was marked is parted.

    Returns
    -------
    CanonicalForm, PosedLike, Rigged or Match
        The result; a warning says in how many places the mesh was parted, or that nothing is known of it.

    Raises
    ------
    CanonicalFormError
        As in `find_contacts`, and of the computation.
    """
    settings = method_named(settings.method).settings(settings)
    kept, monitor = keep or KeptStages(), Monitor(progress, cancelled)
    points, corners = checked_arrays(vertices, faces)
    points, corners = points.copy(), corners.copy()  # what is kept must not change
    require_marks(settings, len(points))
    plain = replace(settings, contacts="keep", part_here=None, keep_joined=None)
    looked_at = settings.contacts == "open" and rest is None
    unlike = _unlike(points, corners, plain, kept, monitor) if looked_at else 0.0
    if unlike <= SUSPECT and settings.part_here is None:
        if keep is None:
            kept.fill()  # large meshes would fill the memory
        result = compute(points, corners, plain, rest=rest, keep=kept, progress=monitor.report, cancelled=cancelled)
        _add_timings(result, monitor)
        return result
    chosen = settings.feature_points
    if chosen is not None or rest is not None:  # rejected before the search, not after it
        how: dict[str, Any] = {"together": settings.together, "features": chosen, "rest": rest}
        known_bodies(points, corners, Monitor(cancelled=cancelled), **how)
    share = _LOOKED_FOR if unlike > SUSPECT else _MARKED
    found: Contacts = _found(points, corners, settings, kept, monitor.piece(0.0, share, {}), unlike > SUSPECT)
    kept_parted = kept.part("Parted")
    mesh: tuple[Contacts, PartedMesh] | None
    doubts: list[Message]
    mesh, doubts = _parted(
        found, marks_on(found.faces, found.representative, settings), unlike, plain, kept_parted, monitor
    )
    how = {
        "keep": kept if mesh is None else kept_parted,
        "progress": lambda done, stage: monitor.report(share + (1 - share) * done, stage),
        "cancelled": cancelled,
    }
    if mesh is None:
        result = compute(points, corners, plain, rest=rest, **how)
        result.warnings[:0] = doubts
        _add_timings(result, monitor)
        return result
    found, parted = mesh
    how["rest"] = None if rest is None else np.asarray(rest)[given_of(parted)]
    if chosen is not None:
        numbers = rows_on_given(parted, found.vertices, found.representative)
        plain = replace(plain, feature_points=[int(numbers[each]) for each in chosen])
    result = compute(parted.vertices, parted.faces, plain, parted, found, **how)
    own: list[Message] = [each for each in result.warnings if each.kind not in _REPAIRS]  # of what was made here
    result.warnings[:] = [*doubts, *own, *(each for each in found.warnings if each not in own)]
    _add_timings(result, monitor)
    whole = on_given(result, parted, found.given)
    if chosen is not None and isinstance(whole, CanonicalForm | PosedLike):
        whole.feature_points[: len(chosen)] = chosen
    return whole


def _unlike(points: FloatArray, faces: IntArray, settings: Settings, kept: KeptStages, monitor: Monitor) -> float:
    """Measure how unlike a whole human the largest body is; what that needs is kept for the run that follows."""

    def report(done: float, stage: str) -> None:
        monitor.report(_DETECTED * done, stage)

    own = Monitor(report, monitor.is_cancelled, OPENING, kept)
    own.timings = monitor.timings
    bodies = opened(points, faces, settings, own)
    largest = _largest(bodies)
    if len(bodies.bodies[largest].parts) > 1:  # parts that touch are apart already
        return 0.0

    def unlike(body: Body, chosen: IntArray | None, of_body: Monitor) -> float:
        found = body.features(chosen, settings, of_body)
        return unlike_whole_human(found.spectrum.eigenvalues) if len(found.features) >= _FEWEST else 0.0

    return bodies.map(unlike, own, DETECTION, bodies.chosen_vertices)[largest]


def _parted(
    found: Contacts, marks: Marks, unlike: float, plain: Settings, kept: KeptStages, monitor: Monitor
) -> tuple[tuple[Contacts, PartedMesh] | None, list[Message]]:
    """Part a mesh, unless it is less like a whole human then than before, and say what is doubtful.

    `unlike`: how unlike it is; `plain`: the settings of what is computed afterwards. Gives None if nothing is parted.
    """
    both = _with_marks(found, marks)
    mesh = both.parted(cancelled=monitor.is_cancelled) if both.touched.any() else None
    if unlike > SUSPECT and mesh is not None:
        after = _unlike(mesh.vertices, mesh.faces, replace(plain, feature_points=None), kept, monitor)
        if both.between and after > _WORSE * unlike:
            both = _with_marks(replace(found, gone=np.zeros_like(found.gone), between=[]), marks)
            mesh = both.parted(cancelled=monitor.is_cancelled) if both.touched.any() else None
        unlike = min(unlike, after)
    doubts = _doubts(both, mesh, marks)
    if both.explained and unlike > SUSPECT:
        doubts.append(message("contacts_left"))
    return (None if mesh is None else (both, mesh)), doubts


def _found(
    points: FloatArray, faces: IntArray, settings: Settings, kept: KeptStages, monitor: Monitor, searched: bool
) -> Contacts:
    """Find contacts, or read the mesh for its marks only."""
    plain = Settings(pieces=settings.pieces, memory_limit=settings.memory_limit)  # whatever unfolds it later
    find = contacts_of if searched else _nothing_found
    sources = [points, faces, repr(plain), searched]
    return kept.take("Contacts", sources, lambda: find(points, faces, plain, kept, monitor), [])


def _add_timings(result: CanonicalForm | PosedLike | Rigged | Match, monitor: Monitor) -> None:
    """Add the seconds that were spent before a result was computed, in the order in which they were."""
    later = dict(result.timings)
    result.timings.clear()
    result.timings.update(monitor.timings)
    for stage, seconds in later.items():
        result.timings[stage] = result.timings.get(stage, 0.0) + seconds


def _nothing_found(
    vertices: ArrayLike, faces: ArrayLike, settings: Settings, _: KeptStages, monitor: Monitor
) -> Contacts:
    """Read a mesh for what is marked on it, without a search."""
    bodies = known_bodies(vertices, faces, monitor, together=settings.together)
    size = bodies.bodies[_largest(bodies)].size
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


def _with_marks(found: Contacts, marks: Marks) -> Contacts:
    """Add what is marked to contacts, and leave out those that are to stay joined."""
    part = marks.part[found.faces]
    gone = (found.gone & ~marks.joined[found.faces].any(axis=1)) | part.all(axis=1)
    pairs = vertex_pairs(found.faces[part.any(axis=1)])
    return replace(found, gone=gone, cut=pairs[marks.part[pairs].all(axis=1)])


def _doubts(found: Contacts, mesh: PartedMesh | None, marks: Marks) -> list[Message]:
    """Say what was parted without being marked, what could not be, and what came off."""
    told: list[Message] = []
    if mesh is not None and found.between:
        told.append(message("contacts_opened", count=len(found.between)))
    if marks.whole:
        told.append(message("part_here_all"))
    elif marks.given and mesh is None:
        told.append(message("part_here_nothing"))
    loose = 0 if mesh is None or not marks.given else piece_count(mesh.faces) - piece_count(found.faces)
    return [*told, message("part_here_loose", count=loose)] if loose > 0 else told


def _largest(bodies: Bodies) -> int:
    """Return the number of the largest body."""
    return int(np.argmax([body.size for body in bodies.bodies]))
