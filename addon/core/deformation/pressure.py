"""An even pressure in a closed body that keeps its compactness."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..mesh.geometry import signed_volume, surface_area, vertex_area_vectors
from ..numerics.arrays import FloatArray, IntArray
from ..numerics.vectors import cross, dot, gathered

_PRESSURE_STEPS = 3  # Newton steps in each deformation step
_MOST_PRESSURE = 0.05  # farthest a vertex may be pushed in one step, in units of sqrt(area)


def under_pressure(
    positions: FloatArray, before: FloatArray, faces: IntArray, solve: Callable[[FloatArray], FloatArray]
) -> FloatArray:
    """Inflate or deflate a closed mesh until its compactness ``V² / A³`` is that of the mesh before.

    `positions` (n, 3); `before` (n, 3); `faces` (m, 3); `solve`: maps forces on the vertices to their displacements;
    gives (n, 3).
    """
    area = surface_area(before, faces)
    wanted = signed_volume(before, faces) / area**1.5
    way = solve(vertex_area_vectors(positions, faces))  # direction in which the volume grows
    way *= np.sqrt(area / (way**2).sum(axis=1).max())  # an amount of 1 moves by sqrt(area)
    side = np.sign(wanted)  # -1 where the triangles face inwards
    way, wanted, amount, step = side * way, abs(wanted), 0.0, 1e-4
    compactness = _signed_compactness_along(positions, way, faces)
    for _ in range(_PRESSURE_STEPS):
        here = side * compactness(amount) - wanted
        slope = (side * compactness(amount + step) - wanted - here) / step
        if not slope > 0:  # the mesh has hardly any interior
            return positions
        amount = float(np.clip(amount - here / slope, -_MOST_PRESSURE, _MOST_PRESSURE))
    return positions + amount * way


def _signed_compactness_along(positions: FloatArray, way: FloatArray, faces: IntArray) -> Callable[[float], float]:
    """Prepare the volume over the area to the power 3/2, with the volume's sign, of ``positions + t way``.

    The volume is a polynomial in t, and so is the square of the area of each triangle.
    """
    centred = positions - positions.mean(axis=0)
    start, one, two = (gathered(centred, corner) for corner in faces.T)  # (3, m) each
    start_way, one_way, two_way = (gathered(way, corner) for corner in faces.T)
    one, two, one_way, two_way = one - start, two - start, one_way - start_way, two_way - start_way
    # twice the area vector is n₀ + n₁ t + n₂ t²
    normal = [cross(one, two), cross(one, two_way) + cross(one_way, two), cross(one_way, two_way)]
    volume = np.zeros(4)
    squared = np.zeros((5, len(faces)))
    for power, vector in enumerate(normal):
        volume[power] += dot(start, vector).sum() / 6
        volume[power + 1] += dot(start_way, vector).sum() / 6
        for other, against in enumerate(normal):
            squared[power + other] += dot(vector, against)

    def at(amount: float) -> float:
        powers = amount ** np.arange(5)
        area = np.sqrt(np.maximum(np.einsum("i,ij->j", powers, squared), 0.0)).sum() / 2
        return float(powers[:4] @ volume / area**1.5)

    return at
