"""The result that every method returns."""

from __future__ import annotations

from typing import NamedTuple

from ..numerics.arrays import FloatArray, IntArray
from ..run.monitor import Monitor
from .settings import Settings


class MethodResult(NamedTuple):
    """A form before it is scaled and aligned to its input.

    Attributes
    ----------
    points : (n, 3) ndarray of float
        All vertices, at any scale and position, not mirrored.
    history : (s + 1,) ndarray of float
        The objective before each of the s steps and after the last; one value for a method without steps.
    pair_count : int
        Entries of the distance matrices that the method uses.
    asymmetry : float
        Deviation of the form from its mirror image, in units of sqrt(area); nan where no left and right was found.
    partner : (c,) ndarray of int or None
        The mirror partner of each working vertex, if the method found them.
    """

    points: FloatArray
    history: FloatArray
    pair_count: int
    asymmetry: float = float("nan")
    partner: IntArray | None = None


def warn_if_still_falling(history: FloatArray, settings: Settings, monitor: Monitor) -> None:
    """Warn if the minimisation ran out of steps before it met the tolerance, if one is set.

    Parameters
    ----------
    history : (s + 1,) ndarray of float
        Stress before each step and after the last.
    settings : Settings
        Number of steps and tolerance.
    monitor : Monitor
        Receives the warning.

    Examples
    --------
    >>> import numpy as np
    >>> monitor = Monitor()
    >>> warn_if_still_falling(np.array([3.0, 2.0, 1.0]), Settings(max_iterations=2), monitor)
    >>> monitor.warnings[0].kind
    'still_falling'
    """
    steps = len(history) - 1
    if settings.tolerance == 0 or not 0 < steps == settings.max_iterations:
        return
    if history[-2] - history[-1] >= settings.tolerance * history[-2]:
        monitor.warn("still_falling", steps=steps)
