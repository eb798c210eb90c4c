"""Entry point for skin that has grown together: where two parts of a human body have become one surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .assembly.opening import OPENING
from .assembly.unfolded_bodies import unfolded_bodies
from .fused.contact_faces import contact_faces, contacts_between
from .fused.star_rest import star_rest
from .matching.unfolded import Unfolded
from .mesh.geometry import surface_area, vertex_areas, vertex_normals
from .mesh.tables import rows_in
from .method_api.settings import Settings
from .modelling.mannequins import mannequin
from .numerics.arrays import FloatArray, IntArray
from .results import Contacts
from .rigging.arm_search import searched_arms
from .rigging.articulated_fit import laid_on, nearest_of_posed
from .rigging.bone_fit import BoneFit
from .rigging.candidates import candidates
from .rigging.reference_rig import mannequin_rig
from .rigging.references import Reference, unfolded_reference
from .run.kept_stages import KeptStages
from .run.monitor import Cancelled, Monitor, Progress

_UNFOLDED, _FITTED = 0.4, 0.8  # of the work
_FOREIGN = 0.012  # residual above which the mannequin does not explain the body: humans have .006 to .009
_PLAN = {"Ways to face": 3, "Arms": 3, "Contacts": 1}


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
            best = candidates(one, human, lambda: [], piece)[0]
        own, held, residual = _explained(one, human, best.fit.bones, piece)
        explained = residual <= _FOREIGN
        if explained:
            with piece.stage("Contacts"):
                places[body.vertices] = own
                here = contact_faces(one.found.whole_points, body.faces, own, piece)
                between = contacts_between(body.faces[here], held)
            gone[rows_in(body.vertices[body.faces[here]], bodies.faces)] = True
    names = [] if human is None else human.whole.skeleton.names
    sides = [(names[one], names[two]) for one, two in between]
    return Contacts(
        bodies.vertices, bodies.faces, gone, places, sides, explained, residual, monitor.timings, monitor.warnings
    )


def _explained(
    one: Unfolded, lender: Reference, bones: BoneFit, monitor: Monitor
) -> tuple[FloatArray, IntArray, float]:
    """Find for all vertices of a body their places in the star-shaped rest, (n, 3), and the bones that hold them, (n,).

    Also how far the skin lies from that of the mannequin in the mean, in sizes of the body.
    """
    own, surface = one.found, one.found.surface
    with monitor.stage("Arms"):
        normals, areas = vertex_normals(surface.points, surface.faces), vertex_areas(surface.points, surface.faces)
        found = searched_arms(lender.rig, bones, surface.points, surface.faces, areas, monitor)
        bones = laid_on(lender.rig, bones if found is None else found, surface.points, normals, areas, monitor)
    normals = vertex_normals(own.whole_points, own.whole_faces)
    there = nearest_of_posed(lender.whole, bones, own.whole_points, normals, monitor)
    whole = lender.whole
    weights = there.on(whole.weights, whole.faces)
    apart = np.linalg.norm(
        bones.posed(whole, there.on(whole.vertices, whole.faces), weights) - own.whole_points, axis=1
    )
    areas = vertex_areas(own.whole_points, own.whole_faces)
    residual = float(areas @ apart / areas.sum() / np.ptp(own.whole_points, axis=0).max())
    return there.on(star_rest(whole), whole.faces), weights.argmax(axis=1), residual
