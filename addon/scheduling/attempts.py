"""How a worker begins, tries a piece of work, and tells what it raised."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from ..core.run.errors import CanonicalFormError
from ..core.run.memory import free_memory

_DIE_WITH_PARENT = 1  # PR_SET_PDEATHSIG of the Linux kernel
_SHARE = 0.9  # of the free memory: the most that a worker may take, whatever a file asks for


@dataclass(frozen=True)
class Failure:
    """Takes the place of a result where there is none.

    Attributes
    ----------
    reason : str
        A sentence.
    died : bool
        Whether the work took its process along, again and again.
    """

    reason: str
    died: bool = False


def attempted(function: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
    """Run a piece of work where it may fail, and bring back what any process can read.

    Parameters
    ----------
    function : callable
        The work.
    arguments : tuple
        Its arguments.

    Returns
    -------
    object
        Its result, or a `Failure` with what it raised: an exception itself may not survive the way back.
    """
    try:
        return function(*arguments)
    except CanonicalFormError as error:
        return Failure(str(error))
    except MemoryError:
        return Failure("Not enough memory.")
    except Exception as error:  # any: it must not take the worker along
        return Failure(f"{type(error).__name__}: {error}")
    finally:
        give_memory_back()


def give_memory_back() -> None:
    """Return freed memory to the system, where the C library keeps it: meshes of many sizes leave holes in it."""
    if sys.platform == "linux":
        import ctypes

        with suppress(OSError, AttributeError):  # another C library, which has no need of it
            ctypes.CDLL("libc.so.6").malloc_trim(0)


def keep_below(gigabytes: float) -> None:
    """Refuse this process more memory than that, where the system can: a damaged file may ask for any amount.

    Parameters
    ----------
    gigabytes : float
        The most; a limit that is lower already stays.
    """
    if sys.platform == "linux":
        import resource

        wanted, (now, most) = int(1e9 * gigabytes), resource.getrlimit(resource.RLIMIT_DATA)
        if now in (resource.RLIM_INFINITY, -1) or now > wanted:
            resource.setrlimit(resource.RLIMIT_DATA, (wanted, most))


def begin_work() -> None:
    """Leave the keyboard to the process that started this one, and end when that is gone, killed or not."""
    import signal
    from multiprocessing import parent_process
    from threading import Thread

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    keep_below(_SHARE * free_memory())
    if sys.platform == "linux":
        import ctypes

        with suppress(OSError, AttributeError):  # at once, also while Blender reads
            ctypes.CDLL("libc.so.6").prctl(_DIE_WITH_PARENT, signal.SIGKILL)
    parent = parent_process()
    if parent is None:
        return

    def watch() -> None:
        parent.join()
        os._exit(1)

    Thread(target=watch, daemon=True).start()
