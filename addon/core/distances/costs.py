"""What distances over a whole surface will cost in memory."""

from __future__ import annotations

from ..run.errors import TooLargeError
from ..run.memory import limit_in_words, memory_limit
from ..run.messages import message
from .kinds import KINDS

_FACTORS = (6.9, 655_362, 1.35)  # gigabytes that the factors of the heat method take at so many vertices, and growth
_CARRIED = (0.05, 0.4e-6)  # gigabytes, and by vertex: the coarse mesh and the way back to all vertices


def distance_memory(vertex_count: int, kind: str, unknowns: int = 0) -> float:
    """Estimate the most memory that distances from some vertices take.

    `vertex_count`: number of vertices of the connected surface; `unknowns`: vertices of the triangles on which the
    heat method solves; those of the surface when left out.

    Examples
    --------
    >>> f"{distance_memory(100_000, 'fast_marching'):.3f} GB"
    '0.125 GB'
    """
    memory = KINDS[kind].memory
    base, each = memory or _CARRIED
    if memory is not None:
        return base + each * vertex_count
    most, at, growth = _FACTORS
    return base + each * vertex_count + most * ((unknowns or vertex_count) / at) ** growth


def require_distance_memory(vertex_count: int, kind: str, *, unknowns: int = 0, limit: float = 0.0) -> None:
    """Raise an error if a surface is too large to measure distances within the memory limit.

    `kind`: likewise; `unknowns`: likewise; `limit`: gigabytes that may be taken; 0 for 60 % of the free memory.

    Examples
    --------
    >>> require_distance_memory(1_000, "heat", limit=1.0)
    >>> try:
    ...     require_distance_memory(10_000_000, "heat", limit=1.0)
    ... except TooLargeError as error:
    ...     print(error.kind)
    distance_memory
    """
    needed, most = distance_memory(vertex_count, kind, unknowns), memory_limit(limit)
    if needed > most:
        other = kind == "heat" and distance_memory(vertex_count, "fast_marching") <= most
        advice = message("advice_fast_marching") if other else message("advice_close")
        raise TooLargeError("distance_memory", needed=needed, limit=limit_in_words(limit), advice=advice)
