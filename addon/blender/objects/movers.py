"""What moves a mesh away from how it was modelled: a rig, its own shape keys, modifiers."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np

from ..mesh_items.key_points import key_points
from ..records.record import read_record

_BENDING = (
    "CAST",
    "CLOTH",
    "CURVE",
    "DISPLACE",
    "HOOK",
    "LAPLACIANDEFORM",
    "LAPLACIANSMOOTH",
    "LATTICE",
    "MESH_CACHE",
    "MESH_DEFORM",
    "MESH_SEQUENCE_CACHE",
    "SHRINKWRAP",
    "SIMPLE_DEFORM",
    "SMOOTH",
    "SOFT_BODY",
    "SURFACE_DEFORM",
    "WARP",
    "WAVE",
)
_LEAST_VALUE = 1e-3  # of a shape key that visibly deforms the object
_POSED = 1e-3  # change of a bone that poses a mesh: of its axes, and of its place over the size of the armature


def armature_of(obj: bpy.types.Object) -> bpy.types.Object | None:
    """Return the armature that moves an object.

    Parameters
    ----------
    obj : bpy.types.Object
        The object.

    Returns
    -------
    bpy.types.Object or None
        The armature of its first enabled Armature modifier that has one, else the one that deforms it as its parent, or
        on whose bone it hangs.
    """
    for modifier in obj.modifiers:
        if modifier.type == "ARMATURE" and modifier.show_viewport and modifier.object is not None:
            return modifier.object
    above = obj.parent
    held = above is not None and above.type == "ARMATURE" and obj.parent_type in ("BONE", "ARMATURE")
    return above if held else None


def is_moved(obj: bpy.types.Object) -> bool:
    """Return whether an object shows another shape than its base mesh.

    Parameters
    ----------
    obj : bpy.types.Object
        A mesh object.

    Returns
    -------
    bool
        True if a posed rig, a shape key of the user's, or a modifier that deforms moves it.
    """
    rig = armature_of(obj)
    on_bone = rig is not None and obj.parent_type == "BONE" and is_posed(rig)
    if on_bone or bending_modifiers(obj) or _is_pinned(obj) or _has_nodes(obj):
        return True
    return any(_bends(key) for key in _added_keys(obj))


def _has_nodes(obj: bpy.types.Object) -> bool:
    """Return whether geometry nodes may move the vertices: those that add some make another mesh."""
    if not any(each.type == "NODES" and each.show_viewport for each in obj.modifiers):
        return False
    shown = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    return len(shown.vertices) == len(obj.data.vertices)


def is_any_moved(objects: Sequence[bpy.types.Object]) -> bool:
    """Return whether one of the objects is moved.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        Mesh objects.

    Returns
    -------
    bool
        As `is_moved`.
    """
    return any(is_moved(obj) for obj in objects)


def is_posed(rig: bpy.types.Object | None) -> bool:
    """Return whether an armature is posed, by its bones or by their constraints.

    Parameters
    ----------
    rig : bpy.types.Object or None
        The armature.

    Returns
    -------
    bool
        True if one of its bones is elsewhere than at rest.
    """
    if rig is None or rig.data.pose_position == "REST" or rig.pose is None:
        return False
    size = max(rig.dimensions) or 1.0
    for bone in rig.pose.bones:
        turned = np.array(bone.matrix) - np.array(bone.bone.matrix_local)
        if np.abs(turned[:3, :3]).max() > _POSED or np.abs(turned[:3, 3]).max() > _POSED * size:
            return True
    return False


def bending_keys(obj: bpy.types.Object) -> list[str]:
    """Return the names of the user's shape keys that currently move an object away from its Basis."""
    return [key.name for key in _added_keys(obj) if _bends(key)]


def _added_keys(obj: bpy.types.Object) -> list[bpy.types.ShapeKey]:
    """List the user's shape keys that add up to what the object shows."""
    keys = obj.data.shape_keys
    adding = keys is not None and keys.use_relative and not obj.show_only_shape_key
    return users_keys(obj.data) if adding else []


def users_keys(mesh: bpy.types.Mesh) -> list[bpy.types.ShapeKey]:
    """List the shape keys of a mesh but the Basis and ours."""
    keys, record = mesh.shape_keys, read_record(mesh)
    if keys is None:
        return []
    ours = () if record is None else (*record.keys, *record.in_between_keys)
    return [key for key in keys.key_blocks if key != keys.reference_key and key.name not in ours]


def _bends(key: bpy.types.ShapeKey) -> bool:
    """Return whether a shape key currently moves vertices."""
    if key.mute or abs(key.value) <= _LEAST_VALUE:
        return False
    return bool((key_points(key) != key_points(key.relative_key)).any())


def bending_modifiers(obj: bpy.types.Object) -> list[str]:
    """Return the names of the enabled modifiers, and of the parent, that deform the object."""
    return _bending_parent(obj) + [
        each.name
        for each in obj.modifiers
        if each.show_viewport and (each.type in _BENDING or (each.type == "ARMATURE" and is_posed(each.object)))
    ]


def _bending_parent(obj: bpy.types.Object) -> list[str]:
    """Return the name of the parent if the object is bent by it, without a modifier."""
    parent = obj.parent
    if parent is None or obj.parent_type not in ("ARMATURE", "LATTICE", "CURVE") or obj.parent_type != parent.type:
        return []
    return [parent.name] if parent.type != "ARMATURE" or is_posed(parent) else []


def _is_pinned(obj: bpy.types.Object) -> bool:
    """Return whether a shape key that is not of an earlier run is shown alone."""
    keys = obj.data.shape_keys
    if keys is None or not obj.show_only_shape_key or obj.active_shape_key in (None, keys.reference_key):
        return False
    record = read_record(obj.data)
    return record is None or obj.active_shape_key.name not in {*record.keys, *record.in_between_keys}
