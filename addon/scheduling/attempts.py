"""How a worker starts, runs a task, and reports the exception that it raised."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Generator, Iterator
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from ..core.run.errors import CanonicalFormError
from ..core.run.memory import free_memory

_DIE_WITH_PARENT = 1  # PR_SET_PDEATHSIG of the Linux kernel
_SHARE = 0.9  # of the free memory: the most that a worker may use, whatever a file requests


@dataclass(frozen=True)
class Failure:
    """Replaces the result of a failed task.

    Attributes
    ----------
    reason : str
        The error message.
    died : bool
        Whether the task repeatedly killed its worker process.
    """

    reason: str
    died: bool = False


def attempts(function: Callable[..., Any], arguments: tuple[Any, ...]) -> Iterator[Any]:
    """Run a task and yield its result, or each result if the function yields them, or a `Failure`.

    Parameters
    ----------
    function : callable
        The function to run.
    arguments : tuple
        Its arguments.

    Yields
    ------
    object
        A result, or a `Failure` with the error message: the exception itself may not be picklable.
    """
    try:
        found = function(*arguments)
        if isinstance(found, Generator):
            yield from found
        else:
            yield found
    except CanonicalFormError as error:
        yield Failure(str(error))
    except MemoryError:
        yield Failure("Not enough memory.")
    except Exception as error:  # any error, as the worker must survive
        yield Failure(f"{type(error).__name__}: {error}")
    finally:
        give_memory_back()


def attempted(function: Callable[..., Any], arguments: tuple[Any, ...]) -> list[Any]:
    """Run a task and return the list of its results.

    Parameters
    ----------
    function : callable
        The function to run.
    arguments : tuple
        Its arguments.

    Returns
    -------
    list of object
        As `attempts` yields them.
    """
    return list(attempts(function, arguments))


def give_memory_back() -> None:
    """Return freed memory to the system where the C library keeps it: meshes of many sizes fragment it."""
    if sys.platform == "linux":
        import ctypes

        with suppress(OSError, AttributeError):  # another C library, which does not need this
            ctypes.CDLL("libc.so.6").malloc_trim(0)


def keep_below(gigabytes: float) -> None:
    """Limit the memory of this process where the system can: a damaged file may request any amount.

    Parameters
    ----------
    gigabytes : float
        The limit; an existing lower limit stays.
    """
    if sys.platform == "linux":
        import resource

        wanted, (now, most) = int(1e9 * gigabytes), resource.getrlimit(resource.RLIMIT_DATA)
        if now in (resource.RLIM_INFINITY, -1) or now > wanted:
            resource.setrlimit(resource.RLIMIT_DATA, (wanted, most))


def begin_work() -> None:
    """Ignore keyboard interrupts, and end when the process that started this one ends or is killed."""
    import signal
    from multiprocessing import parent_process
    from threading import Thread

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    keep_below(_SHARE * free_memory())
    if sys.platform == "linux":
        import ctypes

        with suppress(OSError, AttributeError):  # takes effect at once, even while Blender reads a file
            ctypes.CDLL("libc.so.6").prctl(_DIE_WITH_PARENT, signal.SIGKILL)
    parent = parent_process()
    if parent is None:
        return

    def watch() -> None:
        parent.join()
        os._exit(1)

    Thread(target=watch, daemon=True).start()
