"""The handedness of functions on a surface, which only changes sign when left and right are swapped."""

from __future__ import annotations

import numpy as np

from ..numerics.arrays import FloatArray, IntArray


def chirality(functions: FloatArray, faces: IntArray) -> FloatArray:
    """Integrate one function over the area that two others span, for all triples.

    ``c_ijk = ∫ f_i df_j ∧ df_k``, made antisymmetric, as it is on a closed surface by Stokes' theorem. It needs no
    lengths and no positions in space, only the orientation of the triangles. A mirror image of the surface has ``-c``;
    so does a surface whose functions are swapped as a mirror swaps them.

    `functions` (n, k); `faces` (m, 3); gives (k, k, k).

    Examples
    --------
    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])  # a corner of a cube, seen from outside
    >>> faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> round(float(chirality(points, faces)[0, 1, 2]), 6)  # its volume
    0.166667
    """
    values = (functions - functions.mean(axis=0))[faces]  # (m, 3, k)
    middle = values.mean(axis=1)
    one, two = values[:, 1] - values[:, 0], values[:, 2] - values[:, 0]
    count = functions.shape[1]
    spanned = np.empty((count, count, count))
    for index in range(count):
        half = (one * middle[:, index : index + 1]).T @ two / 2
        spanned[index] = half - half.T
    return np.asarray((spanned + spanned.transpose(1, 2, 0) + spanned.transpose(2, 0, 1)) / 3)


def sided(handedness: FloatArray, side: IntArray, along: FloatArray) -> float:
    """Sum the handedness of the limbs on the left, the direction to the head, and the limbs on the right.

    `handedness` (k, k, k); `side` (k,); `along` (k,).

    Examples
    --------
    >>> volumes = np.zeros((3, 3, 3))
    >>> volumes[0, 2, 1] = 0.5
    >>> sided(volumes, np.array([1, -1, 0]), np.array([0.0, 0, 1]))
    0.5
    """
    return float(np.einsum("ijk,i,j,k", handedness, (side == 1).astype(float), along, (side == -1).astype(float)))
