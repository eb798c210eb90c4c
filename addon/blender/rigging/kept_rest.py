"""The pose at rest of a rig made the mesh's own: the Basis, with the user's shape keys carried along."""

from __future__ import annotations

import bpy
import numpy as np

from ...core.deformation.vertex_turns import vertex_turns
from ..mesh_items.fingerprints import key_fingerprint
from ..mesh_items.key_points import key_points
from ..mesh_items.key_removal import remove_drivers
from ..objects.mesh_reading import read_mesh
from ..objects.object_states import object_mode
from ..records.record import read_record
from ..records.rig_record import RigRecord, read_rig, recorded_key, write_rig


def rest_key(obj: bpy.types.Object) -> bpy.types.ShapeKey | None:
    """Find the key that holds the pose at rest of an object's rig.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, of type MESH.

    Returns
    -------
    bpy.types.ShapeKey or None
        The key; None if the object rests as it is.
    """
    record = read_rig(obj.data)
    if record is None or record.pose == "NONE" or not record.keys:
        return None
    name, known = next(iter(record.keys.items()))
    return recorded_key(obj.data, name, known)


def keep_rest(obj: bpy.types.Object) -> None:
    """Make the pose at rest of an object's rig its Basis.

    Shape keys of the user change the shape as before, turned as the surface is; the key of the scan stays.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, with such a key.

    Raises
    ------
    CanonicalFormError
        If Blender cannot leave the object's mode.
    """
    key, record = rest_key(obj), read_rig(obj.data)
    if key is None or record is None:
        return
    with object_mode(obj):
        _keep(obj, key, record)


def _keep(obj: bpy.types.Object, key: bpy.types.ShapeKey, record: RigRecord) -> None:
    """Write the new Basis, in Object Mode."""
    mesh, keys = obj.data, obj.data.shape_keys
    before, faces = read_mesh(mesh)
    rest = key_points(key).astype(np.float64)
    turns = vertex_turns(before, rest, faces)
    forms = read_record(mesh)
    own = {
        *record.keys,
        *(() if forms is None else (*forms.keys, *forms.in_between_keys)),
    }  # shapes, not changes of one
    shapes = {each.name: key_points(each).astype(np.float64) for each in keys.key_blocks}
    done = {keys.reference_key.name: rest, key.name: rest}

    def carried(each: bpy.types.ShapeKey) -> np.ndarray:
        if each.name not in done:
            done[each.name] = shapes[each.name]  # of keys that are relative to each other
            if each.name not in own:
                other = each.relative_key
                way = shapes[each.name] - shapes[other.name]
                on_rest = carried(other) is rest and other == key
                done[each.name] = carried(other) + (way if on_rest else np.einsum("ni,nij->nj", way, turns))
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
    name, _ = next(iter(record.keys.items()))
    remove_drivers(key)
    obj.shape_key_remove(key)
    obj.active_shape_key_index = keys.key_blocks.find(active)
    del record.keys[name]
    for each in record.keys:
        found = keys.key_blocks.get(each)
        if found is not None:
            record.keys[each] = key_fingerprint(found)
    record.pose = "NONE"
    write_rig(mesh, record)
    mesh.update()
