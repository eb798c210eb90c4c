"""Progress, cancellation, warnings and timing of one computation."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from itertools import accumulate, pairwise
from time import perf_counter
from typing import Any, TypeVar

from .errors import CancelledError
from .kept_stages import KeptStages
from .messages import Message, message

Progress = Callable[[float, str], object]
Cancelled = Callable[[], bool]
Warned = Callable[[str], object]
Found = TypeVar("Found")
Plan = Mapping[str, float]  # stages in their order, with weights: the share of the time that each takes


class Monitor:
    """Reports the progress of a computation and stops it on request.

    `plan`: the stages to come, in order, with weights; `keep`: results of earlier runs; if omitted, nothing is kept.

    Attributes
    ----------
    timings : dict of str to float
        Seconds spent in each stage, in the order of the stages.
    warnings : list of Message
        Sentences for the user, in the order in which they occurred.

    Examples
    --------
    >>> monitor = Monitor(lambda done, stage: print(f"{done:.0%} {stage}"), plan={"Spectrum": 3, "Embedding": 1})
    >>> with monitor.stage("Spectrum"):
    ...     monitor.tick(0.5)
    0% Spectrum
    38% Spectrum
    75% Spectrum
    """

    def __init__(
        self,
        progress: Progress | None = None,
        cancelled: Cancelled | None = None,
        plan: Plan | None = None,
        keep: KeptStages | None = None,
    ) -> None:
        self._progress, self._cancelled, self._keep = progress, cancelled, keep
        plan = plan or {}
        ends = [end / (sum(plan.values()) or 1.0) for end in accumulate(plan.values(), initial=0.0)]
        self._spans = dict(zip(plan, pairwise(ends), strict=True))
        self._name, self._span, self._done = "", (0.0, 1.0), 0.0
        self._pieces = 0  # handed out so far
        self.timings: dict[str, float] = {}
        self.warnings: list[Message] = []

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Time a stage and report its progress. `name`: name of the stage, shown to the user."""
        around = self._name, self._span
        self._name, self._span = name, self._spans.get(name, self._span)
        began = perf_counter()
        self.tick(0.0)
        try:
            yield
            self.tick(1.0)
        finally:
            self.timings[name] = self.timings.get(name, 0.0) + perf_counter() - began
            self._name, self._span = around

    def piece(self, begin: float, end: float, plan: Plan, keep: KeptStages | None = None) -> Monitor:
        """Make a monitor for one piece of the work that remains after the stages so far.

        `begin, end`: fractions of the remaining work that are done before and after the piece, 0 to 1; `plan`: the
        stages of the piece; `keep`: results of earlier runs on it, where they are not a part of those of the whole.
        """
        first = max((stop for name, (_, stop) in self._spans.items() if name in self.timings), default=0.0)

        def report(done: float, stage: str) -> None:
            self.report(first + (1 - first) * (begin + (end - begin) * done), stage)

        if keep is None and self._keep is not None:
            keep = self._keep.part(self._pieces)
        own = Monitor(report, self._cancelled, plan, keep)
        self._pieces += 1
        own.timings = self.timings
        return own

    @property
    def keeps(self) -> bool:
        """Whether results are kept for other runs."""
        return self._keep is not None

    def kept(self, name: str, sources: list[Any], compute: Callable[[], Found]) -> Found:
        """Return the result of an earlier run, if its sources are the same, or compute it.

        `name`: name of the result; `sources`: all that it depends on, as in `KeptStages.take`; `compute`: computes
        it.
        """
        return compute() if self._keep is None else self._keep.take(name, sources, compute, self.warnings)

    def tick(self, fraction: float) -> None:
        """Report the fraction of the current stage that is done; stop if the run is cancelled.

        `fraction`: fraction of the current stage that is done, 0 to 1.
        """
        self.check()
        start, stop = self._span
        self._report(start + (stop - start) * fraction)

    def check(self) -> None:
        """Stop if the run is cancelled."""
        if self.is_cancelled():
            raise CancelledError()

    def is_cancelled(self) -> bool:
        """Check whether the run is cancelled."""
        return self._cancelled is not None and self._cancelled()

    def warn(self, kind: str, **numbers: Any) -> None:
        """Add a warning to the result, unless it is already there.

        `kind`: kind of the message; see `messages`; `**numbers`: values of the placeholders of its sentence.
        """
        self.extend([message(kind, **numbers)])

    def extend(self, found: list[Message]) -> None:
        """Add those warnings to the result that are not already there. `found`: the warnings."""
        self.warnings += [each for each in found if each not in self.warnings]

    def deliver(self, warned: Warned | None) -> None:
        """Deliver the warnings to the caller if the result cannot hold them.

        `warned`: called with each sentence; if omitted, Python warnings are issued.
        """
        for sentence in self.warnings:
            if warned is None:
                warnings.warn(str(sentence), stacklevel=3)
            else:
                warned(sentence)

    def report(self, done: float, stage: str) -> None:
        """Report how much is done of all, as a part of the work does. `stage`: what it is at."""
        self._name = stage or self._name
        self._report(done)

    def _report(self, done: float) -> None:
        self._done = max(self._done, done)
        if self._progress is not None:
            self._progress(self._done, self._name)
