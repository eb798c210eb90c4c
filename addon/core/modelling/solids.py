"""Round cones and ellipsoids, and their smooth union on a grid."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..numerics.arrays import FloatArray

Point = tuple[float, float, float]

_REACH = 6.0  # blends beyond which a solid has no effect
_DEEP = 8.0  # blends below a surface to which the depth is limited: the exponential stays small


class RoundCone(NamedTuple):
    """The hull of two balls.

    Attributes
    ----------
    start, end : (float, float, float)
        Their centres.
    first, last : float
        Their radii.
    """

    start: Point
    end: Point
    first: float
    last: float

    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Find the smallest box around the cone. Gives low, high (3,)."""
        wide = max(self.first, self.last)
        return np.minimum(self.start, self.end) - wide, np.maximum(self.start, self.end) + wide

    def distance(self, points: FloatArray) -> FloatArray:
        """Measure the distance of points from the surface; approximate if the radii differ.

        `points` (..., 3); gives (...).

        Examples
        --------
        >>> RoundCone((0, 0, 0), (0, 0, 2), 0.5, 0.5).distance(np.array([[1.0, 0, 1], [0, 0, 3]])).tolist()
        [0.5, 0.5]
        """
        start, way = np.array(self.start, dtype=float), np.subtract(self.end, self.start)
        share = np.clip((points - start) @ way / (way @ way), 0.0, 1.0)
        radius = self.first + share * (self.last - self.first)
        away: FloatArray = np.linalg.norm(points - start - share[..., None] * way, axis=-1)
        return away - radius


class Ellipsoid(NamedTuple):
    """An axis-aligned ellipsoid.

    Attributes
    ----------
    centre : (float, float, float)
        Its centre.
    radii : (float, float, float)
        Its semi-axes.
    """

    centre: Point
    radii: Point

    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Find the smallest box around the ellipsoid. Gives low, high (3,)."""
        return np.subtract(self.centre, self.radii), np.add(self.centre, self.radii)

    def distance(self, points: FloatArray) -> FloatArray:
        """Measure the distance of points from the surface, to first order.

        `points` (..., 3); gives (...).

        Examples
        --------
        >>> Ellipsoid((0, 0, 0), (2, 2, 2)).distance(np.array([[3.0, 0, 0]])).tolist()
        [1.0]
        """
        radii = np.array(self.radii)
        scaled = (points - np.array(self.centre)) / radii
        level, slope = np.linalg.norm(scaled, axis=-1), np.linalg.norm(scaled / radii, axis=-1)
        away: FloatArray = level * (level - 1) / np.maximum(slope, np.finfo(float).tiny)
        return away


def smooth_union(solids: Sequence[RoundCone | Ellipsoid], axes: Sequence[FloatArray], blend: float) -> FloatArray:
    """Blend solids into one on a grid: the smooth minimum of their distances.

    `solids`: the solids; `axes`: coordinates of the grid, ascending; `blend`: width over which surfaces are blended;
    gives (k, k', k'').

    Examples
    --------
    >>> axis = np.linspace(-2, 2, 5)
    >>> field = smooth_union([Ellipsoid((0, 0, 0), (1.5, 1.5, 1.5))], (axis, axis, axis), 0.5)
    >>> field[2, 2, [3, 4]].round(6).tolist()
    [-1.0, 1.0]
    """
    total = np.zeros(tuple(map(len, axes)))
    for solid in solids:
        low, high = solid.bounds()
        near = tuple(
            slice(*np.searchsorted(axis, (begin - _REACH * blend, end + _REACH * blend)))
            for axis, begin, end in zip(axes, low, high, strict=True)
        )
        points = np.stack(
            np.meshgrid(*(axis[part] for axis, part in zip(axes, near, strict=True)), indexing="ij"), axis=-1
        )
        total[near] += np.exp(-np.maximum(solid.distance(points) / blend, -_DEEP))
    return -np.log(np.maximum(total, np.finfo(float).tiny))
