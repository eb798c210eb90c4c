"""A pose that is its own mirror image is taken over as one: both sides turn alike."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..deformation.elastic_body import ElasticBody
from ..deformation.rotations import nearest_rotations
from ..mesh.closest_points import closest_points
from ..mesh.geometry import surface_area, vertex_areas
from ..numerics.arrays import FloatArray, IntArray
from ..run.monitor import Monitor
from ..symmetry.mirror import MirrorMap, Plane

_SAMPLES = 1000  # vertices whose mirror images are looked for on the surface
_EXACT, _MOST = 0.002, 0.95  # sqrt(area): distance of an image up to which it lies on the surface, and how many must
_FAR = 0.1  # sqrt(area): mean distance of a body from its mirror image above which the plane is not that of the pose
_TURNS = 2e-3  # diffusion time over which rotations are averaged, as a share of the area
_SMOOTHING = 3e-3  # over which the distances of both sides are, for partners are vertices and not points between them
_PULL, _HARDLY = 1000.0, 1e-3  # 1/area, towards the mean of both sides, and the share of it that is left where these
_ALIKE = 0.03  # sqrt(area), are farther apart than this


def mirror_planes(points: FloatArray, faces: IntArray, monitor: Monitor) -> list[Plane]:
    """Find the planes in which a mesh is exactly its own mirror image, as a modelled character in a T-pose is.

    `points` (n, 3); `faces` (m, 3).

    Examples
    --------
    >>> from addon.core.modelling.mannequins import mannequin
    >>> planes = mirror_planes(*mannequin(), Monitor())
    >>> [np.abs(plane.normal).round(3).tolist() for plane in planes]
    [[1.0, 0.0, 0.0]]
    """
    share = vertex_areas(points, faces)
    share = share / share.sum()
    centre = share @ points
    axes = np.linalg.eigh((share[:, None] * (points - centre)).T @ (points - centre))[1].T
    some = points[:: max(1, len(points) // _SAMPLES)]
    near = _EXACT * np.sqrt(surface_area(points, faces))
    planes = [Plane(axis, centre) for axis in axes]
    images = np.concatenate([plane.mirrored(some) for plane in planes])
    on_it = closest_points(points, faces, images, monitor).distances <= near
    return [plane for plane, each in zip(planes, np.split(on_it, len(planes)), strict=True) if each.mean() >= _MOST]


def symmetric_pose(
    body: ElasticBody, posed: FloatArray, confidence: FloatArray, mirror: MirrorMap, planes: Sequence[Plane]
) -> FloatArray:
    """Turn mirror partners as mirror images of each other, those of high confidence less than others.

    Rotations are averaged and the body is reassembled; only where both sides are near each other is it also pulled to
    their mean. So a head that the match turned aside looks ahead and keeps its shape.

    `body`: the body, in its own pose; `posed` (n, 3); `confidence` (n,); `mirror`: the mirror symmetry of the body;
    `planes`: mirror planes of the pose; gives (n, 3).
    """
    middle = body.mass @ posed / body.mass.sum()
    images = [Plane(plane.normal, middle).mirrored(posed[mirror.partner]) for plane in planes]
    apart = [float(np.linalg.norm(image - posed, axis=1).mean()) for image in images]
    if not apart or min(apart) > _FAR * np.sqrt(body.mass.sum()):
        return posed
    image = images[int(np.argmin(apart))]
    share = mirror.sure * confidence[mirror.partner]
    share /= np.maximum(confidence + confidence[mirror.partner], np.finfo(float).tiny)
    own, other = (body.rotations(shape, _TURNS) for shape in (posed, image))
    between = nearest_rotations((1 - share)[:, None, None] * own + share[:, None, None] * other)
    way = body.smoothed(body.mass[:, None] * (image - posed), _SMOOTHING)
    alike = np.exp(-((np.linalg.norm(way, axis=1) / (_ALIKE * np.sqrt(body.mass.sum()))) ** 2))
    return body.turned_towards(between, posed + share[:, None] * way, _PULL * np.maximum(alike, _HARDLY))
