"""1-form scaling: the edge vectors of the mesh, turned as a least-squares embedding says, are put together again."""

from __future__ import annotations

import numpy as np

from ..deformation.rotations import nearest_rotations
from ..numerics.arrays import FloatArray, IntArray
from ..numerics.factoring import factored
from ..run.monitor import Monitor
from ..surface.laplacian import stiffness
from ..surface.triangulation import corner_cotangents, corner_lengths, mollified, triangulated
from ..unfolding.embedding import Embedding
from ..unfolding.samples import WholeSurface
from ..unfolding.settings import Settings
from .least_squares import fitted


def with_one_form_kept(points: FloatArray, triangles: IntArray, layout: FloatArray) -> FloatArray:
    """Turn the edge vectors of each triangle as a layout turns it, and find the vertices that come closest to them.

    The coordinates' differences along the edges are three discrete 1-forms. Turned triangle by triangle they are no
    longer differences of anything; the exact part of their Hodge decomposition, one Poisson problem, is.

    Parameters
    ----------
    points : (n, 3) ndarray of float
        Vertices.
    triangles : (m, 3) ndarray of int
        Triangles.
    layout : (n, 3) ndarray of float
        Where an embedding has the vertices.

    Returns
    -------
    (n, 3) ndarray of float
        The vertices, centred.
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


def one_form_form(whole: WholeSurface, settings: Settings, monitor: Monitor) -> Embedding:
    """Unfold a surface by least-squares scaling and give it back its edge vectors, turned.

    Parameters
    ----------
    whole : WholeSurface
        The mesh.
    settings : Settings
        As in `least_squares_form`.
    monitor : Monitor
        Told the progress and asked whether to stop.

    Returns
    -------
    Embedding
        The form.

    Raises
    ------
    TooLargeError
        If all pairs do not fit into the memory limit.
    CancelledError
        If the monitor says so.

    References
    ----------
    The entry of Cheng, Nie and Jin in Pickup et al., "Canonical forms for non-rigid 3D shape retrieval", SHREC'15.
    """
    with monitor.stage("Distances", 0.6):
        samples = whole.samples()
    with monitor.stage("Embedding", 0.9):
        layout, history = fitted(samples, settings, monitor)
        layout = whole.outside_out(layout)
    with monitor.stage("Detail", 0.95):
        form = with_one_form_kept(whole.points, whole.triangles, layout)
        return whole.embedding(form, history, samples.distances.size)
