"""Distributes work to processes of this machine or to a Dask cluster, and replaces workers that die."""

from __future__ import annotations

import os
import pickle
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Protocol

from ..core.run.errors import CanonicalFormError
from .attempts import Failure, attempted, begin_work
from .shipping import packed_code, remote_runner, unpacked

_THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")
_AHEAD = 2  # tasks queued for each worker
_PATIENCE = "20s"  # timeout for a reply of the scheduler
Work = tuple[Callable[..., Any], tuple[Any, ...]]


class Crew(Protocol):
    """Workers that take tasks in order and return results in any order."""

    def results(self, work: Iterator[tuple[object, Work]]) -> Iterator[tuple[object, Any]]:
        """Run all tasks.

        Parameters
        ----------
        work : iterator of (object, (callable, tuple))
            Names, and functions with their arguments; consumed only as fast as workers need them.

        Yields
        ------
        (object, object)
            The name, and the result or a `Failure` in its place.
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
            The name, and the result or a `Failure` in its place.
        """
        for name, (function, arguments) in work:
            yield name, attempted(function, arguments)

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
    """

    def __init__(self, count: int, attempts: int = 3, *, one_thread: bool = True) -> None:
        self._one_thread = one_thread
        self._count = count
        self._attempts = attempts
        self._pool: Any = None

    def _started(self) -> Any:
        from concurrent.futures import ProcessPoolExecutor
        from multiprocessing import get_context

        for name in _THREADS if self._one_thread else ():
            os.environ[name] = "1"  # inherited by the workers; the libraries of this process are loaded already
        return ProcessPoolExecutor(self._count, get_context("spawn"), begin_work)

    def results(self, work: Iterator[tuple[object, Work]]) -> Iterator[tuple[object, Any]]:
        """Run all tasks.

        Parameters
        ----------
        work : iterator of (object, (callable, tuple))
            Names and tasks.

        Yields
        ------
        (object, object)
            The name, and the result or a `Failure` in its place.
        """
        from concurrent.futures import FIRST_COMPLETED, wait
        from concurrent.futures.process import BrokenProcessPool

        under_way: dict[Any, tuple[object, Work]] = {}
        again: list[tuple[object, Work]] = []
        died: dict[object, int] = {}
        suspects: list[tuple[object, Work]] = []  # one of these tasks may kill its worker, so each runs alone
        self._pool = self._pool or self._started()
        more = True
        while True:
            room = 1 if suspects else self._count * _AHEAD
            while len(under_way) < room and (suspects or again or more):
                if suspects:
                    piece = suspects.pop()
                elif again:
                    piece = again.pop()
                else:
                    drawn = next(work, None)
                    if drawn is None:
                        more = False
                        break
                    piece = drawn
                try:
                    under_way[self._pool.submit(attempted, *piece[1])] = piece
                except BrokenProcessPool:
                    again.append(piece)
                    break
            if not under_way and not again and not suspects and not more:
                return
            broken = False
            ready = wait(under_way, return_when=FIRST_COMPLETED).done if under_way else ()
            for future in [each for each in under_way if each in ready]:  # in the order of the tasks
                try:
                    result = future.result()
                except BrokenProcessPool:
                    broken = True
                    continue
                except Exception as error:  # a result that cannot be pickled
                    result = Failure(f"{type(error).__name__}: {error}")
                yield under_way.pop(future)[0], result
            if broken or (not under_way and again):
                self._pool.shutdown(wait=True)
                self._pool = self._started()
                lost = list(under_way.values())
                again += lost[: self._count - 1 : -1]  # these were queued
                for piece in lost[: self._count][::-1]:  # the first is tried first
                    died[piece[0]] = died.get(piece[0], 0) + 1
                    if died[piece[0]] >= self._attempts:
                        reason = f"The worker process died {self._attempts} times (out of memory?)."
                        yield piece[0], Failure(reason, died=True)
                    else:
                        suspects.append(piece)
                under_way.clear()

    def close(self) -> None:
        """End the processes, even while they are working."""
        if self._pool is not None:
            working = list((self._pool._processes or {}).values())
            self._pool.shutdown(wait=False, cancel_futures=True)
            for process in working:
                process.terminate()
            try:
                for process in working:
                    process.join()
            except KeyboardInterrupt:  # a second one, from a user who does not want to wait
                for process in working:
                    process.kill()
            self._pool = None


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
                result = self._fetched(future)
                future.release()
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
