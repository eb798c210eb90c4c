"""What a mesh as it comes says about its surface: seams closed, spare faces left out, sides agreed upon.

The user's mesh is never changed: this is the surface that the method sees. Every departure from the mesh is told.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..numerics.arrays import FloatArray, IntArray
from ..run.errors import InvalidMeshError
from ..run.monitor import Monitor
from .geometry import checked_arrays, surface_area

_NO_AREA = 1e-12  # squares of half the size; rounding leaves a thousandth of it
_COARSE = 1e-4  # share of the size below which rounding of the positions is not told


@dataclass(frozen=True, eq=False)
class MendedMesh:
    """The surface in a mesh.

    Attributes
    ----------
    vertices : (n, 3) ndarray of float64
        The positions, as given.
    faces : (m', 3) ndarray of int64
        Triangles of three different vertices each, no two alike, turned to agree with their neighbours where they can.
        Of vertices that lie on each other along a seam they name the first.
    stands_for : (n,) ndarray of int64
        The vertex that each vertex is one with: itself, or the first at its place.
    warnings : list of str
        Sentences for the user.
    """

    vertices: FloatArray
    faces: IntArray
    stands_for: IntArray
    warnings: list[str]


def mended(vertices: ArrayLike, faces: ArrayLike, monitor: Monitor | None = None) -> MendedMesh:
    """Find the surface in a mesh.

    Faces that use a vertex twice and copies of faces are left out. Where borders lie exactly on each other, as along
    the seams that many file formats cut, their vertices are taken as one. Faces that look the other way than their
    neighbours are turned over.

    Parameters
    ----------
    vertices : (n, 3) array_like of float
        Vertex positions, any unit of length.
    faces : (m, 3) array_like of int
        Triangles as vertex indices.
    monitor : Monitor, optional
        Asked between the steps whether to stop.

    Returns
    -------
    MendedMesh
        The surface.

    Raises
    ------
    InvalidMeshError
        If a shape is wrong, a coordinate is not finite, an index is out of range, there is no triangle, or the surface
        has no area.
    CancelledError
        If the monitor says so.
    """
    monitor = monitor or Monitor()
    points, triangles = checked_arrays(vertices, faces)
    monitor.check()
    warnings: list[str] = []
    whole = _of_three(triangles)
    if len(whole) < len(triangles):
        warnings.append(
            f"{_faces(len(triangles) - len(whole))} left out: the same vertex twice. Mesh > Clean Up > Degenerate "
            "Dissolve removes such faces."
        )
    given, edges = whole, _edges_of(whole)
    monitor.check()
    stands_for = _sewn(points, whole, edges)
    monitor.check()
    joined = int(np.count_nonzero(stands_for != np.arange(len(points))))
    if joined:
        warnings.append(
            f"Borders lie on each other: {joined:,} vertices were taken as one with others at their place. Mesh > "
            "Merge > By Distance does so for good."
        )
        whole = _of_three(stands_for[whole])
    single = _without_copies(whole)
    monitor.check()
    if len(single) < len(whole):
        warnings.append(
            f"{_faces(len(whole) - len(single))} left out: another has the same vertices. Mesh > Merge > By Distance "
            "removes such faces."
        )
    turned = _turned_alike(single, edges if single is given else _edges_of(single))
    count = int(np.count_nonzero((turned != single).any(axis=1)))
    if count:
        warnings.append(
            f"{_faces(count)} turned over to look the same way as their neighbours. Mesh > Normals > Recalculate "
            "Outside does so for good."
        )
    if not has_area(points, turned):
        raise InvalidMeshError("The surface has no area. Choose a mesh with a surface.")
    warnings += _coarse_steps(points)
    return MendedMesh(points, turned, stands_for, warnings)


def has_area(points: FloatArray, faces: IntArray) -> bool:
    """Tell whether triangles have any area, at any scale.

    Parameters
    ----------
    points : (n, 3) ndarray of float
        Vertex positions.
    faces : (m, 3) ndarray of int
        Triangles.

    Returns
    -------
    bool
        True if one has, beyond rounding.
    """
    inside = np.zeros(len(points), dtype=bool)
    inside[faces] = True
    used = points[inside]
    if not len(used):
        return False
    middle = used.min(axis=0) / 2 + used.max(axis=0) / 2
    extent = float(np.abs(used - middle).max())
    if not extent > 0:
        return False
    scaled = np.zeros_like(points)
    scaled[inside] = (used - middle) / extent
    return surface_area(scaled, faces) > _NO_AREA


def _faces(count: int) -> str:
    return "1 face was" if count == 1 else f"{count:,} faces were"


def _of_three(faces: IntArray) -> IntArray:
    """Drop the triangles that name a vertex twice."""
    twice = (faces == np.roll(faces, 1, axis=1)).any(axis=1)
    return faces[~twice] if twice.any() else faces


@dataclass(frozen=True, eq=False)
class _Edges:
    """The half-edges (3·face + the corner they start from) sorted by the edge that they are on."""

    order: IntArray
    start: IntArray  # where each edge begins in that order
    triangles: IntArray  # how many each has
    tail: IntArray  # of each half-edge
    head: IntArray


def _edges_of(faces: IntArray) -> _Edges:
    tail, head = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    key = np.minimum(tail, head) * (int(faces.max(initial=0)) + 1) + np.maximum(tail, head)
    order = np.argsort(key, kind="stable")
    rising = key[order]
    start = np.flatnonzero(np.concatenate([[True], rising[1:] != rising[:-1]])) if len(key) else order
    return _Edges(order, start, np.diff(np.append(start, len(key))), tail, head)


def _sewn(points: FloatArray, faces: IntArray, edges: _Edges) -> IntArray:
    """Find for every vertex the first that it is one with: where edges at borders lie on each other.

    Sheets that lie on each other all over are not sewn: there the third corners lie on each other too.
    """
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    stands_for = np.arange(len(points))
    alone = edges.order[edges.start[edges.triangles == 1]]  # half-edges at a border
    if len(alone) < 2:
        return stands_for
    ends = np.stack([edges.tail[alone], edges.head[alone]])
    rim, place = np.unique(ends, return_inverse=True)
    _, site = np.unique(points[rim] + 0.0, axis=0, return_inverse=True)  # + 0.0: -0 is 0
    if site.max() + 1 == len(rim):
        return stands_for
    site = site.ravel()[place.ravel()].reshape(2, -1)
    swap = site[0] > site[1]
    site[:, swap], ends[:, swap] = site[::-1, swap], ends[::-1, swap]
    third = points[faces.ravel()[alone // 3 * 3 + (alone + 2) % 3]] + 0.0
    order = np.lexsort((alone, site[1], site[0]))
    site, ends, third = site[:, order], ends[:, order], third[order]
    new = np.concatenate([[True], (site[:, 1:] != site[:, :-1]).any(axis=0)])
    group = np.cumsum(new) - 1
    first = np.flatnonzero(new)[group]
    differs = np.bincount(group, (third != third[first]).any(axis=1)) > 0
    sewn = (first != np.arange(len(group))) & differs[group] & (site[0] != site[1])
    row, column = ends[:, first[sewn]].ravel(), ends[:, sewn].ravel()
    if not len(row):
        return stands_for
    shape = (len(points), len(points))
    label = connected_components(coo_matrix((np.ones(len(row)), (row, column)), shape=shape), directed=False)[1]
    _, lowest, back = np.unique(label, return_index=True, return_inverse=True)
    return lowest[back.ravel()].astype(np.int64)


def _without_copies(faces: IntArray) -> IntArray:
    """Keep the first of triangles with the same three vertices."""
    low, mid, high = np.sort(faces, axis=1).T.astype(np.uint64)
    with np.errstate(over="ignore"):
        mixed = low * np.uint64(0x9E3779B97F4A7C15) ^ mid * np.uint64(0xC2B2AE3D27D4EB4F) ^ high
    order = np.argsort(mixed, kind="stable")
    alike = np.flatnonzero(mixed[order][1:] == mixed[order][:-1])
    if not len(alike):
        return faces
    some = np.unique(order[np.concatenate([alike, alike + 1])])  # rising, so the first of each stays
    _, first = np.unique(np.sort(faces[some], axis=1), axis=0, return_index=True)
    keep = np.ones(len(faces), dtype=bool)
    keep[some] = False
    keep[some[first]] = True
    return faces[keep]


def _turned_alike(faces: IntArray, edges: _Edges) -> IntArray:
    """Turn triangles over so that neighbours across an edge agree, as few as possible; one-sided parts stay."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    start = edges.start[edges.triangles == 2]
    one, other = edges.order[start], edges.order[start + 1]
    disagree = edges.tail[one] == edges.tail[other]
    if not disagree.any():
        return faces
    m = len(faces)
    f, g = one // 3, other // 3
    row, column = np.concatenate([f, m + f]), np.concatenate([g + m * disagree, m + g - m * disagree])
    graph = coo_matrix((np.ones(len(row)), (row, column)), shape=(2 * m, 2 * m))  # each triangle as it is and turned
    label = connected_components(graph, directed=False)[1]
    as_is, over = label[:m], label[m:]
    kept = np.bincount(as_is, minlength=int(label.max()) + 1)
    turn = (kept[over] > kept[as_is]) | ((kept[over] == kept[as_is]) & (over < as_is))
    result = faces.copy()
    result[turn] = result[turn][:, ::-1]
    return result


def _coarse_steps(points: FloatArray) -> list[str]:
    """Warn where positions are too far from the origin for the size of the mesh, in single precision or double."""
    largest, half = float(np.abs(points).max()), float((points.max(axis=0) / 2 - points.min(axis=0) / 2).max())
    single = largest < np.finfo(np.float32).max and bool((points.astype(np.float32) == points).all())
    share = float(np.finfo(np.float32 if single else np.float64).eps) * (largest / half) / 2
    if share < _COARSE:
        return []
    return [
        f"The mesh lies so far from its origin that its positions are rounded to {share:.1%} of its size. Bring it "
        "nearer (Object > Set Origin > Geometry to Origin) before detail is modelled or scanned."
    ]
