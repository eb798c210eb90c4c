"""A process that works on one task after another, and what this process knows of it."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from .attempts import Failure, attempts, begin_work

if TYPE_CHECKING:
    from multiprocessing.connection import Connection

_LONGEST_WAIT = 86_400.0  # seconds; the system takes less than 2^31 ms
Work = tuple[Callable[..., Any], tuple[Any, ...]]


@dataclass
class Task:
    """A task and what has become of it.

    Attributes
    ----------
    name : object
        Its name.
    work : (callable, tuple)
        The function and its arguments.
    deaths : int
        Number of workers that died of it.
    """

    name: object
    work: Work
    deaths: int = 0


class Worker:
    """A process that works on one task at a time.

    Attributes
    ----------
    process : multiprocessing.Process
        The process.
    pipe : Connection
        To it and from it.
    task : Task or None
        What it works on.
    """

    def __init__(self) -> None:
        from multiprocessing import get_context

        spawn = get_context("spawn")
        self.pipe, theirs = spawn.Pipe()
        self.process = spawn.Process(target=_work, args=(theirs,), daemon=True)
        self.process.start()
        theirs.close()  # so that the end of the process is the end of the pipe
        self.task: Task | None = None
        self._until = float("inf")

    def begin(self, task: Task, timeout: float | None) -> Worker:
        """Hand a task over; `timeout` in seconds."""
        self.task = task
        self._until = float("inf") if timeout is None else time.monotonic() + timeout
        with suppress(OSError):  # it has died, which is found when its replies are read
            self.pipe.send(task.work)
        return self

    def replies(self) -> Iterator[Any]:
        """Yield the results that have arrived; ends `task` with the last."""
        with suppress(EOFError, OSError):  # it has died
            while self.task is not None and self.pipe.poll():
                last, result = self._reply()
                if last:
                    self.task = None
                else:
                    yield result
            return
        self.process.join()

    def _reply(self) -> tuple[bool, Any]:
        """Receive whether the task is done, or a result of it."""
        try:
            last, result = self.pipe.recv()
        except (EOFError, OSError):
            raise
        except Exception as error:  # a result that cannot be read here
            return False, Failure(f"{type(error).__name__}: {error}")
        return last, result

    @property
    def in_time(self) -> bool:
        """Whether its task may go on."""
        return self.task is None or time.monotonic() < self._until

    @property
    def left(self) -> float:
        """Seconds that its task may go on."""
        return max(self._until - time.monotonic(), 0.0)

    def end(self) -> None:
        """Kill the process."""
        self.process.kill()
        self.process.join()
        self.pipe.close()


def ready(workers: Sequence[Worker]) -> list[Worker]:
    """Wait until some workers have replied, died, or run out of time, and return these."""
    from multiprocessing.connection import wait

    least = min(worker.left for worker in workers)
    heard = wait([worker.pipe for worker in workers], None if least == float("inf") else min(least, _LONGEST_WAIT))
    return [worker for worker in workers if worker.pipe in heard or not worker.in_time]


def _work(pipe: Connection) -> None:
    """Work on the tasks that arrive, until the pipe is closed."""
    begin_work()
    with suppress(EOFError, OSError):
        while True:
            try:
                function, arguments = pipe.recv()
            except (EOFError, OSError):
                raise
            except Exception as error:  # a function or an argument that cannot be read here
                _send(pipe, Failure(f"{type(error).__name__}: {error}"))
            else:
                for result in attempts(function, arguments):
                    _send(pipe, result)
            pipe.send((True, None))


def _send(pipe: Connection, result: Any) -> None:
    """Send a result, or why it cannot be sent."""
    try:
        pipe.send((False, result))
    except OSError:
        raise
    except Exception as error:  # a result that cannot be pickled
        pipe.send((False, Failure(f"{type(error).__name__}: {error}")))
