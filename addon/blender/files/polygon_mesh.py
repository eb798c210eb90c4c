"""A mesh with what .obj, .ply and .off files hold of it, as arrays."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ...core.numerics.arrays import FloatArray, IntArray

Polygons = list[list[int]]


class PolygonMesh(NamedTuple):
    """A mesh as it was read, or as it is written; every kind of file holds some of this.

    Attributes
    ----------
    vertices : (n, 3) ndarray of float
        Positions.
    polygons : list of list of int
        Corners of each polygon.
    patches : (n,) ndarray of int or None
        Patch of each vertex; -1 for none.
    colours : (n, 4) ndarray of float or None
        Linear colour of each vertex.
    corner_uv : (c, 2) ndarray or None
        UV coordinates of the corners of all polygons, in their order.
    materials : sequence of str
        Names of the materials by slot; empty for an empty slot.
    slots : sequence of int
        Slot of each polygon; empty if there are no materials.
    library : str
        Name of the .mtl file with the materials; empty if there is none.
    """

    vertices: FloatArray
    polygons: Polygons
    patches: IntArray | None = None
    colours: FloatArray | None = None
    corner_uv: np.ndarray | None = None
    materials: Sequence[str] = ()
    slots: Sequence[int] = ()
    library: str = ""


def fans(polygons: Polygons) -> IntArray:
    """Triangulate polygons as fans around their first corners.

    Examples
    --------
    >>> fans([[0, 1, 2, 3], [3, 2, 4]]).tolist()
    [[0, 1, 2], [0, 2, 3], [3, 2, 4]]
    """
    corners = [[each[0], one, two] for each in polygons for one, two in pairwise(each[1:])]
    return np.array(corners, dtype=np.int64).reshape(-1, 3)


def coordinates(points: FloatArray) -> list[str]:
    """Format coordinates as text.

    Examples
    --------
    >>> coordinates(np.array([[0.0, 1 / 3]]))
    ['0 0.333333333']
    """
    return [" ".join(f"{value:.9g}" for value in point) for point in points.tolist()]


def counted(polygons: Polygons) -> list[str]:
    """Format polygons as text, each with its number of corners first.

    Examples
    --------
    >>> counted([[0, 1, 2]])
    ['3 0 1 2']
    """
    return [f"{len(each)} " + " ".join(map(str, each)) for each in polygons]
