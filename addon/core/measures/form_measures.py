"""Measures of a canonical form: compactness, Hausdorff distance and edge stretch."""

from __future__ import annotations

import numpy as np

from ..mesh.edges import is_closed, vertex_pairs
from ..mesh.geometry import signed_volume, surface_area
from ..numerics.arrays import FloatArray, IntArray
from .alignment import closest_point_fit, rigid_fit

_UNBENT = 0.01  # of the root of the area: forms of forms differ from these by .014 and more


def compactness(vertices: FloatArray, faces: IntArray) -> float:
    """Compute ``C = V² / A³``, invariant to rigid motion and scale (a sphere has 1/36π = 88.4e-4).

    `vertices` (n, 3); `faces` (m, 3).
    """
    return _closed_compactness(vertices, faces) if is_closed(faces) else float("nan")


def compactness_error(before: FloatArray, after: FloatArray, faces: IntArray) -> float:
    """Compute ``|C(after) - C(before)|``; tables usually print it times 10⁴.

    `before, after` (n, 3); `faces` (m, 3).
    """
    return abs(compactness(after, faces) - compactness(before, faces))


def edge_stretch(before: FloatArray, after: FloatArray, faces: IntArray) -> FloatArray:
    """Compute the stretch of every edge.

    `before, after` (n, 3); `faces` (m, 3); gives (e,).

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


def median_distortion(before: FloatArray, after: FloatArray, faces: IntArray) -> float:
    """Measure by how much half of the edges of a mesh change their lengths at most, relative to their lengths.

    `before`, `after` (n, 3); `faces` (m, 3).

    Examples
    --------
    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    >>> round(median_distortion(points, 1.25 * points, np.array([[0, 1, 2]])), 6)
    0.25
    """
    return float(np.median(np.abs(edge_stretch(before, after, faces) - 1)))


def hausdorff(first: FloatArray, second: FloatArray, mirror: bool = False) -> float:
    """Compute the symmetric Hausdorff distance of two vertex sets after rigid alignment (multi-start ICP).

    `first, second` (p, 3); `mirror`: whether a mirror image may be used in the alignment.

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


def is_unchanged(before: FloatArray, after: FloatArray, faces: IntArray) -> bool:
    """Check whether a form is the mesh itself but for a rigid motion.

    `before, after` (n, 3); `faces` (m, 3).

    Examples
    --------
    >>> points, faces = np.eye(3), np.array([[0, 1, 2]])
    >>> is_unchanged(points, points[:, [1, 2, 0]] + 3, faces), is_unchanged(points, points**2 * [[1], [2], [3]], faces)
    (True, False)
    """
    used = np.unique(faces)
    rotation, shift = rigid_fit(before[used], after[used])
    apart = float(np.sqrt(((before[used] @ rotation + shift - after[used]) ** 2).sum(axis=1).mean()))
    return apart < _UNBENT * float(np.sqrt(surface_area(before, faces)))


def summary(before: FloatArray, after: FloatArray, faces: IntArray, with_hausdorff: bool = True) -> dict[str, float]:
    """Collect the measures of a form, in units independent of the mesh's scale.

    `before, after` (n, 3); `faces` (m, 3); `with_hausdorff`: whether the Hausdorff distance is measured too, which
    takes longer than the rest.
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
