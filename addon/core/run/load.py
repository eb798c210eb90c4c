"""How busy the machine is with other work: estimates of time take it into account."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path


def slowdown() -> float:
    """Estimate how much longer a computation takes because others use the processors.

    A computation is one thread for most of its time. It is slowed down where more threads want to run than there are
    processors, which then share them evenly.

    Returns
    -------
    float
        1 where a processor is free, or where the system does not tell; 2 where two threads share each.

    Examples
    --------
    >>> slowdown() >= 1
    True
    """
    return max(1.0, (_others() + 1) / _processors())


def _others() -> float:
    """Count the threads of others that want to run: now and over the last minute, whichever is less.

    Right after a run of our own the last minute is busy; a moment alone may be busy by chance.
    """
    try:
        minute = os.getloadavg()[0]
    except (AttributeError, OSError):  # Windows has none
        return 0.0
    with suppress(OSError, ValueError, IndexError):
        now = int(Path("/proc/loadavg").read_text(encoding="ascii").split()[3].split("/")[0])
        return min(minute, max(now - 1.0, 0.0))  # without the thread that asks
    return minute


def _processors() -> int:
    """Count the processors that this process may use."""
    with suppress(AttributeError, OSError):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
