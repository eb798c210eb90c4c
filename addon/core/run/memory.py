"""How much memory a run needs, known before it is spent."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from pathlib import Path

import numpy as np

from ..unfolding.settings import Settings
from .errors import TooLargeError

_SMALL = (0.055, 0.6e-6)  # gigabytes, and by vertex: the work on the coarse mesh, measured
_LARGE = (0.015, 1.27e-6)  # the rounds of the coarse mesh, which take more from about 60,000 vertices on
_ALL_PAIRS = ("classical", "least_squares", "non_metric", "one_form")  # at quality 'full'
_LANDMARK_BYTES = 40.0  # a distance of each vertex from each landmark, and the work to place the vertex by them
_FACTORS = (6.9, 655_362, 1.35)  # gigabytes that the factors of the heat method take at so many vertices, and growth
_FIELDS = {"fast_marching": (0.05, 0.75e-6), "biharmonic": (0.1, 1.05e-6), "commute_time": (0.1, 1.05e-6)}  # as _SMALL
_SHARE = 0.6  # of the free memory: the most that a run may take where no limit is set
_UNKNOWN = 8.0  # gigabytes, where the system does not say how much is free


def memory_estimate(vertex_count: int, settings: Settings) -> float:
    """Estimate the most memory that a run takes, beyond what Python and the mesh already take.

    Parameters
    ----------
    vertex_count : int
        Number of vertices.
    settings : Settings
        The options; at quality 'full' the estimate is for five patches of equal size.

    Returns
    -------
    float
        Gigabytes.
    """
    estimate = max(base + each * vertex_count for base, each in (_SMALL, _LARGE))
    if settings.method in _ALL_PAIRS and settings.whole:
        estimate += _pair_bytes([float(vertex_count)]) / 1e9
    elif settings.method != "local_features":
        estimate += _LANDMARK_BYTES * vertex_count * settings.landmarks / 1e9
    elif settings.whole:
        patch = vertex_count / 5
        estimate += _pair_bytes([patch] * 5) / 1e9
    return estimate


def field_memory_estimate(vertex_count: int, kind: str) -> float:
    """Estimate the most memory that distances from some vertices take.

    Parameters
    ----------
    vertex_count : int
        Number of vertices of the connected surface; where the heat method refines it, of the refined one.
    kind : {'heat', 'fast_marching', 'biharmonic', 'commute_time'}
        As in `distance_field`.

    Returns
    -------
    float
        Gigabytes.
    """
    if kind in _FIELDS:
        base, each = _FIELDS[kind]
        return base + each * vertex_count
    most, at, growth = _FACTORS
    return 0.05 + most * (vertex_count / at) ** growth


def time_estimate(vertex_count: int, settings: Settings) -> float:
    """Estimate how long a run takes on a machine of 2020 or later, within a factor of two.

    Parameters
    ----------
    vertex_count : int
        Number of vertices.
    settings : Settings
        The options.

    Returns
    -------
    float
        Seconds.
    """
    if settings.whole and (settings.method == "local_features" or settings.method in _ALL_PAIRS):
        return 1.0 + 2e-7 * vertex_count**2
    return (0.4 if settings.quality == "draft" else 0.8) + 2.3e-5 * vertex_count


def memory_limit(settings: Settings) -> float:
    """Give the most memory that a run may take.

    Parameters
    ----------
    settings : Settings
        The options.

    Returns
    -------
    float
        Gigabytes: the limit that is set, or a share of the memory that is free now.
    """
    return settings.memory_limit or _SHARE * free_memory()


def free_memory() -> float:
    """Ask the system how much memory this process may still take.

    Returns
    -------
    float
        Gigabytes: what is free on the machine, in the container and below the limit of the process, whichever is less;
        8 where nothing is known.
    """
    reader = {"linux": _free_on_linux, "win32": _free_on_windows}.get(sys.platform, _free_elsewhere)
    known = [amount for amount in (*reader(), _free_address_space()) if amount is not None]
    return max(min(known, default=_UNKNOWN * 1e9), 0.0) / 1e9


def require_memory(vertex_count: int, settings: Settings) -> None:
    """Refuse a mesh that is too large for the memory limit at draft and normal quality.

    Parameters
    ----------
    vertex_count : int
        Number of vertices.
    settings : Settings
        The options.

    Raises
    ------
    TooLargeError
        With the memory needed and what to do.
    """
    needed = memory_estimate(vertex_count, settings)
    limit = memory_limit(settings)
    checked_later = settings.whole and settings.method in ("local_features", *_ALL_PAIRS)  # by the pairs there are
    if not checked_later and needed > limit:
        raise TooLargeError(
            f"A mesh of {vertex_count:,} vertices needs about {needed:.1f} GB, more than {_named(limit, settings)}. "
            "Reduce the mesh (for instance with a Decimate modifier, applied), close other programs, or raise the "
            "memory limit."
        )


def require_field_memory(vertex_count: int, kind: str, settings: Settings) -> None:
    """Refuse to measure distances on a surface that is too large for the memory.

    Parameters
    ----------
    vertex_count : int
        As in `field_memory_estimate`.
    kind : str
        Likewise.
    settings : Settings
        The memory limit.

    Raises
    ------
    TooLargeError
        With the memory needed and what to do.
    """
    needed = field_memory_estimate(vertex_count, kind)
    limit = memory_limit(settings)
    if needed > limit:
        other = "Fast marching takes far less. Or close" if kind == "heat" else "Close"
        raise TooLargeError(
            f"These distances need about {needed:.1f} GB, more than {_named(limit, settings)}. {other} other programs, "
            "reduce the mesh (for instance with a Decimate modifier, applied), or raise the memory limit."
        )


def require_pair_memory(vertex_count: int, sizes: list[int], settings: Settings) -> None:
    """Refuse before the memory is spent: tiles and factors of every patch, three matrices of the largest.

    Parameters
    ----------
    vertex_count : int
        Number of vertices.
    sizes : list of int
        Number of vertices of each patch.
    settings : Settings
        The options.

    Raises
    ------
    TooLargeError
        With the memory needed and what to do.
    """
    needed = _pair_bytes([float(size) for size in sizes]) / 1e9
    limit = memory_limit(settings)
    if needed > limit:
        advice = "Use quality Normal" if settings.quality == "full" else "Merge vertices by distance"
        which = "of points" if len(sizes) == 1 else f"of points inside the {len(sizes)} patches"
        raise TooLargeError(
            f"All pairs {which} need about {needed:.1f} GB, more than "
            f"{_named(limit, settings)}. {advice}, reduce the mesh to about "
            f"{int(vertex_count * np.sqrt(limit / needed)):,} vertices (for instance with a Decimate modifier, "
            "applied), or raise the memory limit."
        )


def _pair_bytes(sizes: list[float]) -> float:
    return 8 * (2 * sum(size**2 for size in sizes) + 3 * max(sizes) ** 2)


def _named(limit: float, settings: Settings) -> str:
    if settings.memory_limit:
        return f"the limit of {limit:g} GB"
    return f"{limit:.1f} GB, which is {_SHARE:.0%} of the free memory"


def _free_on_linux() -> list[float | None]:
    """Read what is available on the machine and what is left in the control group."""
    amounts: list[float | None] = []
    with suppress(OSError, ValueError, StopIteration):
        lines = Path("/proc/meminfo").read_text().splitlines()
        amounts.append(1024.0 * int(next(line.split()[1] for line in lines if line.startswith("MemAvailable:"))))
    for highest, taken in (
        ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory.current"),
        ("/sys/fs/cgroup/memory/memory.limit_in_bytes", "/sys/fs/cgroup/memory/memory.usage_in_bytes"),
    ):
        with suppress(OSError, ValueError):  # no such limit, or "max"
            used = int(Path(taken).read_text()) - _cached(Path(taken).with_name("memory.stat"))
            amounts.append(float(int(Path(highest).read_text()) - used))
    return amounts


def _cached(path: Path) -> int:
    """Sum what a control group keeps of files and gives back when it is needed."""
    found = dict(line.split()[:2] for line in path.read_text().splitlines() if len(line.split()) == 2)
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
    """Take half of the memory that is built in for free."""
    with suppress(OSError, ValueError, AttributeError):
        return [os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") / 2]
    return []


def _free_address_space() -> float | None:
    """Subtract what the process has from its limit, as ``ulimit -v`` sets it."""
    try:
        import resource

        limit = resource.getrlimit(resource.RLIMIT_AS)[0]
        if limit == resource.RLIM_INFINITY:
            return None
        taken = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    except (ImportError, OSError, ValueError):
        return None
    return float(limit - taken)
