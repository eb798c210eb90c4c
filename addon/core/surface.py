"""The mesh as a metric surface: checks, triangles with edge lengths, areas and connectivity.

Everything behind this file sees the surface through its triangles and the lengths of their edges only, so no later
step can depend on how the mesh lies in space.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import InvalidMeshError

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Triangulation:
    """Triangles glued along edges, each edge with a length: a surface without a place in space.

    Attributes
    ----------
    vertex_count : int
        Number of vertices n.
    faces : (m, 3) ndarray of int
        Corners of each triangle. An intrinsic triangle may name a vertex twice: it then wraps around a limb.
    lengths : (m, 3) ndarray of float
        Length of the edge opposite to each corner.
    edges : (m, 3) ndarray of int
        Number of the edge opposite to each corner, from 0. Two edges may join the same two vertices.
    """

    vertex_count: int
    faces: IntArray
    lengths: FloatArray
    edges: IntArray


def checked_arrays(vertices: ArrayLike, faces: ArrayLike) -> tuple[FloatArray, IntArray]:
    """Return a mesh as arrays of the core's types, or say why they are no mesh.

    Parameters
    ----------
    vertices : (n, 3) array_like of float
        Vertex positions, any unit of length.
    faces : (m, 3) array_like of int
        Triangles as vertex indices.

    Returns
    -------
    vertices : (n, 3) ndarray of float64
        The positions.
    faces : (m, 3) ndarray of int64
        The triangles.

    Raises
    ------
    InvalidMeshError
        If a shape is wrong, a coordinate is not finite, an index is out of range, or there is no triangle.
    """
    try:
        points, corners = np.asarray(vertices), np.asarray(faces)
        if np.iscomplexobj(points):
            raise TypeError("complex numbers")
        points = np.ascontiguousarray(points, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InvalidMeshError(f"Vertices and faces must be arrays of numbers ({error}).") from error
    if corners.size == 0:
        raise InvalidMeshError("The mesh has no faces. Choose a mesh with a surface.")
    if points.ndim != 2 or points.shape[1] != 3:
        raise InvalidMeshError(f"Vertices must be an (n, 3) array; got shape {points.shape}.")
    if corners.ndim != 2 or corners.shape[1] != 3:
        raise InvalidMeshError(f"Faces must be an (m, 3) array of triangles; got shape {corners.shape}.")
    if not np.issubdtype(corners.dtype, np.integer):
        raise InvalidMeshError(f"Faces must be integers; got {corners.dtype}.")
    if not np.isfinite(points).all():
        bad = int(np.count_nonzero(~np.isfinite(points).all(axis=1)))
        which = "1 vertex has" if bad == 1 else f"{bad:,} vertices have"
        raise InvalidMeshError(f"{which} coordinates that are not numbers. Delete or repair them.")
    if corners.min() < 0 or corners.max() >= len(points):
        raise InvalidMeshError(f"Faces name vertices outside 0 to {len(points) - 1}.")
    return points, np.ascontiguousarray(corners, dtype=np.int64)


def triangulated(vertices: FloatArray, faces: IntArray, slack: float = 1e-5) -> Triangulation:
    """Read the triangulation off a mesh in space, mollified so that every triangle has some area.

    Parameters
    ----------
    vertices : (n, 3) ndarray of float
        Vertex positions.
    faces : (m, 3) ndarray of int
        Triangles.
    slack : float
        Of `mollified`.

    Returns
    -------
    Triangulation
        The same triangles with their edge lengths.
    """
    tail, head = np.roll(faces, -1, axis=1), np.roll(faces, -2, axis=1)
    key = np.minimum(tail, head) * len(vertices) + np.maximum(tail, head)
    _, number = np.unique(key, return_inverse=True)
    return Triangulation(
        len(vertices), faces, mollified(corner_lengths(vertices, faces), slack), number.reshape(-1, 3).astype(np.int64)
    )


def corner_lengths(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """Measure the edges of every triangle.

    Parameters
    ----------
    vertices : (n, 3) ndarray of float
        Vertex positions.
    faces : (m, 3) ndarray of int
        Triangles.

    Returns
    -------
    (m, 3) ndarray of float
        Column i holds the length of the edge opposite to corner i.
    """
    corners = vertices[faces]  # (m, 3 corners, 3)
    opposite = np.roll(corners, -1, axis=1) - np.roll(corners, -2, axis=1)
    return np.linalg.norm(opposite, axis=2)  # (m, 3)


def mollified(lengths: FloatArray, factor: float = 1e-5) -> FloatArray:
    """Lengthen all edges by one constant, just enough that no triangle is degenerate.

    A mesh whose triangles all have some thickness comes back as it was.

    Parameters
    ----------
    lengths : (m, 3) ndarray of float
        Edge lengths by triangle.
    factor : float
        Slack demanded of every triangle inequality, in units of the mean edge length.

    Returns
    -------
    (m, 3) ndarray of float
        Lengths with ``l_j + l_k - l_i >= factor * mean`` in every triangle.

    References
    ----------
    Sharp and Crane, "A Laplacian for Nonmanifold Triangle Meshes", 2020, section 4.5.
    """
    slack = lengths.sum(axis=1, keepdims=True) - 2 * lengths  # (m, 3)
    return lengths + max(0.0, factor * float(lengths.mean()) - float(slack.min()))


def face_areas(lengths: FloatArray) -> FloatArray:
    """Compute triangle areas from edge lengths (Heron's formula in Kahan's stable order).

    Parameters
    ----------
    lengths : (m, 3) ndarray of float
        Edge lengths by triangle.

    Returns
    -------
    (m,) ndarray of float
        Areas; 0 where a triangle inequality is violated.
    """
    c, b, a = np.sort(lengths, axis=1).T  # a >= b >= c
    squared = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c))
    return np.sqrt(np.maximum(squared, 0.0)) / 4


def corner_cotangents(lengths: FloatArray) -> FloatArray:
    """Compute the cotangent of every corner from edge lengths.

    Parameters
    ----------
    lengths : (m, 3) ndarray of float
        Edge lengths by triangle, of positive area.

    Returns
    -------
    (m, 3) ndarray of float
        Cotangents of the angle at each corner.
    """
    squared = lengths**2
    area = np.maximum(face_areas(lengths), np.finfo(np.float64).tiny)
    return (squared.sum(axis=1, keepdims=True) - 2 * squared) / (4 * area[:, None])


def area_vectors(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """Give every triangle its normal, as long as its area is large.

    Parameters
    ----------
    vertices : (n, 3) ndarray of float
        Vertex positions.
    faces : (m, 3) ndarray of int
        Triangles.

    Returns
    -------
    (m, 3) ndarray of float
        Vectors on the side from which a triangle is counter-clockwise.
    """
    a, b, c = vertices[faces].transpose(1, 0, 2)
    return np.asarray(np.cross(b - a, c - a) / 2)


def vertex_area_vectors(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """Sum the area vectors of the triangles around every vertex: its normal, as long as their area is large.

    Parameters
    ----------
    vertices : (n, 3) ndarray of float
        Vertex positions.
    faces : (m, 3) ndarray of int
        Triangles.

    Returns
    -------
    (n, 3) ndarray of float
        The sums; a third of one is how fast the volume grows as the vertex moves.
    """
    each = np.repeat(area_vectors(vertices, faces), 3, axis=0)
    corners = faces.ravel()
    return np.column_stack([np.bincount(corners, each[:, axis], minlength=len(vertices)) for axis in range(3)])


def surface_area(vertices: FloatArray, faces: IntArray) -> float:
    """Compute the area of a mesh.

    Parameters
    ----------
    vertices : (n, 3) ndarray of float
        Vertex positions.
    faces : (m, 3) ndarray of int
        Triangles.

    Returns
    -------
    float
        Area, in squared units of length.
    """
    return float(np.linalg.norm(area_vectors(vertices, faces), axis=1).sum())


def of_unit_area(vertices: FloatArray, faces: IntArray) -> tuple[FloatArray, FloatArray, float]:
    """Move a mesh to its centre and scale it to unit area, whatever its size is.

    Parameters
    ----------
    vertices : (n, 3) ndarray of float
        Vertex positions.
    faces : (m, 3) ndarray of int
        Triangles, of some area together.

    Returns
    -------
    points : (n, 3) ndarray of float
        The positions there.
    centre : (3,) ndarray of float
        Where the centre was.
    unit : float
        Root of the area: ``vertices = points * unit + centre``.
    """
    scale = 2.0 ** np.floor(np.log2(np.abs(vertices).max()))  # exact, and squares of what is left do not overflow
    points = vertices / scale
    centre, width = points.mean(axis=0), float(np.ptp(points, axis=0).max())
    points = (points - centre) / width
    size = float(np.sqrt(surface_area(points, faces)))
    return points / size, centre * scale, width * size * scale


def vertex_areas(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """Give every vertex a third of the area of its triangles in space.

    Parameters
    ----------
    vertices : (n, 3) ndarray of float
        Vertex positions.
    faces : (m, 3) ndarray of int
        Triangles.

    Returns
    -------
    (n,) ndarray of float
        Areas.
    """
    thirds = np.linalg.norm(area_vectors(vertices, faces), axis=1) / 3
    return np.bincount(faces.ravel(), weights=np.repeat(thirds, 3), minlength=len(vertices)).astype(np.float64)


def is_closed(faces: IntArray) -> bool:
    """Tell whether every edge lies between exactly two triangles.

    Parameters
    ----------
    faces : (m, 3) ndarray of int
        Triangles.

    Returns
    -------
    bool
        True if the mesh has no border and no edge of more than two triangles.
    """
    tail, head = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    key = np.sort(np.minimum(tail, head) * (int(faces.max()) + 1) + np.maximum(tail, head))
    return len(key) % 2 == 0 and bool((key[::2] == key[1::2]).all() and (key[1:-1:2] != key[2::2]).all())


def signed_volume(vertices: FloatArray, faces: IntArray) -> float:
    """Sum the signed volumes between the triangles and the centre.

    Parameters
    ----------
    vertices : (n, 3) ndarray of float
        Vertex positions.
    faces : (m, 3) ndarray of int
        Triangles.

    Returns
    -------
    float
        The volume inside a closed mesh, positive if its triangles are counter-clockwise seen from outside.
    """
    a, b, c = (vertices[faces] - vertices.mean(axis=0)).transpose(1, 0, 2)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def vertex_pairs(faces: IntArray) -> IntArray:
    """List every pair of vertices joined by an edge once.

    Parameters
    ----------
    faces : (m, 3) ndarray of int
        Triangles.

    Returns
    -------
    (e, 2) ndarray of int
        Pairs, lower vertex index first, sorted.
    """
    count = int(faces.max(initial=0)) + 1
    tail, head = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    key = np.unique(np.minimum(tail, head) * count + np.maximum(tail, head))
    return np.column_stack([key // count, key % count])


def component_labels(vertex_count: int, faces: IntArray) -> IntArray:
    """Tell the connected parts of the mesh apart.

    Parameters
    ----------
    vertex_count : int
        Number of vertices n.
    faces : (m, 3) ndarray of int
        Triangles.

    Returns
    -------
    (n,) ndarray of int
        Part of each vertex, numbered from 0. A vertex of no face is a part of its own.
    """
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    row, column = faces[:, [0, 1]].ravel(), faces[:, [1, 2]].ravel()
    graph = coo_matrix((np.ones(len(row)), (row, column)), shape=(vertex_count, vertex_count))
    return connected_components(graph, directed=False)[1].astype(np.int64)
