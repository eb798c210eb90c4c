"""Mirror modifiers: of half a mesh the form is that of the whole, which the modifier shows."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy

if TYPE_CHECKING:
    from ...core.mesh.mirroring import Mirror


def mirrors_of(obj: bpy.types.Object) -> list[Mirror]:
    """List the mirrors that the shown modifiers of an object hold up to its base mesh.

    Parameters
    ----------
    obj : bpy.types.Object
        The object.

    Returns
    -------
    list of Mirror
        One for each axis; without those about another object, those that cut, and second ones across an axis.
    """
    from ...core.mesh.mirroring import Mirror

    found: dict[int, Mirror] = {}
    for modifier in obj.modifiers:
        if is_followed(modifier):
            merge = modifier.merge_threshold if modifier.use_mirror_merge else -1.0
            for axis in range(3):
                if modifier.use_axis[axis]:
                    found.setdefault(axis, Mirror(axis, merge))
    return list(found.values())


def is_followed(modifier: bpy.types.Modifier) -> bool:
    """Return whether the form is that of the mesh with this modifier, also where it is of the base mesh.

    Parameters
    ----------
    modifier : bpy.types.Modifier
        The modifier.

    Returns
    -------
    bool
        True for a mirror through the object's own origin that cuts nothing.
    """
    if modifier.type != "MIRROR" or not modifier.show_viewport:
        return False
    return modifier.mirror_object is None and not any(modifier.use_bisect_axis)
