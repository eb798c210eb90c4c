"""The rivals by name."""

from __future__ import annotations

from collections.abc import Callable

from ..methods.classical import classical_form
from ..methods.euclidean import euclidean_normalised_form, euclidean_random_form
from ..methods.fast import fast_form
from ..methods.least_squares import least_squares_form
from ..methods.non_metric import non_metric_form
from ..methods.one_form import one_form_form
from ..methods.skeleton import skeleton_form
from ..run.monitor import Monitor
from .embedding import Embedding
from .recognition import Recognition
from .samples import WholeSurface
from .settings import Settings

RIVALS: dict[str, Callable[[WholeSurface, Settings, Monitor], Embedding]] = {
    "classical": classical_form,
    "least_squares": least_squares_form,
    "non_metric": non_metric_form,
    "fast": fast_form,
    "euclidean_random": euclidean_random_form,
    "euclidean_normalised": euclidean_normalised_form,
    "one_form": one_form_form,
    "skeleton": skeleton_form,
}


def rival_form(found: Recognition, settings: Settings, monitor: Monitor) -> Embedding:
    """Unfold a surface by the rival that the settings name.

    Parameters
    ----------
    found : Recognition
        The mesh and its feature points.
    settings : Settings
        Options; `method` is a name in `RIVALS`.
    monitor : Monitor
        Told the progress and asked whether to stop.

    Returns
    -------
    Embedding
        The form, not yet aligned to the input.

    Raises
    ------
    TooLargeError
        If all pairs do not fit into the memory limit.
    CancelledError
        If the monitor says so.
    """
    return RIVALS[settings.method](WholeSurface(found, settings, monitor), settings, monitor)
