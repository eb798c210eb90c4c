"""The pose at rest of a rig made the mesh's own: the Basis, with the user's shape keys carried along."""

from __future__ import annotations

import bpy

from ..mesh_items.fingerprints import key_fingerprint
from ..objects.object_states import object_mode
from ..records.record import read_record, write_record
from ..records.rig_record import RigRecord, read_rig, recorded_key, write_rig
from ..results.new_basis import make_basis


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
    forms = read_record(mesh)
    first = keys.reference_key
    added = forms is not None and (forms.basis, forms.basis_fingerprint) == (first.name, key_fingerprint(first))
    own = {*record.keys}
    if forms is not None:
        own |= {*forms.keys, *forms.in_between_keys}
    make_basis(obj, key, own)
    del record.keys[next(iter(record.keys))]
    record.pose = "NONE"
    if forms is not None and added:
        forms.basis_fingerprint = key_fingerprint(first)  # it is still the form's to remove
        write_record(mesh, forms)
    write_rig(mesh, record)
