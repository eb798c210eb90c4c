"""Measures of a canonical form: compactness, Hausdorff distance and edge stretch."""

from __future__ import annotations

import numpy as np

from ..mesh.connectivity import component_labels
from ..mesh.edges import is_closed, vertex_pairs
from ..mesh.geometry import signed_volume, surface_area
from ..numerics.arrays import FloatArray, IntArray
from .alignment import closest_point_fit


def compactness(vertices: FloatArray, faces: IntArray) -> float:
    """Compute ``C = V² / A³``, invariant to rigid motion and scale (a sphere has 1/36π = 88.4e-4).

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

    Examples
    --------
    >>> points = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    >>> faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
    >>> round(1e4 * compactness(points, faces), 2), round(1e4 * compactness(5 * points, faces), 2)
    (26.73, 26.73)
    """
    return _closed_compactness(vertices, faces) if is_closed(faces) else float("nan")


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

    Examples
    --------
    >>> points = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    >>> faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
    >>> round(compactness_error(points, 2 * points + 1, faces), 6)
    0.0
    """
    return abs(compactness(after, faces) - compactness(before, faces))


def edge_stretch(before: FloatArray, after: FloatArray, faces: IntArray) -> FloatArray:
    """Compute the stretch of every edge.

    Parameters
    ----------
    before, after : (n, 3) ndarray of float
        Vertex positions.
    faces : (m, 3) ndarray of int
        Triangles of both.

    Returns
    -------
    (e,) ndarray of float
        Length after over length before, in the order of `vertex_pairs`; edges of zero length before are left out.

    Examples
    --------
    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    >>> edge_stretch(points, 2 * points, np.array([[0, 1, 2]])).round(6).tolist()
    [2.0, 2.0, 2.0]
    """
    i, j = vertex_pairs(faces).T
    old = np.linalg.norm(before[i] - before[j], axis=1)
    new = np.linalg.norm(after[i] - after[j], axis=1)
    return new[old > 0] / old[old > 0]


def worst_part_distortion(before: FloatArray, after: FloatArray, faces: IntArray, *, least: float = 0.02) -> float:
    """Compute the edge distortion of the connected part of a mesh where it is largest.

    Parameters
    ----------
    before, after : (n, 3) ndarray of float
        Vertex positions.
    faces : (m, 3) ndarray of int
        Triangles.
    least : float
        Share of all edges below which a part does not count.

    Returns
    -------
    float
        The 95th percentile of ``|stretch - 1|`` over the edges of that part; 0 if there are no edges.

    Examples
    --------
    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    >>> two = np.concatenate([points, points + 5])
    >>> round(worst_part_distortion(two, np.concatenate([points, 1.5 * points]), np.arange(6).reshape(2, 3)), 6)
    0.5
    """
    pairs = vertex_pairs(faces)
    apart = np.linalg.norm(before[pairs[:, 0]] - before[pairs[:, 1]], axis=1)
    part = component_labels(len(before), pairs)[pairs[apart > 0, 0]]
    distortion = np.abs(edge_stretch(before, after, faces) - 1)
    count = np.bincount(part, minlength=1)
    return max(
        (float(np.quantile(distortion[part == p], 0.95)) for p in np.flatnonzero(count > least * len(part))),
        default=0.0,
    )


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

    Examples
    --------
    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 4]])
    >>> round(hausdorff(points, points + 5), 6)
    0.0
    """
    from scipy.spatial import KDTree

    rotation, shift = closest_point_fit(first, second, mirror=mirror)
    moved = first @ rotation + shift
    return float(max(KDTree(second).query(moved)[0].max(), KDTree(moved).query(second)[0].max()))


def summary(before: FloatArray, after: FloatArray, faces: IntArray, with_hausdorff: bool = True) -> dict[str, float]:
    """Collect the measures of a form, in units independent of the mesh's scale.

    Parameters
    ----------
    before, after : (n, 3) ndarray of float
        Vertex positions of the input and of its form.
    faces : (m, 3) ndarray of int
        Triangles of both.
    with_hausdorff : bool
        Whether the Hausdorff distance is measured too, which takes longer than the rest.

    Returns
    -------
    dict of str to float
        ``compactness`` of the input, ``compactness_error`` (both nan for an open mesh), ``hausdorff`` in units of
        sqrt(area), and the median and 95th percentile of the edge distortion ``|stretch - 1|``.

    Examples
    --------
    >>> points = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    >>> faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
    >>> measured = summary(points, 1.25 * points, faces, with_hausdorff=False)
    >>> round(measured["compactness_error"], 6), round(measured["edge_distortion_median"], 6)
    (0.0, 0.25)
    """
    distortion = np.abs(edge_stretch(before, after, faces) - 1)
    measured = dict.fromkeys(["compactness", "compactness_error"], float("nan"))
    if is_closed(faces):
        posed, form = (_closed_compactness(vertices, faces) for vertices in (before, after))
        measured = {"compactness": posed, "compactness_error": abs(form - posed)}
    if with_hausdorff:
        measured["hausdorff"] = hausdorff(after, before) / float(np.sqrt(surface_area(before, faces)))
    measured["edge_distortion_median"] = float(np.median(distortion))
    measured["edge_distortion_95"] = float(np.quantile(distortion, 0.95))
    return measured


def _closed_compactness(vertices: FloatArray, faces: IntArray) -> float:
    """Compute the compactness of a mesh that is known to be closed."""
    return signed_volume(vertices, faces) ** 2 / surface_area(vertices, faces) ** 3
