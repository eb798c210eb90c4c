"""As-rigid-as-possible deformation of the input towards an embedding, which turns no limb inside out."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .laplacian import factored, mass, stiffness
from .monitor import Monitor
from .surface import FloatArray, Triangulation

if TYPE_CHECKING:
    from scipy.sparse import coo_matrix

_SPREAD = 0.01  # diffusion time of the first rotations, as a share of the area: wide enough to see a limb as a body


def diffused_covariances(surface: Triangulation, before: FloatArray, after: FloatArray) -> FloatArray:
    """Compare the surroundings of every vertex before and after, over an area as wide as a limb.

    Parameters
    ----------
    surface : Triangulation
        The surface, Delaunay.
    before, after : (n, 3) ndarray of float
        Positions of the vertices.

    Returns
    -------
    (n, 3, 3) ndarray of float
        Covariances of edge vectors, those before by row and those after by column, smoothed by the heat flow.
    """
    from scipy.sparse import diags

    L, M = stiffness(surface), mass(surface)
    local = _covariances(_edge_weights(L), before, after).reshape(-1, 9)
    return factored(diags(M) + _SPREAD * M.sum() * L).solve(local).reshape(-1, 3, 3)


def deformed_towards(
    surface: Triangulation,
    before: FloatArray,
    target: FloatArray,
    pull: float,
    steps: int,
    monitor: Monitor | None = None,
) -> FloatArray:
    """Deform a mesh as rigidly as possible while its vertices are pulled to given places.

    Parameters
    ----------
    surface : Triangulation
        The surface, Delaunay, so that no weight is negative.
    before : (n, 3) ndarray of float
        Positions of the undeformed vertices.
    target : (n, 3) ndarray of float
        Where the vertices are pulled to.
    pull : float
        Strength of the pull, in 1/area.
    steps : int
        Number of alternations between rotations and positions.
    monitor : Monitor, optional
        Told the progress and asked whether to stop.

    Returns
    -------
    (n, 3) ndarray of float
        The deformed vertices.

    Raises
    ------
    CancelledError
        If the monitor says so.

    References
    ----------
    Sorkine and Alexa, "As-Rigid-As-Possible Surface Modeling", 2007. The first rotations come from covariances
    diffused over the surface, so that a limb that the target squashes or turns inside out comes out right.
    """
    from scipy.sparse import diags

    monitor = monitor or Monitor()
    L, M = stiffness(surface), mass(surface)
    weights = _edge_weights(L)
    solve = factored(L + pull * diags(M)).solve
    rotation = _rotations(diffused_covariances(surface, before, target))
    positions = target
    for step in range(steps):
        positions = solve(_rotated_edges(weights, before, rotation) + pull * M[:, None] * target)
        monitor.tick((step + 1) / steps)
        if step + 1 < steps:
            rotation = _rotations(_covariances(weights, before, positions))
    return positions


def _edge_weights(stiffness_matrix: object) -> coo_matrix:
    from scipy.sparse import triu

    upper = triu(stiffness_matrix, 1).tocoo()
    upper.data = -upper.data
    return upper


def _gathered(weights: coo_matrix, at_row: FloatArray, at_column: FloatArray) -> FloatArray:
    """Sum what every edge gives to its two ends."""
    n, e = weights.shape[0], weights.nnz
    from scipy.sparse import csr_matrix

    ends = csr_matrix(
        (np.ones(2 * e), np.concatenate([weights.row, weights.col]), np.arange(2 * e + 1)), shape=(2 * e, n)
    )
    return ends.T @ np.concatenate([at_row, at_column])


def _covariances(weights: coo_matrix, before: FloatArray, after: FloatArray) -> FloatArray:
    i, j = weights.row, weights.col
    outer = (weights.data[:, None] * (before[i] - before[j]))[:, :, None] * (after[i] - after[j])[:, None, :]
    outer = outer.reshape(-1, 9)
    return _gathered(weights, outer, outer).reshape(-1, 3, 3)


def _rotated_edges(weights: coo_matrix, before: FloatArray, rotation: FloatArray) -> FloatArray:
    i, j = weights.row, weights.col
    edge = (weights.data / 2)[:, None] * (before[i] - before[j])
    turned = np.einsum("ij,ijk->ik", edge, rotation[i] + rotation[j])
    return _gathered(weights, turned, -turned)


def _rotations(covariances: FloatArray) -> FloatArray:
    """Find the proper rotation nearest to each covariance; it is applied from the right, ``x ↦ x R``."""
    left, _, right = np.linalg.svd(covariances)
    left[:, :, -1] *= np.sign(np.linalg.det(left @ right))[:, None]
    return left @ right
