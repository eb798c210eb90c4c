"""A form moved onto another as rigidly as possible: the map between them keeps lengths, and slides no more."""

from __future__ import annotations

import numpy as np

from ..deformation.elastic_body import ElasticBody
from ..mesh.closest_points import SurfacePoints, closest_points
from ..mesh.geometry import vertex_normals
from ..numerics.arrays import FloatArray
from ..run.monitor import Monitor
from .unfolded import Unfolded

_PULL, _STEPS = 1000.0, 8  # strength of the pull towards the matched points, in 1/area; alternations a round
_ROUNDS = 4  # closest points found anew
_FACING = 0.015  # weight of normals in the search for the closest points


def elastic_fit(
    body: ElasticBody, one: Unfolded, other: Unfolded, points: SurfacePoints, monitor: Monitor
) -> tuple[FloatArray, SurfacePoints]:
    """Move a form onto another as rigidly as possible, from a map between them.

    A map between a few eigenfunctions leaves waists and hips free to slide by some hundredths of sqrt(area). Here the
    vertices are pulled to the matched points while the form keeps its shape; then the closest points are the new match.

    `body`: the form of the first surface; `one, other`: the surfaces; `points`: the point on the other surface for
    each vertex; gives placed (c, 3), points.

    References
    ----------
    Sorkine and Alexa, "As-Rigid-As-Possible Surface Modeling", 2007, doi:10.2312/SGP/SGP07/109-116; Amberg, Romdhani
    and Vetter, "Optimal Step Nonrigid ICP Algorithms for Surface Registration", 2007, doi:10.1109/CVPR.2007.383165.
    """
    others = with_normals(other.form, other.normals)
    own = Monitor(cancelled=monitor.is_cancelled)
    for _ in range(_ROUNDS):
        target = points.on(other.form, other.faces)
        placed = body.towards(target, _PULL, _STEPS, monitor=own)
        wanted = with_normals(placed, vertex_normals(placed, one.faces))
        points = closest_points(others, other.faces, wanted, monitor)
    return placed, points


def with_normals(points: FloatArray, normals: FloatArray) -> FloatArray:
    """Extend positions by normals, so that the closest point of a form is one that faces the same way.

    `points` (n, 3); `normals` (n, 3); gives (n, 6).

    Examples
    --------
    >>> with_normals(np.zeros((1, 3)), np.array([[0.0, 0, 1]])).tolist()
    [[0.0, 0.0, 0.0, 0.0, 0.0, 0.015]]
    """
    return np.column_stack([points, _FACING * normals])
