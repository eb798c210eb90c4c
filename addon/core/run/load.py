"""The load of the machine from other processes, which estimates of time take into account."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path


def slowdown() -> float:
    """Estimate how much longer a computation takes because other processes use the processors.

    A computation uses one thread most of the time. It is slowed down if more threads are ready to run than there are
    processors; the threads then share them evenly.

    Examples
    --------
    >>> slowdown() >= 1
    True
    """
    return max(1.0, (_others() + 1) / _processors())


def _others() -> float:
    """Count the runnable threads of other processes: now and over the last minute, whichever is less.

    Right after our own run, the last minute is busy; a single moment may be busy by chance.
    """
    try:
        minute = os.getloadavg()[0]
    except (AttributeError, OSError):  # Windows has none
        return 0.0
    with suppress(OSError, ValueError, IndexError):
        now = int(Path("/proc/loadavg").read_text(encoding="ascii").split()[3].split("/")[0])
        return min(minute, max(now - 1.0, 0.0))  # without the calling thread
    return minute


def _processors() -> int:
    """Count the processors that this process may use."""
    with suppress(AttributeError, OSError):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
