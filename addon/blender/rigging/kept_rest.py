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
from ..records.record import read_record, write_record
from ..records.rig_record import RigRecord, read_rig, recorded_key, write_rig


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
    record = read_rig(obj.data)
    rest = None if record is None else record.rest
    key = None if rest is None else recorded_key(obj.data, *rest)
    if record is None or key is None:
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
    first = keys.reference_key
    added = forms is not None and (forms.basis, forms.basis_fingerprint) == (first.name, key_fingerprint(first))
    own = {*record.keys}  # shapes, not changes of one
    if forms is not None:
        own |= {*forms.keys, *forms.in_between_keys}
    shapes = {each.name: key_points(each).astype(np.float64) for each in keys.key_blocks}
    done = {keys.reference_key.name: rest, key.name: rest}

    def carried(each: bpy.types.ShapeKey) -> np.ndarray:
        if each.name not in done:
            done[each.name] = shapes[each.name]  # of keys that are relative to each other
            if each.name not in own:
                other = each.relative_key
                way = shapes[each.name] - shapes[other.name]
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
    del record.keys[next(iter(record.keys))]
    remove_drivers(key)
    obj.shape_key_remove(key)
    obj.active_shape_key_index = keys.key_blocks.find(active)
    record.pose = "NONE"
    if forms is not None and added:
        forms.basis_fingerprint = key_fingerprint(first)  # it is still the form's to remove
        write_record(mesh, forms)
    write_rig(mesh, record)
    mesh.update()
