"""Entry point for skin that has grown together: where two parts of a body have become one surface."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from .assembly.body import Body, Chosen
from .assembly.opening import OPENING, known_bodies, opened
from .fused.found_contacts import Contacts
from .fused.marks import Marks, marks_on, require_marks
from .fused.on_given import Given, given_of, rows_on_given
from .fused.parting import piece_count
from .fused.search import contacts_of, none_found
from .fused.suspicion import ENOUGH, SUSPECT, SUSPECT_BESIDE, is_tall, raised, unlike_whole_human
from .fused.whole_body import WholeBody, lowest_eigenvalues, whole_of
from .mesh.edges import vertex_pairs
from .mesh.geometry import checked_arrays
from .method_api.catalogue import DETECTION, method_named
from .method_api.settings import AnySettings, Settings, settings_from
from .numerics.arrays import FloatArray, IntArray
from .results import CanonicalForm, Match, PosedLike, Rigged
from .run.kept_stages import KeptStages
from .run.messages import Message, message
from .run.monitor import Cancelled, Monitor, Progress

if TYPE_CHECKING:
    from .fused.parting import PartedMesh

Found = TypeVar("Found", "CanonicalForm", "PosedLike", "Rigged", "Match")

_LOOKED_FOR = 0.8  # of the work, where something is computed afterwards
_MARKED = 0.1  # the same, where nothing is searched for
_FEWEST = 3  # feature points of a body that may be human: head and feet; a tube has two
_WORSE = 1.1  # times as unlike a whole human: what is parted must not be
_DETECTED = 0.4  # of the work of a form: where feature points and patches are found
_REPAIRS = ("repeated_corners", "coincident_borders", "duplicate_faces", "inconsistent_faces", "rounded_positions")


def find_contacts(
    vertices: ArrayLike,
    faces: ArrayLike,
    settings: AnySettings = None,
    *,
    reference: CanonicalForm | None = None,
    keep: KeptStages | None = None,
    progress: Progress | None = None,
    cancelled: Cancelled | None = None,
    **options: Any,
) -> Contacts:
    """Find where the skin of a body has grown together, as in scans, voxel sculpts and generated meshes.

    The skeleton of a mannequin is fitted to the largest body, its arms by search, as no match knows where they are.
    So every vertex gets a place on the mannequin, which stands with arms and legs spread. Skin between places that lie
    far apart has grown together if the way round over the surface is as long as that. A body that is not human is found
    by a reference, whose skin is bent onto it patch by patch; places are those on its form.

    Parameters
    ----------
    vertices : (n, 3) array_like of float
        Vertex positions, any unit of length.
    faces : (m, 3) array_like of int
        Triangles, in any state that docs/any-mesh.md lists.
    settings : Settings or mapping, optional
        Options of the form by which the mannequin is matched.
    reference : CanonicalForm, optional
        A form of the same body in another pose, or of a body like it, whose skin has not grown together.
    keep : KeptStages, optional
        Results of earlier runs.
    progress : callable, optional
        Called with the fraction done (0 to 1) and the name of the stage.
    cancelled : callable, optional
        Polled at least twice a second; the computation stops when it returns True.
    **options
        Options by name, over those of `settings`: ``quality="draft"``.

    Returns
    -------
    Contacts
        The triangles in which it has; `parted` opens them. A body of several parts, or one that is neither human nor
        like the reference, is left as it is.

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
    settings, kept, monitor = settings_from(settings, options), keep or KeptStages(), Monitor(progress, cancelled)
    return contacts_of(vertices, faces, settings, kept, monitor, whole_of(reference))


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
    known: WholeBody | None = None,
    *,
    formed: float = 1.0,
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
    known : WholeBody, optional
        A body like it, by which contacts are found on one that is not human.
    formed : float
        Share of the computation that the form of the mesh is, whose beginning is looked at.

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
    unlike = _unlike(points, corners, plain, kept, monitor, known, _DETECTED * formed) if looked_at else 0.0
    if unlike <= 1.0 and settings.part_here is None:
        if keep is None:
            kept.fill()  # large meshes would fill the memory
        result = compute(points, corners, plain, rest=rest, keep=kept, progress=monitor.report, cancelled=cancelled)
        _add_timings(result, monitor)
        return result
    chosen = settings.feature_points
    if chosen is not None or rest is not None:  # rejected before the search, not after it
        how: dict[str, Any] = {
            "together": settings.together,
            "features": chosen,
            "names": settings.feature_names,
            "rest": rest,
        }
        known_bodies(points, corners, Monitor(cancelled=cancelled), **how)
    share = _LOOKED_FOR if unlike > 1.0 else _MARKED
    found: Contacts = _found(points, corners, settings, kept, monitor.piece(0.0, share, {}), unlike > 1.0, known)
    kept_parted = kept.part("Parted")
    mesh: tuple[Contacts, PartedMesh] | None
    doubts: list[Message]
    marks = marks_on(found.faces, found.representative, settings)
    mesh, doubts = _parted(found, marks, unlike, plain, kept_parted, monitor, known)
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


