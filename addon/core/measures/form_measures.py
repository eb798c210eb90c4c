"""Measures of a canonical form: compactness, Hausdorff distance and edge stretch."""

from __future__ import annotations

import numpy as np

from ..mesh.connectivity import is_closed, vertex_pairs
from ..mesh.geometry import signed_volume, surface_area
from ..numerics.arrays import FloatArray, IntArray
from .alignment import closest_point_fit


def enclosed_volume(vertices: FloatArray, faces: IntArray) -> float:
    """Compute the signed volume inside a closed mesh.

    Parameters
    ----------
    vertices : (n, 3) ndarray of float
        Vertex positions.
    faces : (m, 3) ndarray of int
        Triangles, counter-clockwise seen from outside for a positive volume.

    Returns
    -------
    float
        Volume; nan if the mesh is not closed, every edge between exactly two triangles.
    """
    return signed_volume(vertices, faces) if is_closed(faces) else float("nan")


def compactness(vertices: FloatArray, faces: IntArray) -> float:
    """Compute ``C = V² / A³``, which no rigid motion or scale changes (a sphere has 1/36π = 88.4e-4).

    Parameters
    ----------
    vertices : (n, 3) ndarray of float
        Vertex positions.
    faces : (m, 3) ndarray of int
        Triangles.

    Returns
    -------
    float
        C, without unit; nan if the mesh is not closed.
    """
    return enclosed_volume(vertices, faces) ** 2 / surface_area(vertices, faces) ** 3


def compactness_error(before: FloatArray, after: FloatArray, faces: IntArray) -> float:
    """Compute ``|C(after) - C(before)|``; tables usually print it times 10⁴.

    Parameters
    ----------
    before, after : (n, 3) ndarray of float
        Vertex positions of the input and of its form.
    faces : (m, 3) ndarray of int
        Triangles of both.

    Returns
    -------
    float
        The error; nan if the mesh is not closed. Returning the input scores 0: never quote it alone.
    """
    return abs(compactness(after, faces) - compactness(before, faces))


def edge_stretch(before: FloatArray, after: FloatArray, faces: IntArray) -> FloatArray:
    """Compute how much longer every edge has become.

    Parameters
    ----------
    before, after : (n, 3) ndarray of float
        Vertex positions.
    faces : (m, 3) ndarray of int
        Triangles of both.

    Returns
    -------
    (e,) ndarray of float
        Length after over length before, in the order of `vertex_pairs`; edges of no length before are left out.
    """
    i, j = vertex_pairs(faces).T
    old = np.linalg.norm(before[i] - before[j], axis=1)
    new = np.linalg.norm(after[i] - after[j], axis=1)
    return new[old > 0] / old[old > 0]


def hausdorff(first: FloatArray, second: FloatArray, mirror: bool = False) -> float:
    """Compute the symmetric Hausdorff distance of two vertex sets after rigid alignment (multi-start ICP).

    Parameters
    ----------
    first, second : (p, 3) and (q, 3) ndarray of float
        Vertices of two shapes.
    mirror : bool
        Whether a mirror image may be used in the alignment.

    Returns
    -------
    float
        The largest distance from a vertex of one to the nearest vertex of the other, in the unit of the vertices.
    """
    from scipy.spatial import KDTree

    rotation, shift = closest_point_fit(first, second, mirror=mirror)
    moved = first @ rotation + shift
    return float(max(KDTree(second).query(moved)[0].max(), KDTree(moved).query(second)[0].max()))


def summary(before: FloatArray, after: FloatArray, faces: IntArray, with_hausdorff: bool = True) -> dict[str, float]:
    """Collect the measures of a form in one table, in units that do not depend on the mesh's scale.

    Parameters
    ----------
    before, after : (n, 3) ndarray of float
        Vertex positions of the input and of its form.
    faces : (m, 3) ndarray of int
        Triangles of both.
    with_hausdorff : bool
        Whether the Hausdorff distance is measured too, which takes longer than all else.

    Returns
    -------
    dict of str to float
        ``compactness`` of the input, ``compactness_error`` (both nan for an open mesh), ``hausdorff`` in units of
        sqrt(area), and the median and 95th percentile of the edge distortion ``|stretch - 1|``.
    """
    distortion = np.abs(edge_stretch(before, after, faces) - 1)
    measured = {"compactness": compactness(before, faces), "compactness_error": compactness_error(before, after, faces)}
    if with_hausdorff:
        measured["hausdorff"] = hausdorff(after, before) / float(np.sqrt(surface_area(before, faces)))
    measured["edge_distortion_median"] = float(np.median(distortion))
    measured["edge_distortion_95"] = float(np.quantile(distortion, 0.95))
    return measured
