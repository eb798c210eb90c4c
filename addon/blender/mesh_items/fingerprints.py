"""Fingerprints of shape keys, colours and vertex groups, to detect items changed since they were written."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable

import bpy
import numpy as np


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
    points = np.empty(3 * len(key.data), dtype=np.float32)
    key.data.foreach_get("co", points)
    return fingerprint(points)


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


def group_fingerprints(obj: bpy.types.Object, names: Iterable[str]) -> dict[str, str]:
    """Hash several vertex groups in one pass over the vertices.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode.
    names : iterable of str
        Names of groups.

    Returns
    -------
    dict of str to str
        Fingerprint of each existing group, by name.
    """
    found = {obj.vertex_groups[name].index: name for name in names if name in obj.vertex_groups}
    members: dict[int, list[int]] = {index: [] for index in found}
    weights: dict[int, list[float]] = {index: [] for index in found}
    for vertex in obj.data.vertices if found else ():
        for part in vertex.groups:
            if part.group in found:
                members[part.group].append(vertex.index)
                weights[part.group].append(part.weight)
    return {
        name: members_fingerprint(np.array(members[index]), np.array(weights[index])) for index, name in found.items()
    }
