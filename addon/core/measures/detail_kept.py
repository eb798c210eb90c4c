"""Measures of the surface detail that a form keeps, none of which the method enforces by construction."""

from __future__ import annotations

import numpy as np

from ..mesh.edges import edge_table
from ..mesh.geometry import area_vectors, vertex_normals
from ..numerics.arrays import FloatArray, IntArray
from ..run.monitor import Monitor
from .crossings import crossings
from .form_measures import edge_stretch

_STEPS = 60  # of shrinking at most; a ball takes 4 to 8
_SAME = 1e-9  # relative change of a diameter at which a ball has converged
_JAG = np.radians(45.0)  # change of a fold that counts as a jag
_MANY = 20_000  # maximum number of vertices whose thickness is measured, evenly chosen
_HIGH, _HIGHEST = 0.95, 0.999  # quantiles


def area_distortion(before: FloatArray, after: FloatArray, faces: IntArray) -> FloatArray:
    """Compute the relative change of the area of every triangle.

    `before, after` (n, 3); `faces` (m, 3); gives (t,).

    Examples
    --------
    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    >>> area_distortion(points, 2 * points, np.array([[0, 1, 2]])).tolist()
    [3.0]
    """
    old, new = (np.linalg.norm(area_vectors(points, faces), axis=1) for points in (before, after))
    return np.abs(new[old > 0] / old[old > 0] - 1)


def thickness(
    vertices: FloatArray, faces: IntArray, some: IntArray | None = None, monitor: Monitor | None = None
) -> FloatArray:
    """Measure the thickness of a body at its vertices, by shrinking balls.

    The ball touches the surface at a vertex, from inside, and is the largest that contains no other vertex: it starts
    as large as the body and shrinks to the vertex nearest to its centre until none is nearer than its radius.

    `vertices` (n, 3); `faces` (m, 3); `some` (q,); gives (q,).

    References
    ----------
    Ma, Bae and Choi, "3D medial axis point approximation using nearest neighbors and the normal field", The Visual
    Computer 28 (2012), doi:10.1007/s00371-011-0594-7.

    Examples
    --------
    >>> octahedron = np.concatenate([np.eye(3), -np.eye(3)])
    >>> faces = np.array([[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]])
    >>> thickness(octahedron, faces).round(6).tolist()
    [2.0, 2.0, 2.0, 2.0, 2.0, 2.0]
    """
    from scipy.spatial import KDTree

    monitor = monitor or Monitor()
    some = np.arange(len(vertices)) if some is None else some
    tree = KDTree(vertices)
    points, inward = vertices[some], -vertex_normals(vertices, faces)[some]  # p, -n
    diameter = np.full(len(some), 2 * float(np.linalg.norm(np.ptp(vertices, axis=0))))
    diameter[~inward.any(axis=1)] = np.nan
    open_ones = np.flatnonzero(np.isfinite(diameter))
    for _ in range(_STEPS):
        if not len(open_ones):
            break
        monitor.check()
        p, n = points[open_ones], inward[open_ones]
        radius = diameter[open_ones] / 2
        nearest = tree.query(p + radius[:, None] * n)[1]  # the vertex nearest to the centre
        away = vertices[nearest] - p
        across = np.einsum("ij,ij->i", away, n)
        touching = np.full(len(open_ones), np.inf)  # the diameter of the ball that touches at p and goes through it
        np.divide(np.einsum("ij,ij->i", away, away), across, out=touching, where=across > 0)
        smaller = touching < diameter[open_ones] * (1 - _SAME)
        open_ones = open_ones[smaller]
        diameter[open_ones] = touching[smaller]
    return diameter


def neighbouring_triangles(faces: IntArray) -> IntArray:
    """List the pairs of triangles that share an edge with no other triangle.

    `faces` (m, 3); gives (e, 2).

    Examples
    --------
    >>> neighbouring_triangles(np.array([[0, 1, 2], [2, 1, 3]])).tolist()
    [[0, 1]]
    """
    edges = edge_table(faces)
    first = edges.start[edges.count == 2]
    return np.column_stack([edges.order[first], edges.order[first + 1]]) // 3


def fold_changes(before: FloatArray, after: FloatArray, faces: IntArray, pairs: IntArray) -> FloatArray:
    """Compute the change of the angles between neighbouring triangles.

    `before, after` (n, 3); `faces` (m, 3); `pairs` (e, 2); gives (e,).

    Examples
    --------
    >>> flat = np.array([[0.0, 0, 0], [0, 1, 0], [-1, 0, 0], [1, 0, 0]])
    >>> faces, folded = np.array([[0, 1, 2], [1, 0, 3]]), flat + [[0, 0, 0], [0, 0, 0], [0, 0, 0], [-1, 0, 1]]
    >>> np.degrees(fold_changes(flat, folded, faces, neighbouring_triangles(faces))).round(6).tolist()
    [90.0]
    """
    turn = _folds(after, faces, pairs) - _folds(before, faces, pairs)
    return np.abs((turn + np.pi) % (2 * np.pi) - np.pi)


def _folds(points: FloatArray, faces: IntArray, pairs: IntArray) -> FloatArray:
    """Compute the signed angle between the normals of neighbouring triangles, positive in a valley."""
    one, two = area_vectors(points, faces)[pairs.T]  # (e, 3) each
    across = (points[faces[pairs[:, 1]]] - points[faces[pairs[:, 0]]]).sum(axis=1)  # three times from centre to centre
    sine = np.linalg.norm(np.cross(one, two), axis=1)
    return np.asarray(np.arctan2(sine, np.einsum("ij,ij->i", one, two)) * np.sign(np.einsum("ij,ij->i", one, across)))


def detail_measures(
    before: FloatArray, after: FloatArray, faces: IntArray, patches: IntArray | None = None
) -> dict[str, float]:
    """Collect the measures of detail that a form keeps, in units independent of its size.

    `before, after` (n, 3); `faces` (m, 3); `patches` (n,).
    """
    stretch = np.abs(edge_stretch(before, after, faces) - 1)
    area = area_distortion(before, after, faces)
    some = np.unique(np.linspace(0, len(before) - 1, min(_MANY, len(before))).round().astype(np.int64))
    old, new = (thickness(points, faces, some) for points in (before, after))
    thinner = np.abs(new / old - 1)
    thinner = thinner[np.isfinite(thinner)]
    crossed = len(crossings(after, faces)) - len(crossings(before, faces))
    pairs = neighbouring_triangles(faces)
    jagged = fold_changes(before, after, faces, pairs) > _JAG
    borders = np.zeros(0, dtype=bool)
    if patches is not None:
        between = (patches[faces] != patches[faces[:, :1]]).any(axis=1)  # (m,) triangles of several patches
        borders = jagged[between[pairs].any(axis=1)]
    return {
        "edge_distortion_999": float(np.quantile(stretch, _HIGHEST)),
        "area_distortion_median": float(np.median(area)),
        "area_distortion_95": float(np.quantile(area, _HIGH)),
        "thickness_median": float(np.median(thinner)) if len(thinner) else float("nan"),
        "thickness_95": float(np.quantile(thinner, _HIGH)) if len(thinner) else float("nan"),
        "crossings_added": max(crossed, 0) / len(faces),
        "jags": float(jagged.mean()) if len(jagged) else float("nan"),
        "border_jags": float(borders.mean()) if len(borders) else float("nan"),
    }
