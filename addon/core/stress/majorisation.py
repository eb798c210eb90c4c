"""The one minimiser: majorisation of a stress of pairs, with V factored once and with momentum."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ..numerics.arrays import FloatArray
from ..numerics.factoring import factored
from ..run.monitor import Monitor
from .pairs import Term

Solve = Callable[[FloatArray], FloatArray]
_HARDLY = 1e-9  # of the mean diagonal of V: an anchor at the points themselves, which only makes V regular


class Majorisation:
    """The stress ``Σ w |d - t(X)|² + Σ_i a_i |x_i - y_i|²``, and the steps that lower it.

    A step solves ``(V + A) X' = Σ w t(X) + A y``. Where pairs want a length in their own direction this is SMACOF;
    where they want their vector in the input, turned with its surroundings, it is as rigid as possible.

    `terms`: pairs and what they want; `anchor` (n,); `target` (n, d); `solve`: solves for ``V + A``, if that is
    factored already.

    Examples
    --------
    >>> from addon.core.stress.pairs import Pairs
    >>> pairs = Pairs(np.array([[0, 1], [1, 2], [0, 2]]), np.ones(3), 3).wanting_lengths(np.array([3.0, 5.0, 4.0]))
    >>> points, history = Majorisation([pairs]).lowered(np.array([[0.0, 0], [1, 0], [0, 1]]), 100, tolerance=1e-12)
    >>> round(float(np.linalg.norm(points[1] - points[2])), 6), history[-1] < 1e-12
    (5.0, True)

    References
    ----------
    De Leeuw, "Applications of convex analysis to multidimensional scaling", 1977. Momentum and its restart: O'Donoghue
    and Candès, "Adaptive restart for accelerated gradient schemes", 2015, doi:10.1007/s10208-013-9150-3.
    """

    def __init__(
        self,
        terms: Sequence[Term],
        anchor: FloatArray | None = None,
        target: FloatArray | None = None,
        solve: Solve | None = None,
    ) -> None:
        self._terms, self._target = terms, target
        if solve is None:
            V = sum(each.laplacian() for each in terms)
            anchor = np.full(V.shape[0], _HARDLY * V.diagonal().mean()) if anchor is None else anchor
            solve = anchored_solver(V, anchor)
        self._solve, self._anchor = solve, np.zeros(1) if anchor is None else anchor

    def lowered(
        self,
        start: FloatArray,
        steps: int,
        *,
        tolerance: float | None = None,
        momentum: bool = True,
        after: Callable[[FloatArray, Solve], FloatArray] | None = None,
        monitor: Monitor | None = None,
    ) -> tuple[FloatArray, FloatArray]:
        """Take so many steps, or fewer if the stress then hardly falls.

        `start` (n, d); `steps`: number of steps at most; `tolerance`: stop when a step lowers the stress by less than
        this fraction; `momentum`: whether steps gain momentum (Nesterov); without, they are those of SMACOF; `after`:
        changes the points after each step; it gets them and the solver; gives points (n, d), history (s + 1,).
        """
        monitor = monitor or Monitor()
        points, ahead, gained = start, start, 0
        value = self._stress(start) if tolerance is not None else np.nan
        history = [] if tolerance is None else [value]
        for number in range(steps):
            new = self._solve(self._pull(ahead))
            new = new if after is None else after(new, self._solve)
            monitor.tick((number + 1) / steps)
            if tolerance is not None:
                lower = self._stress(new)
                if lower > value and gained:  # momentum carried too far: again from here, without
                    ahead, gained = points, 0
                    continue
                if lower > value:  # rounding is all that is left
                    break
                history.append(lower)
                fallen, value = value - lower, lower
            gained = gained + 1 if momentum and np.vdot(ahead - new, new - points) <= 0 else 0
            ahead, points = new + gained / (gained + 3) * (new - points), new
            if tolerance is not None and fallen < tolerance * history[-2]:
                break
        return points, np.array(history)

    def _pull(self, points: FloatArray) -> FloatArray:
        """Sum what the pairs and the anchor want at each point: ``Σ w t + A y``."""
        target = points if self._target is None else self._target
        return sum((each.pull(points) for each in self._terms), self._anchor[:, None] * target)

    def _stress(self, points: FloatArray) -> float:
        """Sum the stress of the pairs and of the anchor."""
        held = 0.0 if self._target is None else float((self._anchor[:, None] * (points - self._target) ** 2).sum())
        return sum(each.stress(points) for each in self._terms) + held


def anchored_solver(laplacian: object, anchor: FloatArray) -> Solve:
    """Factor ``V + A``."""
    from scipy.sparse import diags

    return factored(laplacian + diags(anchor)).solve
