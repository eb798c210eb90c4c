"""How much memory a run may use: what is free now, and the limit that is set."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from pathlib import Path

import numpy as np

from .errors import TooLargeError
from .messages import Message, message

_SHARE = 0.6  # of the free memory: the maximum that a run may use if no limit is set
_UNKNOWN = 8.0  # gigabytes, where the system does not say how much is free


def memory_limit(limit: float = 0.0) -> float:
    """Return the maximum memory that a run may use.

    `limit`: the limit that is set, in gigabytes; 0 for none.

    Examples
    --------
    >>> memory_limit(2.5)
    2.5
    """
    return limit or _SHARE * free_memory()


def limit_in_words(limit: float = 0.0) -> Message:
    """Describe the memory limit in words.

    Examples
    --------
    >>> str(limit_in_words(2.5))
    'the limit of 2.5 GB'
    """
    if limit:
        return message("limit_given", limit=limit)
    return message("limit_free", limit=memory_limit(), share=_SHARE)


def pair_memory(sizes: list[float]) -> float:
    """Estimate the memory of all pairs inside patches: two matrices and V with its factors, three of the largest.

    `sizes`: number of vertices of each patch.

    Examples
    --------
    >>> pair_memory([10_000.0])
    8.8
    """
    return 8e-9 * (8 * sum(size**2 for size in sizes) + 3 * max(sizes) ** 2)


def require_pair_memory(vertex_count: int, sizes: list[int], *, limit: float = 0.0, whole: bool = False) -> None:
    """Raise an error if all pairs inside patches would exceed the memory limit.

    `vertex_count`: number of vertices; `sizes`: number of vertices of each patch; `whole`: whether the user chose to
    use all vertices.

    Examples
    --------
    >>> require_pair_memory(1_000, [1_000], limit=1.0)
    >>> try:
    ...     require_pair_memory(100_000, [100_000], limit=1.0)
    ... except TooLargeError as error:
    ...     print(error.kind)
    pair_memory
    """
    needed, most = pair_memory([float(size) for size in sizes]), memory_limit(limit)
    if needed > most:
        raise TooLargeError(
            "pair_memory",
            which=message("pairs_of_points") if len(sizes) == 1 else message("pairs_in_patches", count=len(sizes)),
            needed=needed,
            limit=limit_in_words(limit),
            advice=message("advice_quality") if whole else message("advice_merge"),
            vertices=int(vertex_count * np.sqrt(most / needed)),
        )


def free_memory() -> float:
    """Query the system for the memory that this process may still use.

    Examples
    --------
    >>> free_memory() >= 0
    True
    """
    reader = {"linux": _free_on_linux, "win32": _free_on_windows}.get(sys.platform, _free_elsewhere)
    known = [amount for amount in (*reader(), _free_address_space()) if amount is not None]
    return max(min(known, default=_UNKNOWN * 1e9), 0.0) / 1e9


def _free_on_linux() -> list[float | None]:
    """Read what is available on the machine and what is left in the control group."""
    amounts: list[float | None] = []
    with suppress(OSError, ValueError, StopIteration):
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()
        amounts.append(1024.0 * int(next(line.split()[1] for line in lines if line.startswith("MemAvailable:"))))
    for highest, taken in (
        ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory.current"),
        ("/sys/fs/cgroup/memory/memory.limit_in_bytes", "/sys/fs/cgroup/memory/memory.usage_in_bytes"),
    ):
        with suppress(OSError, ValueError):  # no such limit, or "max"
            used = int(Path(taken).read_text(encoding="ascii")) - _cached(Path(taken).with_name("memory.stat"))
            amounts.append(float(int(Path(highest).read_text(encoding="ascii")) - used))
    return amounts


def _cached(path: Path) -> int:
    """Sum the file cache of a control group, which is released on demand."""
    found = dict(line.split()[:2] for line in path.read_text(encoding="ascii").splitlines() if len(line.split()) == 2)
    names = ("inactive_file", "active_file")
    prefix = "total_" if "total_inactive_file" in found else ""
    return sum(int(found.get(prefix + name, 0)) for name in names)


def _free_on_windows() -> list[float | None]:
    import ctypes

    status = (ctypes.c_ulonglong * 8)(64)  # MEMORYSTATUSEX: its size, load, then total and available physical memory …
    if not ctypes.windll.kernel32.GlobalMemoryStatusEx(ctypes.byref(status)):  # type: ignore[attr-defined]
        return []
    return [float(status[2])]


def _free_elsewhere() -> list[float | None]:
    """Assume that half of the installed memory is free."""
    with suppress(OSError, ValueError, AttributeError):
        return [os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") / 2]
    return []


def _free_address_space() -> float | None:
    """Subtract the address space in use from the limit set by ``ulimit -v``."""
    try:
        import resource

        limit = resource.getrlimit(resource.RLIMIT_AS)[0]
        if limit == resource.RLIM_INFINITY:
            return None
        taken = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0]) * resource.getpagesize()
    except (ImportError, OSError, ValueError):
        return None
    return float(limit - taken)
