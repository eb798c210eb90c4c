"""Estimates of the memory and time that a run takes."""

from __future__ import annotations

from ..run.errors import TooLargeError
from ..run.memory import limit_in_words, memory_limit, pair_memory
from .catalogue import method_named
from .settings import Settings

_SMALL = (0.08, 0.4e-6)  # gigabytes, and per vertex: the work on the coarse mesh, measured
_LARGE = (0.04, 0.85e-6)  # the rounds of coarsening, which take more from about 160,000 vertices on
_MATCH = 0.5e-6  # gigabytes in addition to the larger form, per vertex of both, measured with a pose
_MATCH_SECONDS = (2.5, 6e-5)  # in addition to the two forms, and per vertex
_LANDMARK_BYTES = 40.0  # a distance of each vertex from each landmark, and the work to place the vertex by them
_WHOLE = 1.5e-5  # gigabytes per vertex where all are working vertices of an elastic body, measured
_USUAL_PATCHES = 5
PIECE_SECONDS = 0.25  # time that a loose part with a form of its own takes at least, measured


def memory_estimate(vertex_count: int, settings: Settings) -> float:
    """Estimate the peak memory of a run, beyond what Python and the mesh already use.

    `vertex_count`: number of vertices; `settings`: the options; at quality 'full' the estimate is for five patches of
    equal size.

    Examples
    --------
    >>> f"{memory_estimate(100_000, Settings()):.2f} GB"
    '0.12 GB'
    """
    method = method_named(settings.method)
    settings = method.settings(settings)
    estimate = max(base + each * vertex_count for base, each in (_SMALL, _LARGE))
    if method.pairs == "all" and settings.whole:
        return estimate + pair_memory([float(vertex_count)])
    if method.pairs == "none":
        return estimate + (_WHOLE * vertex_count if settings.whole else 0.0)
    if method.pairs != "patches":
        return estimate + 1e-9 * _LANDMARK_BYTES * vertex_count * settings.landmark_count
    if settings.whole:
        return estimate + pair_memory([vertex_count / _USUAL_PATCHES] * _USUAL_PATCHES)
    return estimate


def time_estimate(vertex_count: int, settings: Settings) -> float:
    """Estimate how long a run takes on a machine of 2020 or later, within a factor of two.

    `vertex_count`: number of vertices; `settings`: the options.

    Examples
    --------
    >>> f"{time_estimate(100_000, Settings()):.1f} s"
    '3.3 s'
    """
    if _grows_squared(settings):
        return 1.0 + 2e-7 * vertex_count**2
    return (0.4 if settings.quality == "draft" else 0.8) + 2.5e-5 * vertex_count


def require_memory(vertex_count: int, settings: Settings) -> None:
    """Raise an error if a mesh is too large for the memory limit.

    `vertex_count`: number of vertices of its largest piece; `settings`: the options.

    Examples
    --------
    >>> require_memory(10_000, Settings(memory_limit=1.0))
    >>> try:
    ...     require_memory(10_000_000, Settings(memory_limit=1.0))
    ... except TooLargeError as error:
    ...     print(error.kind)
    mesh_memory
    """
    needed = memory_estimate(vertex_count, settings)
    if not _grows_squared(settings) and needed > memory_limit(settings.memory_limit):
        limit = limit_in_words(settings.memory_limit)
        raise TooLargeError("mesh_memory", vertices=vertex_count, needed=needed, limit=limit)


def match_memory_estimate(count: int, other_count: int, settings: Settings) -> float:
    """Estimate the peak memory of a match, both forms included.

    `count, other_count`: numbers of vertices; `settings`: the options of the forms.

    Examples
    --------
    >>> f"{match_memory_estimate(100_000, 100_000, Settings()):.2f} GB"
    '0.22 GB'
    """
    return memory_estimate(max(count, other_count), settings) + _MATCH * (count + other_count)


def match_time_estimate(count: int, other_count: int, settings: Settings) -> float:
    """Estimate how long a match takes on a machine of 2020 or later, both forms included, within a factor of two.

    `count, other_count`: numbers of vertices; `settings`: the options of the forms.

    Examples
    --------
    >>> f"{match_time_estimate(10_000, 10_000, Settings()):.1f} s"
    '5.2 s'
    """
    base, each = _MATCH_SECONDS
    return time_estimate(count, settings) + time_estimate(other_count, settings) + base + each * count


def require_match_memory(count: int, other_count: int, settings: Settings) -> None:
    """Raise an error if two meshes are too large to be matched within the memory limit.

    `count, other_count`: numbers of vertices; `settings`: the options of the forms.

    Examples
    --------
    >>> require_match_memory(10_000, 10_000, Settings(memory_limit=1.0))
    """
    needed = match_memory_estimate(count, other_count, settings)
    if not _grows_squared(settings) and needed > memory_limit(settings.memory_limit):
        limit = limit_in_words(settings.memory_limit)
        raise TooLargeError("mesh_memory", vertices=count + other_count, needed=needed, limit=limit)


def _grows_squared(settings: Settings) -> bool:
    """Check whether a run keeps all pairs of vertices, of each patch or of the mesh."""
    method = method_named(settings.method)
    return method.pairs != "landmarks" and method.settings(settings).whole
