"""The main entry points: from a mesh to its canonical form, in the order of the paper, and from many meshes."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .assembly.body import Body, Chosen
from .assembly.gathering import gathered_features, shaped
from .assembly.opening import OPENING, opened
from .measures.form_measures import is_unchanged
from .measures.limb_bends import limb_bends
from .mesh.handles import handle_count
from .method_api.catalogue import DETECTION, Method, method_named
from .method_api.settings import AnySettings, Settings, settings_from
from .numerics.arrays import FloatArray, IntArray
from .results import CanonicalForm
from .run.errors import CanonicalFormError
from .run.kept_stages import KeptStages
from .run.messages import doubts_first
from .run.monitor import Cancelled, Monitor, Progress
from .symmetry.trunk_twist import TWISTED, trunk_twist

if TYPE_CHECKING:
    from concurrent.futures import Future

    from .assembly.bodies import Bodies
    from .fused.found_contacts import Contacts
    from .fused.on_given import Given
    from .fused.parting import PartedMesh
    from .method_api.method_result import MethodResult
    from .method_api.surface_features import SurfaceFeatures, WholeFeatures
    from .placing.reference import ReferenceBody
    from .symmetry.limbs import BodyLimbs


def canonical_form(
    vertices: ArrayLike,
    faces: ArrayLike,
    settings: AnySettings = None,
    *,
    rest: ArrayLike | None = None,
    reference: CanonicalForm | None = None,
    progress: Progress | None = None,
    cancelled: Cancelled | None = None,
    keep: KeptStages | None = None,
    **options: Any,
) -> CanonicalForm:
    """Compute the canonical form of a posed mesh: its shape with the pose removed.

    Parameters
    ----------
    vertices : (n, 3) array_like of float
        Vertex positions, any unit of length.
    faces : (m, 3) array_like of int
        Triangles of one or several surfaces, with or without borders, in any state that docs/any-mesh.md lists.
    settings : Settings or mapping, optional
        Options.
    rest : (n, 3) array_like of float, optional
        Positions of the same vertices in the rest pose of a rig. If given, they and not the pose tell which loose parts
        belong together and where: in a T-pose, no hand touches a thigh.
    reference : CanonicalForm, optional
        A form of the same mesh in another pose, or of a mesh of a similar body. The form is aligned to it by a proper
        rotation and a translation, and its limbs get the same numbers. Skin that has grown together is found by it,
        too, of animals as well.
    progress : callable, optional
        Called with the fraction done (0 to 1) and the name of the stage.
    cancelled : callable, optional
        Polled at least twice a second; the computation stops when it returns True.
    keep : KeptStages, optional
        Pass the same object to successive runs on one mesh: each recomputes only what changed.
    **options
        Options by name, over those of `settings`: ``quality="draft"``.

    Returns
    -------
    CanonicalForm
        The form, feature points, patches and figures.

    Raises
    ------
    InvalidMeshError
        If the mesh cannot be used; the message says what to do.
    InvalidSettingsError
        If a feature point given by hand is not a vertex of a surface, or is given twice, or the reference has no
        feature points.
    TooLargeError
        If all pairs inside the patches do not fit into the memory limit.
    SolverError
        If the spectrum cannot be computed accurately.
    CancelledError
        If `cancelled` returned True.

    Examples
    --------
    >>> tetrahedron = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> form = canonical_form(tetrahedron, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> form.vertices.shape
    (4, 3)

    References
    ----------
    "Local Feature-Based 3D Canonical Form".
    """
    settings = settings_from(settings, options)
    if reference is not None:
        from .placing.reference import require_limbs

        require_limbs(reference)
    if settings.parts:
        from .contacts import computed_open
        from .fused.whole_body import whole_of

        compute = partial(_like_given, reference=reference)
        known = whole_of(reference)
        return computed_open(compute, _on_given, vertices, faces, settings, keep, progress, cancelled, rest, known)
    return _form(vertices, faces, settings, rest, reference, Monitor(progress, cancelled, OPENING, keep))


def canonical_forms(
    meshes: Iterable[tuple[ArrayLike, ArrayLike]],
    settings: AnySettings = None,
    *,
    workers: int | None = None,
    **options: Any,
) -> Iterator[CanonicalForm | CanonicalFormError]:
    """Compute the canonical forms of many meshes, in several processes.

    Parameters
    ----------
    meshes : iterable of (vertices, faces)
        As in `canonical_form`; a generator is read as far as the work has come.
    settings : Settings or mapping, optional
        Options, for all of them.
    workers : int, optional
        Number of processes; without it, one for each processor; 1 computes in this one. A script that starts others
        needs ``if __name__ == "__main__":``.
    **options
        Options by name, over those of `settings`.

    Returns
    -------
    iterator of CanonicalForm or CanonicalFormError
        For each mesh, in order, its form, or why there is none: an odd mesh does not stop the others.

    Raises
    ------
    InvalidSettingsError
        If an option does not exist, or has a value that is not allowed.

    Examples
    --------
    >>> tetrahedron = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> meshes = [(tetrahedron, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]), (tetrahedron, [])]
    >>> [type(each).__name__ for each in canonical_forms(meshes, workers=1, quality="draft")]
    ['CanonicalForm', 'InvalidMeshError']
    """
    return _forms(meshes, settings_from(settings, options), workers or os.cpu_count() or 1)


def _forms(
    meshes: Iterable[tuple[ArrayLike, ArrayLike]], settings: Settings, workers: int
) -> Iterator[CanonicalForm | CanonicalFormError]:
    """Compute forms in processes, a few meshes ahead of what is taken."""
    if workers == 1:
        yield from (_form_or_error(*mesh, settings) for mesh in meshes)
        return
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing import get_context

    ahead: deque[Future[CanonicalForm | CanonicalFormError]] = deque()
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:  # threads of BLAS do not survive a fork
        for mesh in meshes:
            ahead.append(pool.submit(_form_or_error, *mesh, settings))
            if len(ahead) > 2 * workers:
                yield ahead.popleft().result()
        while ahead:
            yield ahead.popleft().result()


def _form_or_error(vertices: ArrayLike, faces: ArrayLike, settings: Settings) -> CanonicalForm | CanonicalFormError:
    """Compute a form, or return why there is none."""
    try:
        return canonical_form(vertices, faces, settings)
    except CanonicalFormError as error:
        return error


def _like_given(
    vertices: FloatArray,
    faces: IntArray,
    settings: Settings,
    mesh: PartedMesh | None = None,
    found: Contacts | None = None,
    *,
    reference: CanonicalForm | None,
    **how: Any,
) -> CanonicalForm:
    """Compute a form, aligned to a reference that may be one of the mesh before it was parted."""
    from .fused.on_given import form_on_parted

    if mesh is not None and found is not None and reference is not None and _is_form_of(found, reference):
        reference = form_on_parted(reference, mesh)
    return canonical_form(vertices, faces, settings, reference=reference, **how)


def _is_form_of(found: Contacts, form: CanonicalForm) -> bool:
    """Return whether a form is one of the mesh whose contacts were found."""
    return np.array_equal(form.faces, found.faces)


def _on_given(form: CanonicalForm, mesh: PartedMesh, given: Given) -> CanonicalForm:
    """Carry the form of a parted mesh to the mesh as given."""
    from .fused.on_given import limbs_on_given, surface_on_given

    whole = surface_on_given(form, mesh, given)
    return replace(whole, bodies=limbs_on_given(mesh, form.bodies), posed=given.vertices.copy())


def _form(
    vertices: ArrayLike,
    faces: ArrayLike,
    settings: Settings,
    rest: ArrayLike | None,
    reference: CanonicalForm | None,
    monitor: Monitor,
) -> CanonicalForm:
    """Compute the form of a mesh as it is."""
    from .placing.reference import reference_bodies

    method = method_named(settings.method)
    settings = method.settings(settings)
    bodies = opened(vertices, faces, settings, monitor, rest=rest)
    handles = 0 if rest is not None else monitor.kept("handles", [bodies], lambda: _handles(bodies))
    if handles:
        monitor.warn("handles", count=handles)
    others = reference_bodies(reference, bodies.faces, [body.vertices for body in bodies.bodies], monitor)
    plan = {**DETECTION, **method.stages, "Alignment": 1}
    forms = bodies.map(partial(_body_form, method=method, settings=settings), monitor, plan, bodies.chosen, others)
    form = shaped(bodies, [each.points for each in forms], monitor, area_kept=method.area_kept)
    features = gathered_features(bodies, [each.features for each in forms])
    if is_unchanged(bodies.vertices, form, bodies.faces):
        monitor.warn("hardly_unbent")
    histories = [each.embedded.history for each in forms]
    pair_count = sum(each.embedded.pair_count for each in forms)
    return CanonicalForm(
        form,
        bodies.faces,
        features.points,
        features.patches,
        features.adf,
        _summed(histories),
        pair_count,
        1 - pair_count / len(form) ** 2 if pair_count else 0.0,
        monitor.timings,
        doubts_first(monitor.warnings),
        float(np.fmax.reduce([each.embedded.asymmetry for each in forms])),
        features.bodies,
        _numbered([each.bends for each in forms], features.bodies),
        posed=bodies.vertices.copy(),
        eigenvalues=forms[bodies.largest_body].eigenvalues.copy(),
        feature_names=features.numbered([each.names for each in forms]),
    )


def _handles(bodies: Bodies) -> int:
    """Count the handles of the bodies in one piece."""
    return sum(handle_count(body.faces) for body in bodies.bodies if len(body.parts) < 2)


def _numbered(bends: list[FloatArray], bodies: list[BodyLimbs]) -> FloatArray:
    """Sort the values of the limbs of all bodies by the numbers of their feature points."""
    values = np.concatenate(bends)
    values[np.concatenate([body.numbers for body in bodies])] = values.copy()
    return values


def _summed(histories: list[FloatArray]) -> FloatArray:
    """Sum the stresses of bodies, step by step; a history that has ended keeps its last value."""
    steps = max(map(len, histories))
    if steps == 0:
        return np.empty(0)
    return np.asarray(np.sum([np.pad(each, (0, steps - len(each)), mode="edge") for each in histories], axis=0))


class _BodyForm(NamedTuple):
    """The placed form of a body, its features and their names, the result of the method, bends, and eigenvalues."""

    points: FloatArray
    features: WholeFeatures
    names: list[str]  # of the feature points
    embedded: MethodResult
    bends: FloatArray  # (k, 2)
    eigenvalues: FloatArray  # (K,)


def _body_form(
    body: Body,
    chosen: Chosen | None,
    reference: ReferenceBody | None,
    monitor: Monitor,
    *,
    method: Method,
    settings: Settings,
) -> _BodyForm:
    """Find the features of a body, unfold it, and place the form."""
    from .placing.orientation import in_place, names_in_form

    found = body.features(chosen, settings, monitor)
    embedded = method.unfold(found, settings, monitor)
    with monitor.stage("Alignment"):
        if method.area_kept:
            embedded = embedded.of_unit_area(found.whole_faces)
        points, order = in_place(embedded, found, settings, reference, monitor)
        names = names_in_form(embedded, found)
        features = monitor.kept("shown", [found, order], lambda: found.prolonged(monitor, order))
        if trunk_twist(points[found.whole_features], found.limbs) > TWISTED:
            monitor.warn("twisted")
        bends = np.column_stack([_bends(found, shape) for shape in (found.whole_points, points)])[order]
    named = [names[each] for each in order]
    return _BodyForm(points, features, named, embedded, bends, found.spectrum.eigenvalues)


def _bends(found: SurfaceFeatures, shape: FloatArray) -> FloatArray:
    """Measure how far the limbs are bent in a shape of the whole surface."""
    return limb_bends(shape[found.surface.kept], found.mass, found.cells, found.limbs.to_features)
