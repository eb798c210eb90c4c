"""A mesh in space: checks, areas, normals, volume, scale."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike

from ..numerics.arrays import FloatArray, IntArray
from ..numerics.blocks import AT_ONCE
from ..run.errors import InvalidMeshError


def checked_arrays(vertices: ArrayLike, faces: ArrayLike) -> tuple[FloatArray, IntArray]:
    """Convert a mesh to arrays of the core's types, or raise an error that says what is wrong.

    `vertices` (n, 3); `faces` (m, 3); gives vertices (n, 3), faces (m, 3).

    Examples
    --------
    >>> vertices, faces = checked_arrays([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> str(vertices.dtype), str(faces.dtype)
    ('float64', 'int64')
    """
    try:
        points, corners = np.asarray(vertices), np.asarray(faces)
        if np.iscomplexobj(points):
            raise TypeError("complex numbers")
        points = np.ascontiguousarray(points, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InvalidMeshError("not_numbers", reason=error) from error
    if corners.size == 0:
        raise InvalidMeshError("no_faces")
    if points.ndim != 2 or points.shape[1] != 3:
        raise InvalidMeshError("vertex_shape", shape=points.shape)
    if corners.ndim != 2 or corners.shape[1] != 3:
        raise InvalidMeshError("face_shape", shape=corners.shape)
    if not np.issubdtype(corners.dtype, np.integer):
        raise InvalidMeshError("face_type", type=corners.dtype)
    if not np.isfinite(points).all():
        raise InvalidMeshError("not_finite", count=int(np.count_nonzero(~np.isfinite(points).all(axis=1))))
    if corners.min() < 0 or corners.max() >= len(points):
        raise InvalidMeshError("face_range", last=len(points) - 1)
    return points, np.ascontiguousarray(corners, dtype=np.int64)


def area_vectors(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """Compute the area vector of every triangle: its normal, with the area as length.

    `vertices` (n, 3); `faces` (m, 3); gives (m, 3).

    Examples
    --------
    >>> area_vectors(np.array([[0.0, 0, 0], [2, 0, 0], [0, 3, 0]]), np.array([[0, 1, 2]])).tolist()
    [[0.0, 0.0, 3.0]]
    """
    result = np.empty((len(faces), 3))
    for some, (a, b, c) in _triangles(vertices, faces):
        result[some] = np.cross(b - a, c - a) / 2
    return result


def vertex_area_vectors(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """Sum the area vectors of the triangles around every vertex: its normal, with their area as length.

    `vertices` (n, 3); `faces` (m, 3); gives (n, 3).

    Examples
    --------
    >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
    >>> vertex_area_vectors(square, np.array([[0, 1, 2], [1, 3, 2]]))[:, 2].tolist()
    [0.5, 1.0, 1.0, 0.5]
    """
    each = np.repeat(area_vectors(vertices, faces), 3, axis=0)
    corners = faces.ravel()
    return np.column_stack([np.bincount(corners, each[:, axis], minlength=len(vertices)) for axis in range(3)])


def vertex_normals(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """Compute the unit normal of every vertex.

    `vertices` (n, 3); `faces` (m, 3); gives (n, 3).

    Examples
    --------
    >>> vertex_normals(np.array([[0.0, 0, 0], [2, 0, 0], [0, 3, 0]]), np.array([[0, 1, 2]]))[0].tolist()
    [0.0, 0.0, 1.0]
    """
    sums = vertex_area_vectors(vertices, faces)
    return np.asarray(sums / np.maximum(np.linalg.norm(sums, axis=1), np.finfo(float).tiny)[:, None])


def surface_area(vertices: FloatArray, faces: IntArray) -> float:
    """Compute the area of a mesh.

    `vertices` (n, 3); `faces` (m, 3).

    Examples
    --------
    >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
    >>> surface_area(square, np.array([[0, 1, 2], [1, 3, 2]]))
    1.0
    """
    return float(np.linalg.norm(area_vectors(vertices, faces), axis=1).sum())


def of_unit_area(vertices: FloatArray, faces: IntArray) -> tuple[FloatArray, FloatArray, float]:
    """Centre a mesh and scale it to unit area, whatever its size.

    `vertices` (n, 3); `faces` (m, 3); gives points (n, 3), centre (3,), unit.

    Examples
    --------
    >>> triangle, faces = np.array([[0.0, 0, 0], [2, 0, 0], [0, 9, 0]]), np.array([[0, 1, 2]])
    >>> points, centre, unit = of_unit_area(triangle, faces)
    >>> round(surface_area(points, faces), 6), round(float(unit), 6), np.allclose(points * unit + centre, triangle)
    (1.0, 3.0, True)
    """
    scale = 2.0 ** np.floor(np.log2(np.abs(vertices).max()))  # exact, and squares of the quotients do not overflow
    points = vertices / scale
    centre, width = points.mean(axis=0), float(np.ptp(points, axis=0).max())
    points = (points - centre) / width
    size = float(np.sqrt(surface_area(points, faces)))
    return points / size, centre * scale, width * size * scale


def vertex_areas(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """Compute the area of every vertex: a third of that of its triangles in space.

    `vertices` (n, 3); `faces` (m, 3); gives (n,).

    Examples
    --------
    >>> vertex_areas(np.array([[0.0, 0, 0], [2, 0, 0], [0, 3, 0]]), np.array([[0, 1, 2]])).round(6).tolist()
    [1.0, 1.0, 1.0]
    """
    thirds = np.linalg.norm(area_vectors(vertices, faces), axis=1) / 3
    return np.bincount(faces.ravel(), weights=np.repeat(thirds, 3), minlength=len(vertices)).astype(np.float64)


def signed_volume(vertices: FloatArray, faces: IntArray) -> float:
    """Sum the signed volumes of the tetrahedra between the triangles and the centre.

    `vertices` (n, 3); `faces` (m, 3).

    Examples
    --------
    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 6]])
    >>> round(signed_volume(points, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])), 6)
    1.0
    """
    centred = vertices - vertices.mean(axis=0)
    return sum(float(np.einsum("ij,ij->", a, np.cross(b, c))) for _, (a, b, c) in _triangles(centred, faces)) / 6


def weights_on_triangle(one: FloatArray, two: FloatArray) -> FloatArray:
    """Turn numbers that are even from 0 to 1 into barycentric coordinates that are even over a triangle.

    `one, two` (p,); gives (p, 3).

    Examples
    --------
    >>> weights_on_triangle(np.array([0.0, 0.25]), np.array([0.5, 0.5])).tolist()
    [[1.0, 0.0, 0.0], [0.5, 0.25, 0.25]]
    """
    root = np.sqrt(one)
    return np.column_stack([1 - root, root * (1 - two), root * two])


def moved_by_frames(vertices: FloatArray, rotation: FloatArray, shift: FloatArray) -> FloatArray:
    """Move every vertex by its own frame.

    `vertices` (n, 3); `rotation` (n, 3, 3); `shift` (n, 3); gives (n, 3).

    Examples
    --------
    >>> quarter = np.array([[[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]]])
    >>> moved_by_frames(np.array([[1.0, 0, 0]]), quarter, np.array([[0.0, 0, 5]])).tolist()
    [[0.0, 1.0, 5.0]]
    """
    return np.einsum("ij,ijk->ik", vertices, rotation) + shift


def relative_rounding(points: FloatArray) -> float:
    """Estimate the relative rounding of positions that are far from the origin.

    `points` (n, 3).

    Examples
    --------
    >>> relative_rounding(np.array([[0.0, 0, 0], [1, 0, 0]])) < 1e-6
    True
    >>> relative_rounding(np.array([[0.0, 0, 0], [1, 0, 0]]) + 2.0**23) > 0.1
    True
    """
    largest, half = float(np.abs(points).max()), float((points.max(axis=0) / 2 - points.min(axis=0) / 2).max())
    if not half > 0:
        return 0.0
    single = largest < float(np.finfo(np.float32).max) and bool((points.astype(np.float32) == points).all())
    return float(np.finfo(np.float32 if single else np.float64).eps) * (largest / half) / 2


def component_areas(points: FloatArray, faces: IntArray, start: IntArray) -> tuple[FloatArray, FloatArray]:
    """Measure the area of every component of a mesh, at any scale.

    `points` (n, 3); `faces` (m, 3); `start` (k,); gives area (k,), size (k,).

    Examples
    --------
    >>> triangle = np.array([[0.0, 0, 0], [2, 0, 0], [0, 2, 0]])
    >>> area, size = component_areas(triangle, np.array([[0, 1, 2]]), np.array([0]))
    >>> area.tolist(), size.tolist()
    ([2.0], [1.0])
    """
    least, most = np.empty((2, len(faces), 3))
    for some, (a, b, c) in _triangles(points, faces):
        least[some], most[some] = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
    low, high = np.minimum.reduceat(least, start), np.maximum.reduceat(most, start)  # (k, 3)
    size = (high / 2 - low / 2).max(axis=1)
    middle, scale = high / 2 + low / 2, np.where(size > 0, size, 1.0)
    component = np.repeat(np.arange(len(start)), np.diff(np.append(start, len(faces))))
    each = np.empty(len(faces))
    for some, corners in _triangles(points, faces):
        origin, unit = middle[component[some]], scale[component[some], None]
        a, b, c = ((corner - origin) / unit for corner in corners)
        each[some] = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    area = np.add.reduceat(each, start)
    return np.where(size > 0, area, 0.0), size


def _triangles(points: FloatArray, faces: IntArray) -> Iterator[tuple[slice, tuple[FloatArray, ...]]]:
    """Yield the corners of the triangles, in batches that stay in the cache."""
    for start in range(0, len(faces), AT_ONCE):
        some = slice(start, start + AT_ONCE)
        yield some, tuple(points.take(faces[some, corner], axis=0) for corner in range(3))