def _unlike(
    points: FloatArray,
    faces: IntArray,
    settings: Settings,
    kept: KeptStages,
    monitor: Monitor,
    whole: WholeBody | None,
    share: float,
) -> float:
    """Measure how unlike a whole human the largest body is, or `whole` if it is none: above 1 it is suspect.

    What that needs is kept for the run that follows. `share`: of the work that this is.
    """

    def report(done: float, stage: str) -> None:
        monitor.report(share * done, stage)

    if settings.eigenpairs < ENOUGH:
        settings = replace(settings, eigenpairs=ENOUGH)
    plain = settings.detecting()
    own = Monitor(report, monitor.is_cancelled, OPENING, kept)
    own.timings = monitor.timings
    bodies = opened(points, faces, settings, own)
    largest = bodies.largest_body
    if len(bodies.bodies[largest].parts) > 1:  # parts that touch are apart already
        return 0.0

    def measured(body: Body, chosen: Chosen | None, of_body: Monitor) -> float:
        found = body.features(chosen, settings, of_body)
        eigenvalues = found.spectrum.eigenvalues
        if len(found.features) < _FEWEST:
            return 0.0
        human = unlike_whole_human(eigenvalues) / SUSPECT
        if whole is None or (is_tall(eigenvalues) and human <= 1.0):
            return human
        quiet = Monitor(cancelled=monitor.is_cancelled, keep=kept.part("Whole body"))
        others = lowest_eigenvalues(whole, plain, quiet)
        beside = raised(eigenvalues, others) / SUSPECT_BESIDE
        if not is_tall(eigenvalues):
            return beside
        of_no_human = is_tall(others) and unlike_whole_human(others) > SUSPECT  # such as a giraffe
        return min(human, beside) if of_no_human else human

    return bodies.map(measured, own, DETECTION, bodies.chosen)[largest]


def _parted(
    found: Contacts,
    marks: Marks,
    unlike: float,
    plain: Settings,
    kept: KeptStages,
    monitor: Monitor,
    known: WholeBody | None,
) -> tuple[tuple[Contacts, PartedMesh] | None, list[Message]]:
    """Part a mesh, unless it is less like a whole body then than before, and say what is doubtful.

    `unlike`: how unlike it is; `plain`: the settings of what is computed afterwards. Gives None if nothing is parted.
    """
    both = _with_marks(found, marks)
    mesh = both.parted(cancelled=monitor.is_cancelled) if both.touched.any() else None
    if unlike > 1.0 and mesh is not None:
        after = _unlike(mesh.vertices, mesh.faces, plain.detecting(), kept, monitor, known, _DETECTED)
        if both.between and after > _WORSE * unlike:
            both = _with_marks(replace(found, gone=np.zeros_like(found.gone), between=[]), marks)
            mesh = both.parted(cancelled=monitor.is_cancelled) if both.touched.any() else None
        unlike = min(unlike, after)
    doubts = _doubts(both, mesh, marks)
    if unlike > 1.0 and both.explained:
        doubts.append(message("contacts_left") if known is None else message("contacts_left_beside"))
    elif unlike > 1.0 and known is not None:
        doubts.append(message("contacts_unknown"))
    return (None if mesh is None else (both, mesh)), doubts


def _found(
    points: FloatArray,
    faces: IntArray,
    settings: Settings,
    kept: KeptStages,
    monitor: Monitor,
    searched: bool,
    known: WholeBody | None,
) -> Contacts:
    """Find contacts, or read the mesh for its marks only."""
    plain = Settings(pieces=settings.pieces, memory_limit=settings.memory_limit)  # whatever unfolds it later
    sources = [points, faces, repr(plain), searched, *(known or (None,) * 3)[:3]]

    def find() -> Contacts:
        if searched:
            return contacts_of(points, faces, plain, kept, monitor, known)
        return none_found(points, faces, plain, monitor)

    return kept.take("Contacts", sources, find, [])


def _add_timings(result: CanonicalForm | PosedLike | Rigged | Match, monitor: Monitor) -> None:
    """Add the seconds that were spent before a result was computed, in the order in which they were."""
    later = dict(result.timings)
    result.timings.clear()
    result.timings.update(monitor.timings)
    for stage, seconds in later.items():
        result.timings[stage] = result.timings.get(stage, 0.0) + seconds


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
