"""Weights of vertex groups, read many at once."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import bpy
import numpy as np

if TYPE_CHECKING:
    from ...core.numerics.arrays import FloatArray


def weights_of(obj: bpy.types.Object, names: Iterable[str], *, shown: bool = False) -> dict[str, FloatArray]:
    """Read the weights of vertex groups without a loop over the vertices.

    Blender gives weights one vertex at a time, but it mixes shape keys at once: on a temporary copy of the mesh, with
    all vertices at the origin, keys that move by 1 along one axis each are limited to one group each. Their mix puts
    every vertex at its weights in three groups, exactly.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode.
    names : iterable of str
        Names of groups.
    shown : bool
        Whether to read them on the evaluated mesh, whose modifiers may have made vertices.

    Returns
    -------
    dict of str to (n,) ndarray of float
        Weights of each existing group, by name; 0 for vertices that are no members.
    """
    found = [name for name in names if name in obj.vertex_groups]
    if not found or not len(obj.data.vertices):
        return {name: np.zeros(0) for name in found}
    graph = bpy.context.evaluated_depsgraph_get()
    source = obj.evaluated_get(graph) if shown else obj
    mesh = bpy.data.meshes.new_from_object(source, preserve_all_data_layers=True, depsgraph=graph)  # without shape keys
    holder = bpy.data.objects.new(mesh.name, mesh)
    lost = [name for name in found if name not in holder.vertex_groups]  # a key is not limited by a missing group
    weights = {name: np.zeros(len(mesh.vertices)) for name in lost}
    found = [name for name in found if name not in lost]
    try:
        holder.vertex_groups.new(name="Any").add([0], 1.0, "REPLACE")  # a group limits no key if all groups are empty
        keys = [_add_key(holder, position) for position in np.vstack([np.zeros(3), np.eye(3)])][1:]
        for start in range(0, len(found), len(keys)):
            part = found[start : start + len(keys)]
            for key, name in zip(keys, part, strict=False):
                key.vertex_group, key.value = name, 1.0
            mix = holder.shape_key_add(name="Mix", from_mix=True)
            values = np.empty(3 * len(mesh.vertices), dtype=np.float32)
            mix.points.foreach_get("co", values)
            holder.shape_key_remove(mix)
            weights.update(zip(part, values.reshape(-1, 3).T.astype(float), strict=False))
    finally:
        holder.shape_key_clear()
        bpy.data.objects.remove(holder)
        bpy.data.meshes.remove(mesh)
    return weights


def _add_key(holder: bpy.types.Object, position: FloatArray) -> bpy.types.ShapeKey:
    """Add a shape key that has all vertices at one position."""
    mesh = holder.data
    mesh.attributes["position"].data.foreach_set("vector", np.tile(position.astype(np.float32), len(mesh.vertices)))
    return holder.shape_key_add(name="Weights", from_mix=False)
