"""A computation in its own thread, with progress and cancellation; it never touches Blender's data."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

from ...core import CancelledError
from ...core.run.monitor import Cancelled, Progress


class Job:
    """A running computation.

    Parameters
    ----------
    work : callable
        Called with `progress` and `cancelled`, as in `canonical_form`; works on arrays only.

    Attributes
    ----------
    fraction : float
        Completed fraction, 0 to 1.
    stage : str
        Name of the current stage.
    shown_at : float
        Time at which the progress was last shown, from `time.perf_counter`.
    """

    def __init__(self, work: Callable[[Progress, Cancelled], Any]) -> None:
        self.fraction, self.stage, self.shown_at = 0.0, "Starting", 0.0
        self._work = work
        self._stop = threading.Event()
        self._result: Any = None
        self._error: Exception | None = None
        # a daemon thread: quitting Blender does not wait for it
        self._thread = threading.Thread(target=self._run, name="Canonical Form", daemon=True)
        self._thread.start()

    @property
    def running(self) -> bool:
        """Whether the thread is still running."""
        return self._thread.is_alive()

    @property
    def stopped(self) -> bool:
        """Whether cancellation was requested."""
        return self._stop.is_set()

    def stop(self) -> None:
        """Request cancellation; the thread usually ends within half a second."""
        self._stop.set()

    def wait(self, seconds: float) -> None:
        """Wait until the thread ends.

        Parameters
        ----------
        seconds : float
            Maximum time to wait.
        """
        self._thread.join(seconds)

    def result(self) -> Any:
        """Return the result of a job that has ended.

        Returns
        -------
        object
            Return value of `work`.

        Raises
        ------
        CancelledError
            If cancellation was requested.
        Exception
            The exception that `work` raised.
        """
        if self.stopped:
            raise CancelledError()
        if self._error is not None:
            raise self._error
        return self._result

    def _run(self) -> None:
        try:
            self._result = self._work(self._progress, self._stop.is_set)
        except Exception as error:  # `result` raises it again
            self._error = error

    def _progress(self, fraction: float, stage: str) -> None:
        self.fraction, self.stage = fraction, stage
