"""The shape key that holds the form, and removing shape keys without leftovers."""

from __future__ import annotations

import bpy

from ..core import CanonicalFormError
from .fingerprints import key_fingerprint
from .record import read_record
from .wording import told


def form_key(mesh: bpy.types.Mesh) -> bpy.types.ShapeKey | None:
    """Find the form's shape key by its name; its content is not checked, which is fast enough for a panel.

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
    """Find the form's shape key, unless it has been removed or changed since it was written.

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
    """Find the form's shape key where there must be one.

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


def remove_drivers(key: bpy.types.ShapeKey) -> None:
    """Remove the drivers of a shape key before the key is removed: Blender would go on writing to freed memory.

    Parameters
    ----------
    key : bpy.types.ShapeKey
        The key.
    """
    data = key.id_data.animation_data
    path = f'key_blocks["{bpy.utils.escape_identifier(key.name)}"].'
    for curve in [each for each in data.drivers if each.data_path.startswith(path)] if data is not None else ():
        data.drivers.remove(curve)


def remove_all_keys(obj: bpy.types.Object) -> None:
    """Remove all shape keys of an object, including their data-block.

    Blender before 5.2 counts one user too many for the keys of a copied mesh and would keep their data-block forever.

    Parameters
    ----------
    obj : bpy.types.Object
        The object; its mesh has shape keys.
    """
    name = obj.data.shape_keys.name
    obj.shape_key_clear()
    left = [keys for keys in bpy.data.shape_keys if keys.name == name and keys.library is None]
    if left:
        bpy.data.batch_remove(left)
