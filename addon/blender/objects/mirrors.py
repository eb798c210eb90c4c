"""Mirror modifiers: the form of half a mesh is computed for the whole mesh that the modifier shows."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy

if TYPE_CHECKING:
    from ...core.mesh.mirroring import Mirror


def mirrors_of(obj: bpy.types.Object) -> list[Mirror]:
    """Return the mirrors of an object's enabled modifiers that the form includes.

    Parameters
    ----------
    obj : bpy.types.Object
        The object.

    Returns
    -------
    list of Mirror
        At most one per axis, without modifiers that bisect or have a mirror object.
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
    """Return whether the form includes the effect of a modifier even if it is computed from the base mesh.

    Parameters
    ----------
    modifier : bpy.types.Modifier
        The modifier.

    Returns
    -------
    bool
        True for a mirror modifier about the object's own origin that does not bisect.
    """
    if modifier.type != "MIRROR" or not modifier.show_viewport:
        return False
    return modifier.mirror_object is None and not any(modifier.use_bisect_axis)
