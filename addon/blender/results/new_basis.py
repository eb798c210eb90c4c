"""A shape key made the mesh's own: the Basis, with the user's shape keys carried along."""

from __future__ import annotations

from collections.abc import Collection

import bpy
import numpy as np

from ...core.deformation.vertex_turns import vertex_turns
from ..mesh_items.key_points import key_points
from ..mesh_items.key_removal import remove_drivers
from ..objects.mesh_reading import read_mesh


def make_basis(obj: bpy.types.Object, key: bpy.types.ShapeKey, shapes: Collection[str]) -> None:
    """Make a shape key the Basis, and remove it.

    Shape keys of the user change the shape as before, turned as the surface is.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode.
    key : bpy.types.ShapeKey
        Its key.
    shapes : collection of str
        Names of keys that are shapes of their own, not changes of one: they stay where they are.
    """
    mesh, keys = obj.data, obj.data.shape_keys
    before, faces = read_mesh(mesh)
    rest = key_points(key).astype(np.float64)
    turns = vertex_turns(before, rest, faces)
    known = {each.name: key_points(each).astype(np.float64) for each in keys.key_blocks}
    done = {keys.reference_key.name: rest, key.name: rest}

    def carried(each: bpy.types.ShapeKey) -> np.ndarray:
        if each.name not in done:
            done[each.name] = known[each.name]  # of keys that are relative to each other
            if each.name not in shapes:
                other = each.relative_key
                way = known[each.name] - known[other.name]
                done[each.name] = carried(other) + (way if other == key else np.einsum("ni,nij->nj", way, turns))
        return done[each.name]

    for each in keys.key_blocks:
        carried(each)
    for each in keys.key_blocks:
        if each.relative_key == key:
            each.relative_key = keys.reference_key
    for name, shape in done.items():
        keys.key_blocks[name].points.foreach_set("co", shape.astype(np.float32).ravel())
    mesh.vertices.foreach_set("co", rest.astype(np.float32).ravel())
    active = obj.active_shape_key.name if obj.active_shape_key not in (None, key) else keys.reference_key.name
    remove_drivers(key)
    obj.shape_key_remove(key)
    obj.active_shape_key_index = keys.key_blocks.find(active)
    mesh.update()
