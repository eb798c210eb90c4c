"""Distances on a body, as they were if its limbs had the lengths of another's."""

from __future__ import annotations

import numpy as np

from ..numerics.arrays import FloatArray


def in_proportion(to_features: FloatArray, own: FloatArray, others: FloatArray) -> FloatArray:
    """Stretch the distances from each feature point, so that the other feature points are where another body has them.

    The way between two bodies of different build is not linear: a gorilla's legs are short and its trunk is long. Along
    the distance from one feature point the others are landmarks on both bodies, the nearest of one the nearest of
    the other; between two of them the distance is stretched evenly.

    `to_features` (n, k): distances of all points from the feature points; `own` (k, k): between the feature points;
    `others` (k, k): between the corresponding ones of the other body; gives (n, k).

    Examples
    --------
    >>> own, others = np.array([[0.0, 1], [1, 0]]), np.array([[0.0, 3], [3, 0]])
    >>> in_proportion(np.array([[0.5, 0.5], [2.0, 1.0]]), own, others).tolist()
    [[1.5, 1.5], [6.0, 3.0]]
    """
    if len(own) < 2:
        return to_features
    stretched = np.empty_like(to_features)
    for column, (before, after) in enumerate(zip(np.sort(own, axis=0).T, np.sort(others, axis=0).T, strict=True)):
        away = to_features[:, column]
        beyond = np.maximum(away / before[-1], 1.0)
        stretched[:, column] = np.interp(away, before, after) * beyond
    return stretched
