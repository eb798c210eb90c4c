"""A mesh with what .obj, .ply and .off files hold of it, as arrays."""

from __future__ import annotations

import codecs
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

    def turned_over(self) -> PolygonMesh:
        """Return the mesh with the corners of every polygon in the other order.

        Examples
        --------
        >>> PolygonMesh(np.eye(3), [[0, 1, 2]], corner_uv=np.array([[0, 0], [1, 0], [1, 1]])).turned_over()[1:]
        ([[2, 1, 0]], None, None, array([[1, 1],
               [1, 0],
               [0, 0]]), (), (), '')
        """
        ends = np.cumsum([0, *map(len, self.polygons)]).tolist()
        corners = [corner for start, end in pairwise(ends) for corner in range(end - 1, start - 1, -1)]
        uv = None if self.corner_uv is None else self.corner_uv[corners]
        return self._replace(polygons=[each[::-1] for each in self.polygons], corner_uv=uv)


def decoded_text(data: bytes) -> str:
    r"""Decode the text of a mesh file: UTF-8 or UTF-16 as their byte-order marks say, otherwise UTF-8.

    Examples
    --------
    >>> decoded_text("v 1 2 3".encode("utf-16")), decoded_text(b"\xef\xbb\xbfv 1 2 3")
    ('v 1 2 3', 'v 1 2 3')
    """
    if data[:2] in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE):
        return data.decode("utf-16", errors="replace").lstrip("\ufeff")
    return data.decode("utf-8-sig", errors="replace")


def encoded(linear: np.ndarray) -> FloatArray:
    """Encode linear colours, 0 to 1, as sRGB.

    Examples
    --------
    >>> encoded(np.array([0.0, 0.0031308, 1.0])).round(4).tolist()
    [0.0, 0.0404, 1.0]
    """
    low = np.clip(linear, 0, 1).astype(np.float64)
    return np.where(low <= 0.0031308, 12.92 * low, 1.055 * low ** (1 / 2.4) - 0.055)


def decoded(colours: np.ndarray) -> FloatArray:
    """Decode sRGB colours, 0 to 1, to linear ones with an alpha of 1; `colours` (n, 3) gives (n, 4).

    Examples
    --------
    >>> decoded(np.array([[0.0, 0.0404, 1.0]])).round(4).tolist()
    [[0.0, 0.0031, 1.0, 1.0]]
    """
    given = np.clip(colours, 0, 1).astype(np.float64)
    linear = np.where(given <= 0.04045, given / 12.92, ((given + 0.055) / 1.055) ** 2.4)
    return np.column_stack([linear, np.ones(len(linear))])


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
