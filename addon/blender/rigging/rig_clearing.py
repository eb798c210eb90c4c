"""Removes an armature that was given to a body, with what binds the body to it, and nothing else."""

from __future__ import annotations

import bpy

from ..mesh_items.active_items import active_items, existing_items, restore_active_items
from ..mesh_items.fingerprints import group_fingerprints, key_fingerprint
from ..mesh_items.key_removal import remove_all_keys, remove_drivers
from ..objects.object_states import object_mode
from ..records.rig_record import RigRecord, read_rig, remove_rig_record
from .armatures import bones_fingerprint, remove_armature


def bound_to(name: str) -> list[bpy.types.Object]:
    """List the objects that were given an armature.

    Parameters
    ----------
    name : str
        Name of the armature object.

    Returns
    -------
    list of bpy.types.Object
        The objects whose records name it.
    """
    found = []
    for obj in bpy.data.objects:
        record = read_rig(obj.data) if obj.type == "MESH" and obj.library is None else None
        if record is not None and record.armature == name:
            found.append(obj)
    return found


def remove_rig(name: str) -> list[str]:
    """Remove an armature from the objects that it was given to, and itself, unless the user has changed its bones.

    Parameters
    ----------
    name : str
        Name of the armature object.

    Returns
    -------
    list of str
        Names of what stays because it may contain changes by the user.

    Raises
    ------
    CanonicalFormError
        If Blender cannot leave the mode of an object.
    """
    armature, objects = bpy.data.objects.get(name), bound_to(name)
    records = [read_rig(obj.data) for obj in objects]
    kept, left = armature is not None and _is_changed(armature, objects, records), []
    if kept:
        left.append(name)
    for obj, record in zip(objects, records, strict=True):
        if record is not None:
            with object_mode(obj):
                left += _unbind(obj, record, None if kept else armature)
    if armature is not None and not kept:
        remove_armature(armature)
    for action in {each for record in records if record is not None for each in record.actions}:
        found = bpy.data.actions.get(action)
        if found is not None and not kept and found.users <= int(found.use_fake_user):
            bpy.data.actions.remove(found)
    return left


def _is_changed(armature: bpy.types.Object, objects: list[bpy.types.Object], records: list[RigRecord | None]) -> bool:
    """Return whether the user has changed the bones, or hung something else on them."""
    if armature.type != "ARMATURE" or any(r is None or r.bones != bones_fingerprint(armature) for r in records):
        return True
    others = [each for each in bpy.data.objects if each not in objects and each != armature]
    return any(
        each.parent == armature or any(getattr(modifier, "object", None) == armature for modifier in each.modifiers)
        for each in others
    )


def _unbind(obj: bpy.types.Object, record: RigRecord, armature: bpy.types.Object | None) -> list[str]:
    """Remove from an object what binds it; the armature is None where it stays."""
    active, left = active_items(obj), []
    modifier = obj.modifiers.get(record.modifier)
    if armature is not None and modifier is not None and getattr(modifier, "object", None) == armature:
        obj.modifiers.remove(modifier)
    if armature is not None and record.parented and obj.parent == armature:
        place = obj.matrix_basis.copy()
        obj.parent = None
        obj.matrix_parent_inverse.identity()
        obj.matrix_basis = place
    prints = group_fingerprints(obj, record.groups) if armature is not None else {}
    for name, known in record.groups.items() if armature is not None else ():
        if prints.get(name) == known:
            obj.vertex_groups.remove(obj.vertex_groups[name])
        elif name in prints:
            left.append(name)
    keys = obj.data.shape_keys
    for name, known in reversed(record.keys.items()) if armature is not None and keys is not None else ():
        key = keys.key_blocks.get(name)
        if key is not None and key != keys.reference_key and key_fingerprint(key) == known:
            remove_drivers(key)
            obj.shape_key_remove(key)
        elif key is not None:
            left.append(name)
    if keys is not None and record.basis and len(keys.key_blocks) == 1:
        remove_all_keys(obj)
    remove_rig_record(obj.data)
    restore_active_items(obj, active.kept(existing_items(obj), otherwise=active_items(obj)))
    obj.data.update()
    return left
