"""Distributes work to processes of this machine or to a Dask cluster, and replaces workers that die."""

from __future__ import annotations

import os
import pickle
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Protocol

from ..core.run.errors import CanonicalFormError
from .attempts import Failure, attempted, attempts
from .shipping import packed_code, remote_runner, unpacked
from .workers import Task, Work, Worker, ready

_THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")
_AHEAD = 2  # tasks queued for each worker
_PATIENCE = "20s"  # timeout for a reply of the scheduler


class Crew(Protocol):
    """Workers that take tasks in order and return results in any order.

    A function that yields has several results, which come as soon as it yields them (from a cluster, at its end). If
    its worker dies, another begins it again, and yields the first ones again.
    """

    def results(self, work: Iterator[tuple[object, Work]]) -> Iterator[tuple[object, Any]]:
        """Run all tasks.

        Parameters
        ----------
        work : iterator of (object, (callable, tuple))
            Names, and functions with their arguments; consumed only as fast as workers need them.

        Yields
        ------
        (object, object)
            The name, and a result or a `Failure` in its place.
        """

    def close(self) -> None:
        """Release the workers."""


class InThisProcess:
    """Runs all tasks in this process, one after the other: inside Blender there is only one process."""

    def results(self, work: Iterator[tuple[object, Work]]) -> Iterator[tuple[object, Any]]:
        """Run all tasks.

        Parameters
        ----------
        work : iterator of (object, (callable, tuple))
            Names and tasks.

        Yields
        ------
        (object, object)
            The name, and a result or a `Failure` in its place.
        """
        for name, (function, arguments) in work:
            for result in attempts(function, arguments):
                yield name, result

    def close(self) -> None:
        """Do nothing: there are no workers to release."""


class LocalCrew:
    """Processes of this machine.

    Parameters
    ----------
    count : int
        Number of processes.
    attempts : int
        Number of times that a task may kill its worker before it counts as failed.
    one_thread : bool
        Whether each process uses only one thread, so that they do not slow each other down.
    timeout : float, optional
        Seconds after which a task is ended, with its process.
    """

    def __init__(self, count: int, attempts: int = 3, *, one_thread: bool = True, timeout: float | None = None) -> None:
        self._one_thread = one_thread
        self._count = count
        self._attempts = attempts
        self._timeout = timeout
        self._workers: list[Worker] = []

    def _idle(self) -> Worker:
        """Return a worker that waits for a task, or start one."""
        for worker in self._workers:
            if worker.task is None and worker.process.is_alive():
                return worker
        for name in _THREADS if self._one_thread else ():
            os.environ[name] = "1"  # inherited by the workers; the libraries of this process are loaded already
        self._workers.append(Worker())
        return self._workers[-1]

    def results(self, work: Iterator[tuple[object, Work]]) -> Iterator[tuple[object, Any]]:
        """Run all tasks; one that kills its worker is tried again while nothing else runs.

        Parameters
        ----------
        work : iterator of (object, (callable, tuple))
            Names and tasks.

        Yields
        ------
        (object, object)
            The name, and a result or a `Failure` in its place.
        """
        suspects: list[Task] = []
        more = True
        while True:
            busy = [worker for worker in self._workers if worker.task is not None]
            while more and not suspects and len(busy) < self._count:
                drawn = next(work, None)
                if drawn is None:
                    more = False
                    break
                busy.append(self._idle().begin(Task(*drawn), self._timeout))
            if suspects and not busy:
                busy.append(self._idle().begin(suspects.pop(0), self._timeout))
            if not busy:
                return
            for worker in ready(busy):
                task = worker.task
                assert task is not None
                for result in worker.replies():
                    yield task.name, result
                if worker.process.is_alive() and worker.in_time:
                    continue
                self._workers.remove(worker)
                worker.end()
                task.deaths += 1
                if worker.task is None:  # it died after its work
                    continue
                if not worker.in_time:
                    yield task.name, Failure(f"It took longer than {self._timeout:g} s.")
                elif task.deaths < self._attempts:
                    suspects.append(task)
                else:
                    reason = f"The worker process died {self._attempts} times (out of memory?)."
                    yield task.name, Failure(reason, died=True)

    def close(self) -> None:
        """End the processes, even while they are working."""
        workers, self._workers = self._workers, []
        for worker in workers:
            worker.process.terminate()
        try:
            for worker in workers:
                worker.process.join()
        except KeyboardInterrupt:  # a second one, from a user who does not want to wait
            for worker in workers:
                worker.process.kill()


