"""The crowd: pieces too many or too small to be compared with all others, each of which rides on what lies nearest."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..numerics.arrays import FloatArray, IntArray
from ..run.monitor import Monitor
from .contacts import Contact, Samples, cloud, neighbourhoods
from .pieces import MEASURED, Piece
from .roles import TOUCH

_STRAY = 1e-3  # area of a group over the largest group's, below which it has no form of its own
_BESIDE = 1e-9  # weight of mere nearness, where a piece touches nothing
_AT_ONCE = 500  # pieces whose samples are searched in one go


def crowds(pieces: Sequence[Piece]) -> list[tuple[list[Piece], list[Piece]]]:
    """Group the pieces that may belong together, and give each of the others to the nearest group.

    The others are all but the largest of very many pieces, and very small groups far from everything, like the specks
    around a scan.

    `pieces`: the pieces, largest area first.

    Examples
    --------
    >>> triangle = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    >>> sizes = (1, 0, 0), (0.9, 0, 9), (0.01, 0, 3)
    >>> each = [Piece(np.arange(3), s * triangle + [0, y, z], np.array([[0, 1, 2]])) for s, y, z in sizes]
    >>> [(len(group), len(crowd)) for group, crowd in crowds(each)]
    [(1, 1), (1, 0)]
    """
    groups = neighbourhoods(pieces[:MEASURED])
    largest = max(piece.size for group in groups for piece in group)
    areas = [sum((piece.size / largest) ** 2 for piece in group) for group in groups]
    stray = [area < _STRAY * max(areas) for area in areas]
    crowd = [piece for group, off in zip(groups, stray, strict=True) if off for piece in group]
    kept = [group for group, off in zip(groups, stray, strict=True) if not off]
    return list(zip(kept, _of_nearest(kept, [*crowd, *pieces[MEASURED:]]), strict=True))


def crowd_contacts(crowd: Sequence[Samples], others: Sequence[Samples], monitor: Monitor) -> list[tuple[int, Contact]]:
    """Find what each piece of a crowd lies on most, and its distances from that.

    `crowd`: samples of each, on the mesh scaled to unit area; `others`: samples of the pieces that can carry them.

    Examples
    --------
    >>> from addon.core.assembly.contacts import sampled
    >>> triangle, faces = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]])
    >>> below, above, small = (sampled(triangle * s + [0, 0, z], faces) for s, z in ((1, 0), (1, 9), (0.1, 8.8)))
    >>> [(carrier, contact)] = crowd_contacts([small], [below, above], Monitor())
    >>> carrier, round(contact.gap, 3)
    (1, 0.2)
    """
    if not crowd:
        return []
    from scipy.spatial import KDTree

    trees = [KDTree(each.points) for each in others]
    whole = KDTree(np.concatenate([each.points for each in others]))
    number = np.repeat(np.arange(len(others)), [len(each.points) for each in others])
    found = []
    for start in range(0, len(crowd), _AT_ONCE):
        monitor.check()
        some = crowd[start : start + _AT_ONCE]
        distance, at = whole.query(np.concatenate([each.points for each in some]))
        ends = np.cumsum([len(each.points) for each in some])[:-1]
        for each, near, on in zip(some, np.split(distance, ends), np.split(number[at], ends), strict=True):
            carrier = _carrier(near, on)
            found.append((carrier, Contact(*trees[carrier].query(each.points))))
    return found


def _carrier(distance: FloatArray, on: IntArray) -> int:
    """Choose, among the pieces nearest to some samples, the one on which most of them lie."""
    hold = np.exp(-((distance / TOUCH) ** 2)) + _BESIDE / (distance + _BESIDE)
    return int(np.argmax(np.bincount(on, hold)))


def _of_nearest(groups: Sequence[Sequence[Piece]], crowd: Sequence[Piece]) -> list[list[Piece]]:
    """Divide the crowd among groups of pieces: each goes with the nearest."""
    if len(groups) == 1 or not crowd:
        return [list(crowd) if number == 0 else [] for number in range(len(groups))]
    from scipy.spatial import KDTree

    points = np.concatenate([piece.points for piece in crowd])
    unit = max(np.abs(each).max() for each in (points, *(piece.points for group in groups for piece in group)))
    clouds = [np.concatenate([cloud(piece, unit) for piece in group]) for group in groups]
    number = np.repeat(np.arange(len(groups)), list(map(len, clouds)))
    distance, at = KDTree(np.concatenate(clouds)).query(points / unit)
    ends = np.cumsum([len(piece.points) for piece in crowd])[:-1]
    found: list[list[Piece]] = [[] for _ in groups]
    for piece, far, on in zip(crowd, np.split(distance, ends), np.split(number[at], ends), strict=True):
        found[on[far.argmin()]].append(piece)
    return found
