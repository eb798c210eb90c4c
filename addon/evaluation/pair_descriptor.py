"""A rigid shape descriptor that keeps detail: how pairs of points of a surface and their normals lie to each other."""

from __future__ import annotations

import numpy as np

from ..core.mesh.geometry import area_vectors, weights_on_triangle
from ..core.numerics.arrays import FloatArray, IntArray
from ..core.numerics.shares import spread

POINTS = 1000  # of the surface, which is half a million pairs
DISTANCES, REACH = 12, 3.5  # intervals of the distance, up to so many times its root mean square
COSINES = 4  # intervals of each of the three cosines
_PLASTIC = 1.32471795724474602596  # its powers spread points in two dimensions, as the golden ratio does in one


def pair_descriptor(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """Describe a surface by values that are invariant under rigid motions, mirroring and scaling.

    Of every two points: their distance, the cosines between the line that joins them and either normal, the smaller
    one first, and the cosine between the normals. The share of all pairs in each interval of the four describes the
    shape: limbs by the distances, their thickness by points that face away from each other, and folds by normals.

    Parameters
    ----------
    vertices : (n, 3) ndarray of float
        Vertices.
    faces : (m, 3) ndarray of int
        Triangles.

    Returns
    -------
    (768,) ndarray of float
        Square roots of the shares, so that their Euclidean distance is Hellinger's but for a factor; of length 1.

    References
    ----------
    Wahl, Hillenbrand and Hirzinger, "Surflet-Pair-Relation Histograms: A Statistical 3D-Shape Representation for Rapid
    Classification", 2003, doi:10.1109/IM.2003.1240284. Here the order of two points does not matter, nor does
    mirroring, and distances are relative to their root mean square instead of the largest.
    """
    points, normals = _spread(vertices, faces)
    points = points - points.mean(axis=0)
    points /= np.sqrt(2 * (points**2).sum(axis=1).mean())  # root mean square over all pairs
    one, two = np.triu_indices(POINTS, 1)
    way = points[two] - points[one]
    apart = np.linalg.norm(way, axis=1)
    way /= np.maximum(apart, np.finfo(float).tiny)[:, None]
    leaving, arriving = (np.einsum("ij,ij->i", way, each) for each in (normals[one], -normals[two]))
    between = np.einsum("ij,ij->i", normals[one], normals[two])
    cell = np.zeros(len(way), dtype=np.int64)
    for cosine in (np.minimum(leaving, arriving), np.maximum(leaving, arriving), between):
        cell = cell * COSINES + np.clip((cosine + 1) / 2 * COSINES, 0, COSINES - 1).astype(np.int64)
    place = np.clip(apart / REACH * DISTANCES - 0.5, 0, DISTANCES - 1)
    low = np.minimum(place.astype(np.int64), DISTANCES - 2)  # a pair between two distances is divided between them
    cells, counts = COSINES**3, np.zeros(DISTANCES * COSINES**3)
    for distance, share in ((low, low + 1 - place), (low + 1, place - low)):
        counts += np.bincount(distance * cells + cell, share, len(counts))
    return np.asarray(np.sqrt(counts / counts.sum()))


def _spread(vertices: FloatArray, faces: IntArray) -> tuple[FloatArray, FloatArray]:
    """Spread points evenly over the area, in the order of the triangles; with their normals: (p, 3) each."""
    across = area_vectors(vertices, faces)
    area = np.linalg.norm(across, axis=1)
    face = spread(area / area.sum(), POINTS)
    place = np.arange(POINTS) + 0.5
    weights = weights_on_triangle((place / _PLASTIC) % 1, (place / _PLASTIC**2) % 1)
    normal = across[face] / np.maximum(area[face], np.finfo(float).tiny)[:, None]
    return np.einsum("ij,ijk->ik", weights, vertices[faces[face]]), normal
