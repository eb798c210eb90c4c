"""Progress, cancellation and timing of one computation."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter

from .errors import CancelledError

Progress = Callable[[float, str], object]
Cancelled = Callable[[], bool]
Warned = Callable[[str], object]


class Monitor:
    """Tells the caller how far a computation is and stops it when the caller wishes.

    Parameters
    ----------
    progress : callable, optional
        Called with the fraction done, 0 to 1 and never falling, and the name of the stage.
    cancelled : callable, optional
        Returns True when the computation should stop.

    Attributes
    ----------
    timings : dict of str to float
        Seconds spent in each stage, in the order of the stages.
    warnings : list of str
        Sentences for the user, in the order in which they came up.
    """

    def __init__(self, progress: Progress | None = None, cancelled: Cancelled | None = None) -> None:
        self._progress = progress
        self._cancelled = cancelled
        self._name = ""
        self._start = self._stop = self._piece = 0.0
        self.timings: dict[str, float] = {}
        self.warnings: list[str] = []

    @contextmanager
    def stage(self, name: str, until: float) -> Iterator[None]:
        """Time a stage that takes the whole job to the fraction `until`.

        Parameters
        ----------
        name : str
            Name of the stage, shown to the user.
        until : float
            Fraction of the job done when the stage ends.

        Yields
        ------
        None
            Control, while the stage runs.
        """
        self._name, self._start, self._stop = name, self._stop, until
        began = perf_counter()
        self.tick(0.0)
        try:
            yield
        finally:
            self.timings[name] = self.timings.get(name, 0.0) + perf_counter() - began
        self.tick(1.0)

    def until(self, fraction: float, reach: float = 1.0) -> Monitor:
        """Make a monitor for a piece of the work that is left after the stages so far, and go on behind it.

        Parameters
        ----------
        fraction : float
            Part of the work left that is done when the piece ends, 0 to 1; pieces are asked for in order.
        reach : float
            How far the stages of the piece go, at most 1.

        Returns
        -------
        Monitor
            Of the piece: its stages go from 0 to `reach`. It has warnings of its own and shares the timings.
        """
        begun, self._piece = self._stop + (1 - self._stop) * self._piece, fraction
        ended = self._stop + (1 - self._stop) * fraction
        progress = self._progress

        def told(done: float, stage: str) -> None:
            if progress is not None:
                progress(begun + (ended - begun) * min(done / reach, 1.0), stage)

        own = Monitor(told, self._cancelled)
        own.timings = self.timings
        return own

    def tick(self, fraction: float) -> None:
        """Report the fraction of the present stage that is done; stop if the caller has cancelled.

        Parameters
        ----------
        fraction : float
            Part of the present stage that is done, 0 to 1.

        Raises
        ------
        CancelledError
            If the caller has cancelled.
        """
        self.check()
        if self._progress is not None:
            self._progress(self._start + (self._stop - self._start) * fraction, self._name)

    def check(self) -> None:
        """Stop if the caller has cancelled.

        Raises
        ------
        CancelledError
            If the caller has cancelled.
        """
        if self._cancelled is not None and self._cancelled():
            raise CancelledError()

    def warn(self, sentence: str) -> None:
        """Keep a warning for the result, unless it is there already.

        Parameters
        ----------
        sentence : str
            What happened and what it means for the user.
        """
        if sentence not in self.warnings:
            self.warnings.append(sentence)

    def hand_over(self, warned: Warned | None) -> None:
        """Tell the warnings where the result has no place for them.

        Parameters
        ----------
        warned : callable, optional
            Called with each sentence; without it they become Python's own warnings.
        """
        for sentence in self.warnings:
            if warned is None:
                warnings.warn(sentence, stacklevel=3)
            else:
                warned(sentence)
