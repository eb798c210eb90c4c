"""The record on a mesh of items transferred from other objects; another run replaces those that nobody has changed."""

from __future__ import annotations

import json

import bpy

from ..mesh_items.fingerprints import colour_fingerprint, group_fingerprints, key_fingerprint, uv_fingerprint
from ..mesh_items.key_removal import remove_drivers
from .stored_values import named, words

TRANSFERS_PROPERTY = "canonical_form_transfers"
REST = "Rest of {}"
KINDS = ("groups", "uvs", "colours", "keys", "rigs")

Written = dict[str, dict[str, str]]  # by kind: fingerprints by name


def read_transfers(mesh: bpy.types.Mesh) -> Written:
    """Read the record of transferred items.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.

    Returns
    -------
    dict of str to dict of str to str
        For each of `KINDS`, the fingerprints by name.
    """
    text = mesh.get(TRANSFERS_PROPERTY)
    try:
        known = named(lambda prints: named(words, prints), json.loads(text) if isinstance(text, str) else {})
        return {kind: known.get(kind, {}) for kind in KINDS}
    except (ValueError, RecursionError):  # a property of that name from the user, or from an untrusted file
        return {kind: {} for kind in KINDS}


def rest_key(mesh: bpy.types.Mesh) -> bpy.types.ShapeKey | None:
    """Find the key that puts a mesh into the rest pose of the rig that it has taken over.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.

    Returns
    -------
    bpy.types.ShapeKey or None
        The key that was transferred last, as it is now.
    """
    if mesh.shape_keys is None:
        return None
    blocks = mesh.shape_keys.key_blocks
    names = [name for name in read_transfers(mesh)["keys"] if name.startswith(REST.format("")) and name in blocks]
    return blocks[names[-1]] if names else None


def write_transfers(mesh: bpy.types.Mesh, written: Written) -> None:
    """Write the record of transferred items to a mesh.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.
    written : dict of str to dict of str to str
        For each of `KINDS`, the fingerprints by name.
    """
    mesh[TRANSFERS_PROPERTY] = json.dumps(written)


def make_room(
    obj: bpy.types.Object, kind: str, names: list[str], written: Written, *, refill: bool = False
) -> list[str]:
    """Remove unchanged items of an earlier transfer, and return the names that are still in use.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode.
    kind : str
        One of `KINDS`.
    names : list of str
        Names to be written.
    written : dict of str to dict of str to str
        The record; removed items are deleted from it.
    refill : bool
        Keep unchanged items, with drivers, masks and whatever else depends on them; their values will be replaced.

    Returns
    -------
    list of str
        Names used by the user's own items.
    """
    known, left = written[kind], []
    groups = group_fingerprints(obj, {name: known.get(name) for name in names}) if kind == "groups" else {}
    for name in names:
        now = groups.get(name) if kind == "groups" else _fingerprint(obj, kind, name)
        if now is not None and known.get(name) == now:
            if not refill:
                _remove(obj, kind, name)
        elif now is not None:
            left.append(name)
            continue
        known.pop(name, None)
    return left


def _fingerprint(obj: bpy.types.Object, kind: str, name: str) -> str | None:
    """Return the fingerprint of an item; None if there is none of that name."""
    mesh = obj.data
    if kind == "uvs":
        return uv_fingerprint(mesh.uv_layers[name]) if name in mesh.uv_layers else None
    if kind == "colours":
        return colour_fingerprint(mesh.color_attributes[name]) if name in mesh.color_attributes else None
    if kind == "rigs":
        rig = getattr(obj.modifiers.get(name), "object", None)
        return None if rig is None else str(rig.name)
    keys = {} if mesh.shape_keys is None else mesh.shape_keys.key_blocks
    return key_fingerprint(keys[name]) if name in keys else None


def _remove(obj: bpy.types.Object, kind: str, name: str) -> None:
    """Remove an item."""
    mesh = obj.data
    if kind == "groups":
        obj.vertex_groups.remove(obj.vertex_groups[name])
    elif kind == "uvs":
        mesh.uv_layers.remove(mesh.uv_layers[name])
    elif kind == "colours":
        mesh.color_attributes.remove(mesh.color_attributes[name])
    elif kind == "rigs":
        obj.modifiers.remove(obj.modifiers[name])
    else:
        key = mesh.shape_keys.key_blocks[name]
        remove_drivers(key)
        obj.shape_key_remove(key)
