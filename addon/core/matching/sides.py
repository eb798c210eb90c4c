"""Matches of two surfaces that differ in left and right, or front and back, with their scores."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..measures.alignment import rigid_fit
from ..mesh.far_points import far_points
from ..numerics.arrays import FloatArray, IntArray
from ..run.errors import InvalidSettingsError
from ..run.monitor import Monitor
from .spectral_map import first_map, refined
from .starts import Start, starts
from .strain import fit_strain
from .unfolded import Unfolded

_SAMPLES = 500  # vertices on which the matches are compared
_COUNTS = (20, 35, 50)  # eigenfunctions, round by round
_NEAR, _FACING = 0.6, 0.05  # weights of positions on the form and of normals
_SIGNATURE, _CURVATURE = 2.0, 2.0  # weights relative to the logarithm of the remaining distance
_RIVALS = 0.5  # difference of scores up to which sides are compared by their strain,
_MOST = 3  # their maximum number
_SAME = 0.15  # sqrt(area): mean distance between two maps below which they are of one side


class Side(NamedTuple):
    """A possible match of two surfaces.

    Attributes
    ----------
    score : float
        How well it fits, without unit; lower is better. Poses of a body reach -4 to -6, dissimilar bodies hardly -3.
    start : Start
        The alignment of the forms, and the corresponding feature points.
    strain : float
        By how much it changes lengths on the form, as in `fit_strain`; nan if its score decided.
    """

    score: float
    start: Start
    strain: float = float("nan")


def require_side(side: str | int) -> None:
    """Require that a side is asked for as "auto" or by its index.

    Examples
    --------
    >>> require_side("auto")
    """
    if side != "auto" and (isinstance(side, bool) or not isinstance(side, int | np.integer) or side < 0):
        raise InvalidSettingsError("match_side", value=side)


def index_of_side(side: str | int, count: int) -> int:
    """Return the index of the side that is asked for, 0 for the likeliest. `count`: how many there are.

    Examples
    --------
    >>> index_of_side("auto", 2), index_of_side(1, 2)
    (0, 1)
    """
    index = 0 if side == "auto" else int(side)
    if index >= count:
        raise InvalidSettingsError("match_no_side", count=count, last=count - 1)
    return index


def sides(one: Unfolded, other: Unfolded, monitor: Monitor) -> list[Side]:
    """Find the possible matches of two surfaces that differ in left and right, or front and back.

    Each start is refined on a sample. Its score is the logarithm of the remaining distance between the forms, plus
    twice the change of the wave kernel signature, minus twice the correlation of smoothed mean curvature of the poses:
    of these, curvature distinguishes front from back best. Between bodies of different make it hardly does, so matches
    with close scores are fitted, and the one that strains the form least comes first: a body turned back to front has
    to twist feet, hands and face.

    `one, other`: the surfaces.

    Examples
    --------
    >>> from addon.core.matching.unfolded import unfolded
    >>> from addon.core.method_api.settings import Settings
    >>> from addon.core.method_api.surface_features import detected
    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]])
    >>> found = detected(points, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]), None, Settings(), Monitor())
    >>> body = unfolded(found, found.whole_points, Monitor())
    >>> sides(body, body, Monitor())[0].score < -4
    True
    """
    return _by_strain(one, other, scored_sides(one, other, monitor), monitor)


def scored_sides(one: Unfolded, other: Unfolded, monitor: Monitor) -> list[Side]:
    """Find the possible matches as `sides` does, by their scores alone.

    `one, other`: the surfaces.
    """
    rows = np.sort(far_points(one.form, _SAMPLES))
    tried: list[tuple[float, Start, FloatArray]] = []
    ways = starts(one, other, rows, monitor)
    for number, start in enumerate(ways, start=1):
        first = first_map(one, other, start, monitor, rows=rows)
        partner = refined(one, other, first, _COUNTS, _NEAR, monitor, facing=_FACING, rows=rows)
        tried.append((_score(one, other, rows, partner), start, other.form[partner]))
        monitor.tick(number / (len(ways) + _MOST))
    found: list[tuple[Side, FloatArray]] = []
    for score, start, places in sorted(tried, key=lambda each: each[0]):
        if all(np.linalg.norm(places - known, axis=1).mean() > _SAME for _, known in found):
            found.append((Side(score, start), places))
    return [side for side, _ in found]


def _by_strain(one: Unfolded, other: Unfolded, found: list[Side], monitor: Monitor) -> list[Side]:
    """Sort the matches with scores close to the best by their strain."""
    count = sum(side.score - found[0].score < _RIVALS for side in found[:_MOST])
    if count > 1:
        rivals = [side._replace(strain=fit_strain(one, other, side.start, monitor)) for side in found[:count]]
        found = sorted(rivals, key=lambda side: side.strain) + found[count:]
    monitor.tick(1.0)
    return found


def _score(one: Unfolded, other: Unfolded, rows: IntArray, partner: IntArray) -> float:
    """Compute the score of a map."""
    rotation, shift = rigid_fit(one.form[rows], other.form[partner])
    left = ((one.form[rows] @ rotation + shift - other.form[partner]) ** 2).sum(axis=1).mean()
    changed = ((one.signature[rows] - other.signature[partner]) ** 2).sum(axis=1).mean()
    pairs = zip(one.curvature[rows].T, other.curvature[partner].T, strict=True)
    alike = np.mean([_correlation(*pair) for pair in pairs])
    tiny = np.finfo(float).tiny
    return float(np.log(left + tiny) / 2 + _SIGNATURE * np.sqrt(changed) - _CURVATURE * alike)


def _correlation(one: FloatArray, two: FloatArray) -> float:
    """Correlate two functions; 0 where one is constant."""
    one, two = one - one.mean(), two - two.mean()
    size = np.sqrt((one**2).sum() * (two**2).sum())
    return float(one @ two / size) if size > 0 else 0.0
