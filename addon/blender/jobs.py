"""A computation in a thread of its own: it never touches Blender's data, and tells how far it is."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

from ..core import CancelledError
from ..core.run.monitor import Cancelled, Progress


class Job:
    """One computation under way.

    Parameters
    ----------
    work : callable
        Takes `progress` and `cancelled` as `canonical_form` does and returns a result; works on arrays only.

    Attributes
    ----------
    fraction : float
        Part that is done, 0 to 1.
    stage : str
        Name of the stage.
    shown_at : float
        When its progress was last shown, by `time.perf_counter`.
    """

    def __init__(self, work: Callable[[Progress, Cancelled], Any]) -> None:
        self.fraction, self.stage, self.shown_at = 0.0, "Starting", 0.0
        self._work = work
        self._stop = threading.Event()
        self._result: Any = None
        self._error: Exception | None = None
        # a daemon, so that quitting Blender does not wait for it
        self._thread = threading.Thread(target=self._run, name="Canonical Form", daemon=True)
        self._thread.start()

    @property
    def running(self) -> bool:
        """Whether it is still under way."""
        return self._thread.is_alive()

    @property
    def stopped(self) -> bool:
        """Whether it was asked to stop."""
        return self._stop.is_set()

    def stop(self) -> None:
        """Ask it to stop; it does so within half a second as a rule."""
        self._stop.set()

    def wait(self, seconds: float) -> None:
        """Wait for its end.

        Parameters
        ----------
        seconds : float
            The longest time to wait.
        """
        self._thread.join(seconds)

    def result(self) -> Any:
        """Give the result of a job that has ended.

        Returns
        -------
        object
            What `work` returned.

        Raises
        ------
        CancelledError
            If it was stopped.
        Exception
            Whatever `work` raised.
        """
        if self.stopped:
            raise CancelledError()
        if self._error is not None:
            raise self._error
        return self._result

    def _run(self) -> None:
        try:
            self._result = self._work(self._progress, self._stop.is_set)
        except Exception as error:  # handed over to whoever asks for the result
            self._error = error

    def _progress(self, fraction: float, stage: str) -> None:
        self.fraction, self.stage = fraction, stage
