"""Unbending without geodesics: some vertices push each other apart while edges keep their lengths (Pickup et al.)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..embedding import Embedding
from ..laplacian import factored
from ..monitor import Monitor
from ..settings import Settings
from ..smacof import minimise_stress
from ..surface import FloatArray, IntArray, vertex_pairs
from .samples import WholeSurface

_FAR = 10.0  # distance that every pair is asked for, in units of sqrt(area): more than any body can give
_PUSH = 0.005  # sum of the pushes on all samples, over the forces of all edges stretched by their length
_PATIENCE = 1e-3  # times the tolerance: most of this stress is what no body can give, and never falls
_LEAST = 1e-12  # distance below which a direction means nothing


class LinkStress:
    """The stress of a list of links: ``Σ w (t - d)²``.

    Parameters
    ----------
    links : (e, 2) ndarray of int
        Pairs of points.
    targets : (e,) ndarray of float
        Wanted lengths.
    weights : (e,) ndarray of float
        Weights.
    count : int
        Number n of points.
    """

    def __init__(self, links: IntArray, targets: FloatArray, weights: FloatArray, count: int) -> None:
        from scipy.sparse import csr_matrix

        self._i, self._j = links.T
        self._targets, self._weights = targets, weights
        ends, start = links.ravel(), 2 * np.arange(len(links) + 1)
        values = np.tile([1.0, -1.0], len(links))
        self._differences = csr_matrix((values, ends, start), shape=(len(links), count))
        self._to_ends = self._differences.T.tocsr()

    def value_and_pull(self, points: FloatArray) -> tuple[float, FloatArray]:
        """Compute the stress and ``(B(X) - V) X``, minus half its gradient.

        Parameters
        ----------
        points : (n, 3) ndarray of float
            X.

        Returns
        -------
        value : float
            The stress.
        pull : (n, 3) ndarray of float
            Minus half the gradient.
        """
        apart = points[self._i] - points[self._j]
        length = np.maximum(np.sqrt(np.einsum("ij,ij->i", apart, apart)), _LEAST)
        short = self._targets - length
        value = float(self._weights @ short**2)
        return value, np.asarray(self._to_ends @ ((self._weights * short / length)[:, None] * apart))

    def inverse(self) -> Callable[[FloatArray], FloatArray]:
        """Factor V.

        Returns
        -------
        callable
            V⁺, for right-hand sides whose sum is 0.
        """
        from scipy.sparse import diags, eye

        V = self._to_ends @ diags(self._weights) @ self._differences
        solve = factored(V + 1e-9 * V.diagonal().mean() * eye(V.shape[0])).solve
        return lambda pull: solve(np.ascontiguousarray(pull))


def pushed_apart(
    points: FloatArray, triangles: IntArray, samples: IntArray, normalised: bool, settings: Settings, monitor: Monitor
) -> tuple[FloatArray, FloatArray]:
    """Push some vertices apart while edge lengths are kept.

    One stress holds both: unit weights ask for the length of every edge, and small ones ask every pair of samples
    for a distance that no body reaches, which is a nearly constant push.

    Parameters
    ----------
    points : (n, 3) ndarray of float
        Vertices, of unit area.
    triangles : (m, 3) ndarray of int
        Triangles.
    samples : (s,) ndarray of int
        The vertices that are pushed.
    normalised : bool
        Push each pair by as much more as it lies nearer to each other in the input, so that near pairs, which a bent
        joint brings together, have as much say as far ones.
    settings : Settings
        Iterations, tolerance and extrapolation.
    monitor : Monitor
        Told the progress and asked whether to stop.

    Returns
    -------
    form : (n, 3) ndarray of float
        The vertices.
    history : (s + 1,) ndarray of float
        The stress; it never rises.

    Raises
    ------
    CancelledError
        If the monitor says so.
    """
    edges = vertex_pairs(triangles)
    lengths = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
    first, second = np.triu_indices(len(samples), 1)
    pairs = np.column_stack([samples[first], samples[second]])
    push = np.ones(len(pairs))
    if normalised:
        push /= np.maximum(np.linalg.norm(points[pairs[:, 0]] - points[pairs[:, 1]], axis=1), _LEAST)
    push *= _PUSH * lengths.sum() / (_FAR * push.sum())
    stress = LinkStress(
        np.concatenate([edges, pairs]),
        np.concatenate([lengths, np.full(len(pairs), _FAR)]),
        np.concatenate([np.ones(len(edges)), push]),
        len(points),
    )
    monitor.check()
    tolerance = _PATIENCE * settings.tolerance
    return minimise_stress(
        stress, stress.inverse(), points, settings.iterations, tolerance, settings.extrapolation, monitor
    )


def _form(whole: WholeSurface, settings: Settings, monitor: Monitor, normalised: bool) -> Embedding:
    count = min(settings.landmarks, len(whole.points))
    samples = np.sort(np.random.default_rng(0).choice(len(whole.points), count, replace=False))
    with monitor.stage("Embedding", 0.95):
        form, history = pushed_apart(whole.points, whole.triangles, samples, normalised, settings, monitor)
        return Embedding(form, history, count**2)


def euclidean_random_form(whole: WholeSurface, settings: Settings, monitor: Monitor) -> Embedding:
    """Unfold a surface by pushing random vertices apart, every pair alike.

    Parameters
    ----------
    whole : WholeSurface
        The mesh.
    settings : Settings
        Landmarks (the number of random vertices), iterations, tolerance and extrapolation.
    monitor : Monitor
        Told the progress and asked whether to stop.

    Returns
    -------
    Embedding
        The form.

    Raises
    ------
    CancelledError
        If the monitor says so.

    References
    ----------
    Pickup, Sun, Rosin and Martin, "Euclidean-distance-based canonical forms for non-rigid 3D shape retrieval", 2015.
    """
    return _form(whole, settings, monitor, normalised=False)


def euclidean_normalised_form(whole: WholeSurface, settings: Settings, monitor: Monitor) -> Embedding:
    """Unfold a surface by pushing random vertices apart, near pairs as much as far ones.

    Parameters
    ----------
    whole : WholeSurface
        The mesh.
    settings : Settings
        As in `euclidean_random_form`.
    monitor : Monitor
        Told the progress and asked whether to stop.

    Returns
    -------
    Embedding
        The form.

    Raises
    ------
    CancelledError
        If the monitor says so.

    References
    ----------
    As `euclidean_random_form`.
    """
    return _form(whole, settings, monitor, normalised=True)
