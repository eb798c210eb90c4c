"""The result that every method returns."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..mesh.geometry import surface_area
from ..numerics.arrays import FloatArray, IntArray
from ..run.monitor import Monitor


class MethodResult(NamedTuple):
    """A form before it is aligned to its input.

    Attributes
    ----------
    points : (n, 3) ndarray of float
        All vertices, in any position, not mirrored; the input has unit area.
    history : (s + 1,) ndarray of float
        The stress before each of the s steps and after the last; empty if the form is not the minimum of one stress.
    pair_count : int
        Entries of the distance matrices that the method uses.
    asymmetry : float
        Deviation of the form from its mirror image, in units of sqrt(area); nan where no left and right was found.
    partner : (c,) ndarray of int or None
        The mirror partner of each working vertex, if the method found them.
    """

    points: FloatArray
    history: FloatArray = np.empty(0)
    pair_count: int = 0
    asymmetry: float = float("nan")
    partner: IntArray | None = None

    def of_unit_area(self, faces: IntArray) -> MethodResult:
        """Scale the form to the area of its input. `faces` (m, 3)."""
        return self._replace(points=self.points / np.sqrt(surface_area(self.points, faces)))


def warn_if_still_falling(history: FloatArray, tolerance: float, most: int, monitor: Monitor) -> None:
    """Warn if the minimisation ran out of its most steps before one lowered the stress by less than the tolerance.

    Examples
    --------
    >>> monitor = Monitor()
    >>> warn_if_still_falling(np.array([3.0, 2.0, 1.0]), 1e-3, 2, monitor)
    >>> monitor.warnings[0].kind
    'still_falling'
    """
    steps = len(history) - 1
    if 0 < steps == most and history[-2] - history[-1] >= tolerance * history[-2]:
        monitor.warn("still_falling", steps=steps)
