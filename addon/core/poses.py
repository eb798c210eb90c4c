"""Entry point for pose transfer: a mesh in the pose of another."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .assembly.gathering import gathered_features, shaped
from .deformation.elastic_body import ElasticBody
from .deformation.struts import struts_through
from .matches import UNFOLDED, MatchedBodies, matched_bodies
from .matching.point_map import PointMap
from .matching.sides import require_side
from .matching.unfolded import Unfolded
from .measures.form_measures import median_distortion
from .mesh.geometry import moved_by_frames, vertex_areas
from .method_api.settings import AnySettings, Settings, settings_from
from .numerics.arrays import FloatArray
from .posing.symmetric_pose import mirror_planes, symmetric_pose
from .posing.taken_pose import taken_pose
from .posing.untangling import untangled
from .results import PosedLike
from .run.errors import InvalidMeshError
from .run.monitor import Cancelled, Monitor, Progress
from .symmetry.limb_names import limb_names
from .symmetry.mirror import MirrorMap
from .symmetry.partners import mirror_partners

_MATCHED = 0.9  # of the work
_SAMPLED = 4  # one of so many working vertices decides which swap of left and right it is


def pose_like(
    vertices: ArrayLike,
    faces: ArrayLike,
    reference_vertices: ArrayLike,
    reference_faces: ArrayLike,
    settings: AnySettings = None,
    *,
    side: str | int = "auto",
    reference_pose: ArrayLike | None = None,
    rest: ArrayLike | None = None,
    progress: Progress | None = None,
    cancelled: Cancelled | None = None,
    **options: Any,
) -> PosedLike:
    """Transfer the pose of another mesh of a similar body to a mesh, which keeps its shape.

    Parameters
    ----------
    vertices : (n, 3) array_like of float
        Vertex positions, any unit of length.
    faces : (m, 3) array_like of int
        Triangles, in any state that docs/any-mesh.md lists.
    reference_vertices : (n', 3) array_like of float
        Vertices of the mesh whose pose is wanted, in any unit.
    reference_faces : (m', 3) array_like of int
        Its triangles.
    settings : Settings or mapping, optional
        Options of both forms; chosen feature points refer to the first mesh.
    side : str or int
        As in `match`.
    reference_pose : (n', 3) array_like of float, optional
        Vertices of the reference in the wanted pose, if it differs from the pose in which the reference is matched: for
        a rigged character matched as modelled, the current pose of its rig.
    rest : (n, 3) array_like of float, optional
        Positions of the mesh in the rest pose of its rig, as in `canonical_form`.
    progress : callable, optional
        Called with the fraction done (0 to 1) and the name of the stage.
    cancelled : callable, optional
        Polled at least twice a second; the computation stops when it returns True.
    **options
        Options by name, over those of `settings`: ``quality="draft"``.

    Returns
    -------
    PosedLike
        The mesh in that pose.

    Raises
    ------
    CanonicalFormError
        As in `match`, and if `reference_pose` does not have one position for each vertex of the reference.

    Examples
    --------
    >>> corner = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]])
    >>> faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
    >>> pose_like(corner, faces, corner, faces).vertices.shape
    (4, 3)

    References
    ----------
    Sumner and Popović, "Deformation Transfer for Triangle Meshes", 2004, doi:10.1145/1015706.1015736.
    """
    from .contacts import computed_open
    from .fused.on_given import pose_on_given

    require_side(side)
    pose = _wanted(reference_vertices if reference_pose is None else reference_pose, reference_vertices)

    def compute(
        points: ArrayLike, corners: ArrayLike, own: Settings, *_: object, rest: ArrayLike | None = None, **how: Any
    ) -> PosedLike:
        monitor, others = Monitor(how["progress"], how["cancelled"]), (reference_vertices, reference_faces)
        found = matched_bodies(points, corners, *others, own, side, monitor, _MATCHED, rest=rest, keep=how["keep"])
        return _pose_of(found, pose, monitor)

    wanted = settings_from(settings, options)
    formed = _MATCHED * UNFOLDED / 2
    return computed_open(
        compute, pose_on_given, vertices, faces, wanted, None, progress, cancelled, rest, formed=formed
    )


def _pose_of(found: MatchedBodies, wanted: FloatArray, monitor: Monitor) -> PosedLike:
    """Put bodies into the pose of those that they are matched with. `wanted` (n', 3): positions of the latter."""
    shapes = [body.points for body in found.bodies.bodies]
    count = len(found.maps)
    for number, ((here, there), each) in enumerate(zip(found.pairs, found.maps, strict=True)):
        begin, end = (_MATCHED + (1 - _MATCHED) * part / count for part in (number, number + 1))
        own = monitor.piece(begin, end, {"Pose": 1})
        with own.stage("Pose"):
            places = wanted[found.others.bodies[there].vertices]
            shapes[here] = _posed(found.surfaces[here], found.other_surfaces[there], places, each, own)
    posed = shaped(found.bodies, shapes, monitor)
    features = gathered_features(found.bodies, [each.found.prolonged(monitor) for each in found.surfaces])
    distortion = median_distortion(found.bodies.vertices, posed, found.bodies.faces)
    names = [
        limb_names(each.limbs, np.sign(one.facing) * each.limbs.side)  # toes tell, too
        for each, one in zip(features.bodies, found.surfaces, strict=True)
    ]
    return PosedLike(
        posed,
        found.bodies.faces,
        features.points,
        features.patches,
        features.adf,
        found.match,
        distortion,
        monitor.timings,
        monitor.warnings,
        feature_names=features.numbered(names),
    )


def _wanted(pose: ArrayLike, vertices: ArrayLike) -> FloatArray:
    """Check the positions of the reference."""
    pose = np.asarray(pose, dtype=np.float64)
    count = len(np.asarray(vertices))
    if pose.shape != (count, 3) or not np.isfinite(pose).all():
        raise InvalidMeshError("match_pose", count=count)
    return pose


def _posed(one: Unfolded, other: Unfolded, pose: FloatArray, found: PointMap, monitor: Monitor) -> FloatArray:
    """Transfer the pose of another body to a body, around its own centre, in its own unit."""
    own, there = one.found, other.found
    surface = own.surface
    struts = struts_through(surface.points, surface.faces, own.limbs.to_features, monitor)
    body = ElasticBody(own.stiffness, own.mass, surface.points, surface.faces, struts)
    kept = surface.kept
    corners = pose[there.whole_faces[found.points.faces[kept]]]  # (c, 3, 3)
    places = np.einsum("ij,ijk->ik", found.points.weights[kept], corners)
    confidence = found.confidence[kept]
    posed = taken_pose(body, places, confidence)
    planes = mirror_planes(pose, there.whole_faces, monitor)
    mirror = _mirror(one, body, monitor) if planes else None
    if mirror is not None:
        posed = symmetric_pose(body, posed, confidence, mirror, planes)
    monitor.check()
    if surface.coarse:
        rotation, shift = surface.prolong_frames(*body.frames(posed))
        posed = moved_by_frames(own.whole_points, rotation, shift)
    posed = untangled(own.whole_points, posed, own.whole_faces, monitor)
    areas = vertex_areas(own.whole_points, own.whole_faces)
    centred = posed + areas / areas.sum() @ (own.whole_points - posed)
    return centred * own.unit + own.centre


def _mirror(one: Unfolded, body: ElasticBody, monitor: Monitor) -> MirrorMap | None:
    """Find left and right on a body."""
    samples = np.arange(0, len(one.form), _SAMPLED)
    return mirror_partners(body, one.form, one.found.spectrum.eigenvectors, one.limbs, samples, monitor)
