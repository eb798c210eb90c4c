"""Fingerprints of shape keys, colours and vertex groups, to detect items changed since they were written."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping

import bpy
import numpy as np

from .key_points import key_points
from .weight_reading import weights_of


def fingerprint(*arrays: np.ndarray) -> str:
    """Hash the bytes of arrays.

    Parameters
    ----------
    *arrays : ndarray
        The arrays.

    Returns
    -------
    str
        SHA-256 in hexadecimal.
    """
    digest = hashlib.sha256()
    for array in arrays:
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


def key_fingerprint(key: bpy.types.ShapeKey) -> str:
    """Hash the positions of a shape key.

    Parameters
    ----------
    key : bpy.types.ShapeKey
        The key.

    Returns
    -------
    str
        The fingerprint.
    """
    return fingerprint(key_points(key))


def colour_fingerprint(attribute: bpy.types.Attribute) -> str:
    """Hash the colours of a colour attribute.

    Parameters
    ----------
    attribute : bpy.types.Attribute
        The attribute, of type FLOAT_COLOR or BYTE_COLOR.

    Returns
    -------
    str
        The fingerprint.
    """
    colours = np.empty(4 * len(attribute.data), dtype=np.float32)
    attribute.data.foreach_get("color", colours)
    return fingerprint(colours)


def uv_fingerprint(layer: bpy.types.MeshUVLoopLayer) -> str:
    """Hash the coordinates of a UV map.

    Parameters
    ----------
    layer : bpy.types.MeshUVLoopLayer
        The map.

    Returns
    -------
    str
        The fingerprint.
    """
    values = np.empty(2 * len(layer.uv), dtype=np.float32)
    layer.uv.foreach_get("vector", values)
    return fingerprint(values)


def members_fingerprint(vertices: np.ndarray, weights: np.ndarray) -> str:
    """Hash the members of a vertex group.

    Parameters
    ----------
    vertices : (k,) ndarray of int
        Vertex indices, ascending.
    weights : (k,) ndarray of float
        Their weights.

    Returns
    -------
    str
        The fingerprint.
    """
    return fingerprint(vertices.astype(np.int64), weights.astype(np.float32))


def group_fingerprints(obj: bpy.types.Object, known: Mapping[str, str | None]) -> dict[str, str]:
    """Hash several vertex groups.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode.
    known : mapping of str to str or None
        Names of groups, and the fingerprints that they had.

    Returns
    -------
    dict of str to str
        Fingerprint of each existing group, by name.
    """
    prints = {}
    for name, weights in weights_of(obj, known).items():
        member = weights != 0.0
        prints[name] = members_fingerprint(np.flatnonzero(member), weights[member])
        if prints[name] != known[name]:  # it may have members of weight 0, which take a loop to find
            number, vertices = obj.vertex_groups[name].index, obj.data.vertices
            for index in np.flatnonzero(~member).tolist():
                member[index] = any(part.group == number for part in vertices[index].groups)
            prints[name] = members_fingerprint(np.flatnonzero(member), weights[member])
    return prints
