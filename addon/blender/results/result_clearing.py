"""Removes from a mesh exactly what the last run wrote to it."""

from __future__ import annotations

import bpy
import numpy as np

from ..mesh_items.active_items import active_items, active_keys_elsewhere, restore_active_items, restore_active_keys
from ..mesh_items.fingerprints import colour_fingerprint, fingerprint, group_fingerprints, key_fingerprint
from ..mesh_items.key_removal import remove_all_keys, remove_drivers
from ..mesh_items.slider import release
from ..objects.object_states import object_mode
from ..records.hidden_attributes import HIDDEN_CONTACTS, HIDDEN_FORM, HIDDEN_PATCHES
from ..records.record import Record, read_record, remove_record
from ..records.rig_record import read_rig, write_rig
from .edited_results import is_made_up, is_ours_by_name
from .in_betweens import remove_curves, remove_in_betweens


def clear_from(obj: bpy.types.Object) -> list[str]:
    """Remove the results of the last run from an object's mesh, in any mode.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, accepted by `refusal`.

    Returns
    -------
    list of str
        Names of results that stay because they may contain changes by the user.

    Raises
    ------
    CanonicalFormError
        If Blender cannot leave the object's mode.
    """
    with object_mode(obj):
        return clear_results(obj)


def clear_results(obj: bpy.types.Object, *, unconfirmed: bool = False) -> list[str]:
    """Remove the results of the last run from a mesh, and make the previously active items active.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode.
    unconfirmed : bool
        Whether to remove items without a fingerprint too: after a failed run, or from a copy.

    Returns
    -------
    list of str
        Names of results that stay because they may contain changes by the user.
    """
    mesh = obj.data
    record = read_record(mesh)
    if record is None:
        return []
    active, elsewhere = active_items(obj), active_keys_elsewhere(obj)
    left = remove_results(obj, record, unconfirmed=unconfirmed)
    restore_active_items(obj, active.replaced(record.written_items().without(left), by=record.active_before))
    restore_active_keys(elsewhere)
    mesh.update()
    return left


def remove_results(
    obj: bpy.types.Object, record: Record, *, keep_key: bool = False, unconfirmed: bool = False
) -> list[str]:
    """Remove the unchanged items of a record, and the record itself.

    Fingerprints identify unchanged items. Items without one stay, as the record may be from an untrusted file.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode.
    record : Record
        The record.
    keep_key : bool
        Keep the form's shape key and the Basis.
    unconfirmed : bool
        Whether to remove items without a fingerprint too: after a failed run, or from a copy.

    Returns
    -------
    list of str
        Names of items that stay because they may contain changes by the user.
    """
    mesh = obj.data
    release(mesh.shape_keys)
    left = remove_in_betweens(obj)
    if not keep_key:
        left += _remove_keys(obj, record, unconfirmed)
    found = group_fingerprints(obj, record.groups)
    made_up = is_made_up(obj, record)
    for name, known in record.groups.items():
        if name in found and (_is_ours(known, found[name], unconfirmed) or (made_up and is_ours_by_name(name))):
            obj.vertex_groups.remove(obj.vertex_groups[name])
        elif name in found:
            left.append(name)
    for name, known in record.colours.items():
        attribute = mesh.color_attributes.get(name)
        if attribute is not None and (
            _is_ours(known, colour_fingerprint(attribute), unconfirmed) or (made_up and is_ours_by_name(name))
        ):
            mesh.color_attributes.remove(attribute)
        elif attribute is not None:
            left.append(name)
    for hidden in (
        HIDDEN_PATCHES,
        HIDDEN_CONTACTS,
        HIDDEN_FORM,
    ):  # only our own names: a record may contain the name of any attribute
        if hidden.name in record.hidden and hidden.name in mesh.attributes:
            mesh.attributes.remove(mesh.attributes[hidden.name])
    remove_record(mesh)
    return left


def _is_ours(known: str | None, now: str, unconfirmed: bool) -> bool:
    """Return whether an item is unchanged since the run, or may be removed without a fingerprint."""
    return known == now or (unconfirmed and known is None)


def _remove_keys(obj: bpy.types.Object, record: Record, unconfirmed: bool) -> list[str]:
    """Remove the form's key, and the Basis if the run added it and no other key is left; return what is kept."""
    keys, left = obj.data.shape_keys, []
    for name, known in record.keys.items():
        key = keys.key_blocks.get(name) if keys is not None else None
        if key is None:
            continue
        if key != keys.reference_key and _is_ours(known, key_fingerprint(key), unconfirmed):
            remove_drivers(key)
            if record.keyframed:
                remove_curves(key)
            obj.shape_key_remove(key)
        else:
            left.append(name)
    if keys is not None and len(keys.key_blocks) == 1 and _is_own_basis(obj.data, record):
        remove_all_keys(obj)
    elif keys is not None and _is_own_basis(obj.data, record):
        _hand_over_basis(obj.data)
    return left


def _hand_over_basis(mesh: bpy.types.Mesh) -> None:
    """Let the rig remove the Basis that the form has added, as its keys still need it."""
    rig = read_rig(mesh)
    if rig is not None:
        rig.basis = True
        write_rig(mesh, rig)


def _is_own_basis(mesh: bpy.types.Mesh, record: Record) -> bool:
    """Return whether the Basis was added by the run and is unchanged, so that it can be removed."""
    basis = mesh.shape_keys.reference_key
    points = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    mesh.vertices.foreach_get("co", points)
    now = key_fingerprint(basis)
    return basis.name == record.basis and now == fingerprint(points) and record.basis_fingerprint in (None, now)
