"""Removes shape keys without leftovers."""

from __future__ import annotations

import bpy


def remove_drivers(key: bpy.types.ShapeKey) -> None:
    """Remove the drivers of a shape key before the key is removed; otherwise Blender writes to freed memory.

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

    Blender before 5.2 counts one user too many for the keys of a copied mesh and would never remove their data-block.

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
