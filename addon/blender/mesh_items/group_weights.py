"""Weights of vertex groups, many set at once."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
import numpy as np

from .fingerprints import members_fingerprint

if TYPE_CHECKING:
    from ...core.numerics.arrays import FloatArray

_STEPS = 1000  # levels between 0 and 1: one call per level in use, whatever the number of vertices


def fill_group(group: bpy.types.VertexGroup, weights: FloatArray) -> str:
    """Replace all weights of a vertex group.

    Parameters
    ----------
    group : bpy.types.VertexGroup
        The group of an object in Object Mode.
    weights : (n,) ndarray of float
        Weights from 0 to 1, rounded to a thousandth; vertices with a weight that is not finite are not members.

    Returns
    -------
    str
        Fingerprint of the members.
    """
    members = np.flatnonzero(np.isfinite(weights))
    group.remove(np.flatnonzero(~np.isfinite(weights)).tolist())
    rounded = np.round(np.clip(weights[members], 0.0, 1.0) * _STEPS).astype(np.int64)
    order = np.argsort(rounded, kind="stable")
    values, first = np.unique(rounded[order], return_index=True)
    for value, begin, end in zip(values.tolist(), first, [*first[1:], len(order)], strict=bool(len(order))):
        group.add(members[order[begin:end]].tolist(), value / _STEPS, "REPLACE")
    return members_fingerprint(members, rounded / _STEPS)


def in_steps(weights: FloatArray) -> FloatArray:
    """Round the weights of all groups so that those of each vertex still add up to 1.

    Parameters
    ----------
    weights : (n, g) ndarray of float
        Weights, whose rows sum to 1.

    Returns
    -------
    (n, g) ndarray of float
        Multiples of a thousandth, as `fill_group` writes them; rows sum to 1.

    Examples
    --------
    >>> in_steps(np.array([[0.33333, 0.33333, 0.33334]])).tolist()
    [[0.333, 0.333, 0.334]]
    """
    whole = np.floor(weights * _STEPS)
    left = np.round(_STEPS - whole.sum(axis=1)).astype(int)
    rank = np.argsort(np.argsort(whole - weights * _STEPS, axis=1, kind="stable"), axis=1, kind="stable")
    return np.asarray((whole + (rank < left[:, None])) / _STEPS)