class DaskCrew:
    """An existing Dask cluster. Its workers need numpy and scipy; this code is uploaded to them.

    Parameters
    ----------
    address : str
        Host and port of the scheduler.

    Raises
    ------
    CanonicalFormError
        If Dask is not installed or the scheduler does not answer.
    """

    def __init__(self, address: str) -> None:
        try:
            from distributed import Client
        except ImportError as error:
            raise CanonicalFormError("A cluster needs Dask: pip install 'dask[distributed]'.") from error
        try:
            self._client = Client(address if "://" in address else f"tcp://{address}", timeout=_PATIENCE)
        except (OSError, ValueError) as error:
            raise CanonicalFormError(f"No Dask scheduler answers at {address}.") from error
        with tempfile.TemporaryDirectory() as folder:
            code, self._name = packed_code(Path(folder))
            self._client.upload_file(str(code))  # also to workers that join later
        self._run = remote_runner(self._name)

    def results(self, work: Iterator[tuple[object, Work]]) -> Iterator[tuple[object, Any]]:
        """Run all tasks; the scheduler reassigns the tasks of lost workers.

        Parameters
        ----------
        work : iterator of (object, (callable, tuple))
            Names and tasks.

        Yields
        ------
        (object, object)
            The name, and the result or a `Failure` in its place.

        Raises
        ------
        CanonicalFormError
            If the connection to the scheduler is lost.
        """
        from distributed import as_completed

        names: dict[Any, object] = {}
        running = as_completed([], with_results=False)

        def submit_some() -> None:
            threads = sum(self._client.nthreads().values())
            while len(names) < max(threads, 1) * _AHEAD:
                piece = next(work, None)
                if piece is None:
                    return
                future = self._client.submit(self._run, pickle.dumps((attempted, piece[1])), pure=False)
                names[future.key] = piece[0]
                running.add(future)

        submit_some()
        if not self._client.nthreads():
            print("canonical_form: The Dask scheduler has no workers yet; waiting for some.", file=sys.stderr)
        try:
            for future in running:
                name = names.pop(future.key)
                found = self._fetched(future)
                future.release()
                for result in found if isinstance(found, list) else [found]:
                    yield name, result
                submit_some()
        except OSError as error:
            raise CanonicalFormError("The Dask scheduler is lost. Start again to go on.") from error

    def _fetched(self, future: Any) -> Any:
        """Return a result. If its worker dies before the transfer, Dask computes it again, which may fail."""
        from distributed import KilledWorker

        try:
            packed = future.result()
        except Exception as error:
            if future.status == "cancelled":
                raise CanonicalFormError("The Dask scheduler is lost. Start again to go on.") from error
            if future.status != "error":  # an error of the connection, not of the task
                raise
            if isinstance(error, KilledWorker):
                return Failure("The Dask workers that had it died repeatedly (out of memory?).", died=True)
            return Failure(f"{type(error).__name__}: {error}")
        return unpacked(packed, self._name)

    @property
    def most_threads(self) -> int:
        """Largest number of threads of a current worker."""
        return max(self._client.nthreads().values(), default=1)

    def close(self) -> None:
        """Disconnect, and leave the cluster running."""
        self._client.close()


@contextmanager
def crew(workers: int, scheduler: str | None) -> Iterator[LocalCrew | DaskCrew]:
    """Provide workers and release them at the end.

    Parameters
    ----------
    workers : int
        Number of processes on this machine.
    scheduler : str or None
        Host and port of a Dask scheduler to use instead.

    Yields
    ------
    LocalCrew or DaskCrew
        The workers.

    Raises
    ------
    CanonicalFormError
        If Dask is not installed or the scheduler does not answer.
    """
    hired = LocalCrew(workers) if scheduler is None else DaskCrew(scheduler)
    try:
        yield hired
    finally:
        hired.close()
