"""Least-squares scaling, then edge vectors reassembled: the surface's 1-form is kept.

The entry of Cheng, Nie and Jin in Pickup and others, "Canonical forms for non-rigid 3D shape retrieval", SHREC'15.
"""

from __future__ import annotations

import numpy as np

from ..deformation.rotations import nearest_rotations
from ..method_api.catalogue import Method
from ..method_api.method_result import MethodResult
from ..method_api.settings import Settings
from ..method_api.surface_features import SurfaceFeatures
from ..method_api.whole_surface import WholeSurface
from ..numerics.arrays import FloatArray, IntArray
from ..numerics.factoring import factored
from ..run.monitor import Monitor
from ..surface.laplacian import stiffness
from ..surface.triangulation import corner_cotangents, corner_lengths, mollified, triangulated
from .least_squares import fitted


def with_one_form_kept(points: FloatArray, triangles: IntArray, layout: FloatArray) -> FloatArray:
    """Rotate the edge vectors of each triangle as in a layout, and find the vertices that fit them best.

    The coordinates' differences along the edges are three discrete 1-forms. Rotated triangle by triangle they are no
    longer exact; the exact part of their Hodge decomposition, one Poisson problem, gives the vertices.

    `points` (n, 3); `triangles` (m, 3); `layout` (n, 3); gives (n, 3).
    """
    from scipy.sparse import eye

    count = len(points)
    cotangents = corner_cotangents(mollified(corner_lengths(points, triangles))) / 2  # (m, 3), of the corners
    tail, head = np.roll(triangles, -1, axis=1), np.roll(triangles, -2, axis=1)  # the edge opposite to each corner
    before, after = points[head] - points[tail], layout[head] - layout[tail]  # (m, 3, 3): triangle, edge, axis
    covariance = np.einsum("me,mei,mej->mij", np.abs(cotangents), before, after)
    turned = cotangents[:, :, None] * (before @ nearest_rotations(covariance))
    divergence = np.zeros((count, 3))
    for axis in range(3):
        flow = turned[:, :, axis].ravel()
        divergence[:, axis] = np.bincount(head.ravel(), flow, count) - np.bincount(tail.ravel(), flow, count)
    L = stiffness(triangulated(points, triangles))
    form = factored(L + 1e-12 * L.diagonal().mean() * eye(count)).solve(divergence)
    return np.asarray(form - form.mean(axis=0))


def _form(found: SurfaceFeatures, settings: Settings, monitor: Monitor) -> MethodResult:
    """Unfold a surface by least-squares scaling and restore its edge vectors, rotated."""
    whole = WholeSurface(found, settings, monitor)
    with monitor.stage("Distances"):
        samples = whole.samples()
    with monitor.stage("Embedding"):
        layout, history = fitted(samples, settings, monitor)
        layout = whole.outside_out(layout)
    with monitor.stage("Detail"):
        form = with_one_form_kept(whole.points, whole.faces, layout)
        return whole.embedding(form, history, samples.distances.size)


METHODS = (
    Method(
        name="one_form",
        label="1-Form MDS",
        help="Least-squares MDS, then edge vectors reassembled by a Poisson problem (SHREC'15)",
        source="Cheng, Nie and Jin in SHREC'15",
        unfold=_form,
        stages={"Distances": 25, "Embedding": 29, "Detail": 5},
        uses=("landmark_count", "max_iterations"),
        pairs="all",
        rank=7,
    ),
)
