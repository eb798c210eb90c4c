"""A rigid shape descriptor: the spherical harmonic energies of the surface, shell by shell (Kazhdan et al.)."""

from __future__ import annotations

import numpy as np

from ..core.mesh.geometry import vertex_areas
from ..core.numerics.arrays import FloatArray, IntArray

SHELLS = 32  # between the centre and REACH
DEGREES = 16  # l from 0 to 15
REACH = 2.5  # in root mean square distances of the surface from its centre; the last shell includes everything beyond


def harmonic_descriptor(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """Describe a surface by values that are invariant under rigid motions, mirroring and scaling.

    The area of the surface is divided into concentric shells around its centre. Within a shell it is a function of the
    direction; the norm of its component of each degree l does not change when the shape is rotated.

    Parameters
    ----------
    vertices : (n, 3) ndarray of float
        Vertices.
    faces : (m, 3) ndarray of int
        Triangles.

    Returns
    -------
    (512,) ndarray of float
        Norms by shell and degree, with total length 1. Compare them by their Euclidean distance.

    References
    ----------
    Kazhdan, Funkhouser and Rusinkiewicz, "Rotation Invariant Spherical Harmonic Representation of 3D Shape
    Descriptors", 2003. Here the area of the surface replaces the voxels of the paper, and an area between two shells
    is divided between them.
    """
    area = vertex_areas(vertices, faces)
    area = area / area.sum()
    away = vertices - area @ vertices
    radius = np.sqrt((away**2).sum(axis=1))
    scale = float(np.sqrt(area @ radius**2))
    place = np.minimum(radius / (scale * REACH), 1.0) * (SHELLS - 1)
    low = np.minimum(place.astype(np.int64), SHELLS - 2)
    share = place - low
    harmonics = _harmonics(away / np.maximum(radius, 1e-300)[:, None])  # (n, DEGREES²), complex
    sums = np.zeros((SHELLS, harmonics.shape[1]), dtype=np.complex128)
    for shells, weight in ((low, area * (1 - share)), (low + 1, area * share)):
        for column in range(harmonics.shape[1]):
            values = weight * harmonics[:, column]
            sums[:, column] += np.bincount(shells, values.real, SHELLS) + 1j * np.bincount(shells, values.imag, SHELLS)
    energy = np.abs(sums) ** 2
    degree, order = _degrees_and_orders()
    energy *= np.where(order > 0, 2.0, 1.0)  # m and -m have the same energy
    by_degree = np.zeros((SHELLS, DEGREES))
    for index, each in enumerate(degree):
        by_degree[:, each] += energy[:, index]
    described = np.sqrt(by_degree).ravel()
    return described / np.linalg.norm(described)


def _degrees_and_orders() -> tuple[IntArray, IntArray]:
    order, degree = np.array([(m, degree) for m in range(DEGREES) for degree in range(m, DEGREES)]).T
    return degree, order


def _harmonics(direction: FloatArray) -> np.ndarray:
    """Evaluate the orthonormal spherical harmonics of order m ≥ 0, by the three-term recurrence in the degree."""
    z = direction[:, 2]
    around = direction[:, 0] + 1j * direction[:, 1]  # sin θ e^{iφ}
    columns = []
    diagonal = np.full(len(z), np.sqrt(1 / (4 * np.pi)), dtype=np.complex128)  # P_mm e^{imφ}, normalised
    for m in range(DEGREES):
        if m:
            diagonal = -np.sqrt((2 * m + 1) / (2 * m)) * around * diagonal
        before, now = np.zeros_like(diagonal), diagonal
        columns.append(now)
        for n in range(m + 1, DEGREES):
            a = np.sqrt((4 * n * n - 1) / (n * n - m * m))
            b = np.sqrt(((n - 1) ** 2 - m * m) / (4 * (n - 1) ** 2 - 1)) if n > m + 1 else 0.0
            before, now = now, a * (z * now - b * before)
            columns.append(now)
    return np.column_stack(columns)
