"""How much memory a run needs, known before it is spent."""

from __future__ import annotations

import numpy as np

from .errors import TooLargeError
from .settings import Settings

_BYTES_BY_VERTEX = 2500.0  # measured: the mesh, its links and the rounds of the coarse mesh
_ALL_PAIRS = ("classical", "least_squares", "non_metric", "one_form")  # at quality 'full'
_LANDMARK_BYTES = 40.0  # a distance of each vertex from each landmark, and the work to place the vertex by them
_BASE = 0.15  # gigabytes: the work on the coarse mesh


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
    estimate = _BASE + _BYTES_BY_VERTEX * vertex_count / 1e9
    if settings.method in _ALL_PAIRS and settings.whole:
        estimate += _pair_bytes([float(vertex_count)]) / 1e9
    elif settings.method != "local_features":
        estimate += _LANDMARK_BYTES * vertex_count * settings.landmarks / 1e9
    elif settings.whole:
        patch = vertex_count / 5
        estimate += _pair_bytes([patch] * 5) / 1e9
    return estimate


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
    checked_later = settings.whole and settings.method in ("local_features", *_ALL_PAIRS)  # by the pairs there are
    if not checked_later and needed > settings.memory_limit:
        raise TooLargeError(
            f"A mesh of {vertex_count:,} vertices needs about {needed:.1f} GB, more than the limit of "
            f"{settings.memory_limit:g} GB. Reduce the mesh (for instance with a Decimate modifier, applied), or raise "
            "the memory limit."
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
    limit = settings.memory_limit
    if needed > limit:
        advice = "Use quality Normal" if settings.quality == "full" else "Merge vertices by distance"
        which = "of points" if len(sizes) == 1 else f"of points inside the {len(sizes)} patches"
        raise TooLargeError(
            f"All pairs {which} need about {needed:.1f} GB, more than the limit of "
            f"{limit:g} GB. {advice}, reduce the mesh to about "
            f"{int(vertex_count * np.sqrt(limit / needed)):,} vertices (for instance with a Decimate modifier, "
            "applied), or raise the memory limit."
        )


def _pair_bytes(sizes: list[float]) -> float:
    return 8 * (2 * sum(size**2 for size in sizes) + 3 * max(sizes) ** 2)
