"""Unbending without geodesics: some vertices push each other apart while edges keep their lengths (Pickup et al.)."""

from __future__ import annotations

import numpy as np

from ..embedding.pushing import Pushing
from ..run.monitor import Monitor
from ..unfolding.embedding import Embedding
from ..unfolding.samples import WholeSurface
from ..unfolding.settings import Settings

_PUSH = 1.0  # strength; edges are then stretched by 5 to 10 %


def _form(whole: WholeSurface, settings: Settings, monitor: Monitor, normalised: bool) -> Embedding:
    count = min(settings.landmarks, len(whole.points))
    samples = np.sort(np.random.default_rng(0).choice(len(whole.points), count, replace=False))
    with monitor.stage("Embedding", 0.95):
        pushing = Pushing(whole.points, whole.triangles, samples, _PUSH, normalised=normalised)
        form, history = pushing.lowered(whole.points, settings, monitor)
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
