"""What the surface of a body explains by one that is whole: the same in another pose, or one like it, of any kind."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from ..assembly.body import Body
from ..assembly.opening import opened
from ..matching.unfolded import Unfolded, unfolded
from ..measures.alignment import half_turns
from ..measures.form_measures import edge_stretch
from ..mesh.geometry import checked_arrays, surface_area, vertex_areas, vertex_normals
from ..method_api.settings import Settings
from ..numerics.arrays import FloatArray, IntArray
from ..rigging.articulated_fit import laid_on, nearest_of_posed
from ..rigging.bone_fit import BoneFit, fitted_bones
from ..rigging.candidates import candidates_of
from ..rigging.reference_rig import ReferenceRig
from ..rigging.references import Reference
from ..rigging.transport import transported_bones
from ..run.errors import errors_about
from ..run.messages import message
from ..run.monitor import Monitor
from .explained_skin import Explained, residual_of
from .on_given import Parted
from .patch_rig import PatchRig, patch_rig
from .suspicion import ENOUGH

_COUNTS = 8, 24, 60  # patches: of a body that is laid on as it stands, that was matched, and that lies about right
_FOREIGN = 0.01  # residual, in sqrt(area), above which a body is not explained: poses have .005, a cat by a dog .008
_STRETCHED = 0.25  # mean change of the logarithms of edges above which it is another kind: poses have .06 to .22
_LAID = 3  # times that bones are laid on by closest points


class WholeBody(NamedTuple):
    """A body whose skin has not grown together.

    Attributes
    ----------
    vertices : (n, 3) ndarray of float
        Its vertices, in any pose.
    faces : (m, 3) ndarray of int
        Its triangles.
    form : (n, 3) ndarray of float
        Its canonical form.
    eigenvalues : (k,) ndarray of float
        The lowest of its surface; empty if they are to be computed.
    """

    vertices: FloatArray
    faces: IntArray
    form: FloatArray
    eigenvalues: FloatArray


class _Form(Protocol):
    """A form."""

    @property
    def vertices(self) -> FloatArray: ...
    @property
    def faces(self) -> IntArray: ...
    @property
    def posed(self) -> FloatArray: ...
    @property
    def eigenvalues(self) -> FloatArray: ...
    @property
    def parted(self) -> Parted | None: ...


class Known(NamedTuple):
    """A whole body that others are explained by.

    Attributes
    ----------
    body : Unfolded
        The body.
    rigs : list of PatchRig
        Its working surface as rigs of more and more patches.
    whole : ReferenceRig
        All its vertices as the last of them.
    form : (n, 3) ndarray of float
        The form of all its vertices, of unit area.
    patch : (n,) ndarray of int
        Patch of each vertex, by feature points.
    """

    body: Unfolded
    rigs: list[PatchRig]
    whole: ReferenceRig
    form: FloatArray
    patch: IntArray


def whole_of(form: _Form | None) -> WholeBody | None:
    """Return the body that a form is of, parted where its skin has grown together; None for no form."""
    if form is None:
        return None
    of: _Form = form if form.parted is None else form.parted.result
    posed = of.posed if len(of.posed) == len(of.vertices) else of.vertices
    with errors_about(message("the_reference")):
        for points in (of.vertices, posed):
            checked_arrays(points, of.faces)
    return WholeBody(posed, of.faces, of.vertices, of.eigenvalues)


def lowest_eigenvalues(whole: WholeBody, settings: Settings, monitor: Monitor) -> FloatArray:
    """Return the lowest eigenvalues of a body, (k,), computed if they are not known."""
    known = whole.eigenvalues
    if len(known) >= ENOUGH and np.isfinite(known).all() and (known > 0).all():
        return known
    with errors_about(message("the_reference")):
        return _largest(whole, settings, monitor).features(None, settings, monitor).spectrum.eigenvalues


def known_body(whole: WholeBody, settings: Settings, monitor: Monitor) -> Known | None:
    """Divide a body that others are to be explained by into patches; None if it is of several parts.

    `settings`: of its surface.
    """
    with errors_about(message("the_reference")):
        body = _largest(whole, settings, monitor)
        if len(body.parts) > 1:
            return None
        found = body.features(None, settings, monitor)
        form = whole.form[body.vertices]
        form = form / np.sqrt(surface_area(form, found.whole_faces))
        surface = found.surface
        rigs = []
        for count in _COUNTS:  # of the working surface: all vertices of a large body take long
            monitor.check()
            rigs.append(patch_rig(surface.points, surface.faces, form[surface.kept], count))
        weights = np.maximum(surface.prolong(rigs[-1].weights), 0.0)
        weights /= np.maximum(weights.sum(axis=1, keepdims=True), np.finfo(float).tiny)
        whole_rig = ReferenceRig(found.whole_points, found.whole_faces, rigs[-1].skeleton, weights)
        return Known(unfolded(found, form, monitor), rigs, whole_rig, form, found.prolonged(monitor).cells)


def explained_by(one: Unfolded, known: Known, monitor: Monitor) -> Explained:
    """Find for all vertices of a body their places on the form of another.

    The other is bent onto it patch by patch, from two matches, and from where it stands with its longest axes along
    those of the body: a match is wrong where legs have grown together, and a body hardly moves that far. What explains
    the skin best counts.

    `one`: the body; `monitor`: with the stages "Ways to face" and "Limbs".

    References
    ----------
    Li, Sumner and Pauly, "Global correspondence optimization for non-rigid registration of depth scans", 2008,
    doi:10.1111/j.1467-8659.2008.01282.x.
    """
    surface = one.found.surface
    skin = surface.points, vertex_normals(surface.points, surface.faces), vertex_areas(surface.points, surface.faces)
    few, some, many = known.rigs

    def laid(rig: ReferenceRig, ways: list[BoneFit], times: int) -> tuple[float, BoneFit]:
        found = []
        for bones in ways:
            for _ in range(times):
                bones = laid_on(rig, bones, *skin, monitor)
            found.append((residual_of(rig, bones, *skin, monitor), bones))
        return min(found, key=lambda each: each[0])

    with monitor.stage("Ways to face"):
        ways = [each.fit.bones for each in candidates_of(one, Reference(some, known.body, known.whole), monitor)]
    with monitor.stage("Limbs"):
        stands = [transported_bones(few, each, *skin, monitor) for each in _standing(few, skin[0], skin[2])]
        nearest, _ = min(stands, key=lambda each: each[1])
        ways.append(transported_bones(some, _refined(few, nearest, some), *skin, monitor)[0])
        _, best = laid(some, ways, 1)
        residual, best = laid(many, [_refined(some, best, many)], _LAID)
    points, whole = one.found.whole_points, known.whole
    there = nearest_of_posed(whole, best, points, vertex_normals(points, one.found.whole_faces), monitor)
    names = [str(number) for number in range(int(known.patch.max()) + 1)]
    held = known.patch[there.nearest_corners(whole.faces)]
    stretch = edge_stretch(many.vertices, best.posed(many, many.vertices, many.weights), many.faces)
    stretched = float(np.abs(np.log(stretch[stretch > 0])).mean())
    convinces = residual <= _FOREIGN and stretched <= _STRETCHED
    return Explained(there.on(known.form, whole.faces), held, names, residual, convinces)


def _largest(whole: WholeBody, settings: Settings, monitor: Monitor) -> Body:
    """Return the largest body of a mesh."""
    bodies = opened(whole.vertices, whole.faces, settings, monitor)
    return bodies.bodies[bodies.largest_body]


def _standing(rig: ReferenceRig, points: FloatArray, areas: FloatArray) -> list[BoneFit]:
    """Place a body with its axes along those of another in all four ways, each as its file has it."""
    bones, own, count = rig.skeleton, vertex_areas(rig.vertices, rig.faces), len(rig.skeleton.names)
    found = []
    for turn, shift in half_turns(rig.vertices, own / own.sum(), points, areas / areas.sum()):
        turns = np.broadcast_to(turn.T, (count, 3, 3)).copy()
        found.append(BoneFit(bones.heads @ turn + shift, bones.tails @ turn + shift, turns, np.ones((count, 2))))
    return found


def _refined(few: ReferenceRig, bones: BoneFit, many: ReferenceRig) -> BoneFit:
    """Express the motion of few patches by many. Both: of the same vertices."""
    laid = bones.posed(few, few.vertices, few.weights)
    areas = vertex_areas(few.vertices, few.faces)
    return fitted_bones(many, laid, areas, many.vertices, many.weights, np.ones(len(laid)))
