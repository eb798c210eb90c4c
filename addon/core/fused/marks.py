"""Vertices marked by hand, at which a mesh is parted or stays joined."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..mesh.connectivity import component_labels
from ..mesh.edges import vertex_pairs
from ..method_api.settings import Settings
from ..numerics.arrays import BoolArray, IntArray
from ..run.errors import InvalidSettingsError


class Marks(NamedTuple):
    """Which vertices of a mesh are marked.

    Attributes
    ----------
    part : (n,) ndarray of bool
        Those to part.
    joined : (n,) ndarray of bool
        Those to keep.
    given : bool
        Whether any were given to part.
    whole : bool
        Whether all of a piece were: nothing would be left of it, so none of them is in `part`.
    """

    part: BoolArray
    joined: BoolArray
    given: bool
    whole: bool


def require_marks(settings: Settings, count: int) -> None:
    """Require that marks are vertices of a mesh of `count`.

    Examples
    --------
    >>> require_marks(Settings(part_here=[1]), 2)
    """
    for name in ("part_here", "keep_joined"):
        chosen = getattr(settings, name)
        if chosen is not None and max(chosen) >= count:
            raise InvalidSettingsError("vertex_range", name=name, last=count - 1)


def marks_on(faces: IntArray, representative: IntArray, settings: Settings) -> Marks:
    """Find the vertices that are marked; copies at one place stand for each other.

    `faces` (m, 3): of those that stand for others; `representative` (n,): the vertex that stands for each.

    Examples
    --------
    >>> square = np.array([[0, 1, 2], [0, 2, 3]])
    >>> marks_on(square, np.arange(4), Settings(part_here=[0, 2])).part.tolist()
    [True, False, True, False]
    """

    def here(chosen: Sequence[int] | IntArray | None) -> BoolArray:
        those = np.zeros(len(representative), dtype=bool)
        if chosen is not None:
            those[representative[np.asarray(chosen)]] = True
        return those

    part, used = here(settings.part_here), np.zeros(len(representative), dtype=bool)
    used[faces.ravel()] = True
    piece = component_labels(len(part), vertex_pairs(faces))
    whole = used & ~(np.bincount(piece, used & ~part) > 0)[piece]
    return Marks(part & ~whole, here(settings.keep_joined), settings.part_here is not None, bool(whole.any()))
