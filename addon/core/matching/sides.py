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
_FACING_SIDES, _SURE = 0.1, 3.0  # weight of left and right of both surfaces, and how sure they count at most
_RIVALS = 0.5  # difference of costs up to which sides are compared by their strain, too,
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
    facing : float
        How surely left limbs correspond to left ones; below 0 to right ones.
    """

    score: float
    start: Start
    strain: float = float("nan")
    facing: float = 0.0

    @property
    def cost(self) -> float:
        """What speaks against it: score, logarithm of the strain if that is known, and sides that do not agree."""
        strained = 0.0 if np.isnan(self.strain) else float(np.log(max(self.strain, float(np.finfo(float).tiny))))
        return self.score + strained - _FACING_SIDES * self.facing


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
    twice the change of the wave kernel signature, minus twice the correlation of smoothed mean curvature of the poses,
    plus how far ends of limbs land from ends of limbs: upside down, a head lands between two legs. Of these, curvature
    distinguishes front from back best. Between bodies of different make it hardly does, so left and right count as far
    as each surface tells them, by distances and toes. Matches that are close by both are fitted, and how much that
    strains the form is added: a body turned back to front has to twist feet, hands and face.

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
    found = [side._replace(facing=_facing(one, other, side.start)) for side in scored_sides(one, other, monitor)]
    return _by_strain(one, other, sorted(found, key=lambda side: side.cost), monitor)


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
        score = _score(one, other, rows, partner) + _ends_apart(one, other, rows, partner)
        tried.append((score, start, other.form[partner]))
        monitor.tick(number / (len(ways) + _MOST))
    found: list[tuple[Side, FloatArray]] = []
    for score, start, places in sorted(tried, key=lambda each: each[0]):
        if all(np.linalg.norm(places - known, axis=1).mean() > _SAME for _, known in found):
            found.append((Side(score, start), places))
    return [side for side, _ in found]


def _by_strain(one: Unfolded, other: Unfolded, found: list[Side], monitor: Monitor) -> list[Side]:
    """Sort the matches that cost hardly more than the best by their strain, too."""
    count = sum(side.cost - found[0].cost < _RIVALS for side in found[:_MOST])
    if count > 1:
        rivals = [side._replace(strain=fit_strain(one, other, side.start, monitor)) for side in found[:count]]
        found = sorted(rivals, key=lambda side: side.cost) + found[count:]
    monitor.tick(1.0)
    return found


def _facing(one: Unfolded, other: Unfolded, start: Start) -> float:
    """Tell how surely a start maps left limbs to left ones: as sure as the surface is that tells it less."""
    known = np.flatnonzero(start.image >= 0)
    sides = one.limbs.side[known] * other.limbs.side[start.image[known]]
    paired = max(1, int(np.count_nonzero(one.limbs.side[known])))
    sure = min(abs(one.facing), abs(other.facing), _SURE)
    return float(sure * np.sign(one.facing * other.facing) * sides.sum() / paired)


def _ends_apart(one: Unfolded, other: Unfolded, rows: IntArray, partner: IntArray) -> float:
    """Measure how far from ends of limbs those of either surface are mapped, in sqrt(area), on average."""
    if not len(one.features) or not len(other.features):
        return 0.0
    sample = np.linalg.norm(one.form[rows] - one.form[one.features][:, None], axis=2).argmin(axis=1)
    apart = other.limbs.to_features[partner[sample]]  # (k, k')
    return float(apart.min(axis=0).mean() + apart.min(axis=1).mean()) / 2


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
