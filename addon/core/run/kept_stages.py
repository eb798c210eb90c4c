"""Results of the stages of a run, kept for the next run on the same mesh, which recomputes only what changed."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from hashlib import blake2b
from types import MethodType
from typing import Any, NamedTuple, TypeVar, cast

import numpy as np

from .messages import Message

Found = TypeVar("Found")

_MOST = 3  # results kept per stage: an option that is dragged back and forth returns to earlier values
_PLAIN = (str, bool, int, float, tuple, type(None), MethodType)  # compared by exact type: named tuples hold results


class _Stage(NamedTuple):
    """The result of a stage, its sources and its warnings."""

    sources: list[Any]
    found: Any
    warnings: list[Message]


class KeptStages:
    """Results of the stages of earlier runs, valid as long as their sources stay the same.

    Pass one object to successive runs. A stage is recomputed if the mesh, its options or the result of an earlier stage
    has changed. The last few results of each stage are kept. They must not hold the monitor of their run, which may
    have been cancelled since.

    Examples
    --------
    >>> kept = KeptStages()
    >>> def squared():
    ...     print("computed")
    ...     return [9.0]
    >>> kept.take("Square", [3.0], squared, [])
    computed
    [9.0]
    >>> kept.take("Square", [3.0], squared, [])
    [9.0]
    """

    def __init__(self) -> None:
        self._stages: dict[str, list[_Stage]] = {}  # the latest first
        self._parts: dict[Hashable, KeptStages] = {}
        self._full = False

    def part(self, name: Hashable) -> KeptStages:
        """Return the results kept for a part of the work, such as a body. `name`: identifies the part."""
        if name not in self._parts:
            self._parts[name] = KeptStages()
            self._parts[name]._full = self._full
        return self._parts[name]

    def fill(self) -> None:
        """Keep no more: what is there is still returned, as where one run needs it twice."""
        self._full = True
        for part in self._parts.values():
            part.fill()

    def take(self, name: str, sources: list[Any], compute: Callable[[], Found], warnings: list[Message]) -> Found:
        """Return the kept result of a stage, or compute it.

        `name`: name of the stage; `sources`: all that its result depends on: arrays, lists, numbers and strings,
        compared by value; methods, by the object they are bound to; and results of earlier stages, compared by
        identity; `compute`: computes it; `warnings`: warnings so far.
        """
        told = [_told(source) for source in sources]
        known = self._stages.setdefault(name, [])
        kept = next((stage for stage in known if _alike(stage.sources, told)), None)
        if kept is None:
            before = len(warnings)
            found = compute()
            if self._full:
                return found
            kept = _Stage(told, found, warnings[before:])
        self._stages[name] = [kept, *(stage for stage in known if stage is not kept)][:_MOST]
        warnings += [each for each in kept.warnings if each not in warnings]
        return cast("Found", kept.found)


def _told(source: Any) -> Any:
    """Identify arrays and lists by their content: they may be changed in place between two runs."""
    if isinstance(source, list) or type(source) is tuple:
        return repr(source)
    if not hasattr(source, "__array__"):
        return source
    source = np.asarray(source)
    return (source.shape, source.dtype.str, blake2b(np.ascontiguousarray(source).data, digest_size=16).digest())


def _alike(sources: list[Any], others: list[Any]) -> bool:
    """Compare plain values by value, others by identity."""
    return all(
        one is other or (type(one) is type(other) and type(one) in _PLAIN and one == other)
        for one, other in zip(sources, others, strict=True)
    )
