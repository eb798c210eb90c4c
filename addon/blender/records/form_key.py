"""The shape key that holds the form, found by its name in the record, and whether it is unchanged."""

from __future__ import annotations

import bpy

from ...core import CanonicalFormError
from ..mesh_items.fingerprints import key_fingerprint
from ..words.wording import told
from .record import read_record


def form_key(mesh: bpy.types.Mesh) -> bpy.types.ShapeKey | None:
    """Return the form's shape key by its name; its content is not checked, so a panel can call this.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.

    Returns
    -------
    bpy.types.ShapeKey or None
        The key.
    """
    record = read_record(mesh)
    if record is None or mesh.shape_keys is None:
        return None
    for name in record.keys:
        key = mesh.shape_keys.key_blocks.get(name)
        if key is not None and key != mesh.shape_keys.reference_key:
            return key
    return None


def unchanged_form_key(mesh: bpy.types.Mesh) -> bpy.types.ShapeKey | None:
    """Return the form's shape key, unless it has been removed or changed since it was written.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.

    Returns
    -------
    bpy.types.ShapeKey or None
        The key.
    """
    key, record = form_key(mesh), read_record(mesh)
    if key is None or record is None or record.keys[key.name] != key_fingerprint(key):
        return None
    return key


def require_form_key(mesh: bpy.types.Mesh) -> bpy.types.ShapeKey:
    """Return the form's shape key, which must exist.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.

    Returns
    -------
    bpy.types.ShapeKey
        The key.

    Raises
    ------
    CanonicalFormError
        If it has been removed or changed.
    """
    key = unchanged_form_key(mesh)
    if key is None:
        raise CanonicalFormError(
            told("The shape key of the form was changed, renamed or removed. Compute the form again first.")
        )
    return key
