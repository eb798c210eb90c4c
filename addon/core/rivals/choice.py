"""The rivals by name."""

from __future__ import annotations

from collections.abc import Callable

from ..embedding import Embedding
from ..monitor import Monitor
from ..recognition import Recognition
from ..settings import Settings
from .classical import classical_form
from .euclidean import euclidean_normalised_form, euclidean_random_form
from .fast import fast_form
from .least_squares import least_squares_form
from .non_metric import non_metric_form
from .one_form import one_form_form
from .samples import WholeSurface
from .skeleton import skeleton_form

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
