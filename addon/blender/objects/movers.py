"""What moves a mesh away from how it was modelled: a rig, its own shape keys, modifiers."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from ..records.record import read_record
from .object_warnings import bending_keys

_DEFORMING = {
    "ARMATURE", "CAST", "CLOTH", "CORRECTIVE_SMOOTH", "CURVE", "DISPLACE", "HOOK", "LAPLACIANDEFORM", "LATTICE",
    "MESH_CACHE", "MESH_DEFORM", "MESH_SEQUENCE_CACHE", "SHRINKWRAP", "SIMPLE_DEFORM", "SMOOTH", "LAPLACIANSMOOTH",
    "SOFT_BODY", "SURFACE_DEFORM", "WARP", "WAVE",
}  # fmt: skip
_STILL = 1e-4  # change of a direction, or of a place in sizes of the armature, below which a bone rests


def armature_of(obj: bpy.types.Object) -> bpy.types.Object | None:
    """Return the armature that deforms an object.

    Parameters
    ----------
    obj : bpy.types.Object
        The object.

    Returns
    -------
    bpy.types.Object or None
        The armature of its first enabled Armature modifier that has one, else the one that its bone or it hangs on.
    """
    for modifier in obj.modifiers:
        if modifier.type == "ARMATURE" and modifier.show_viewport and modifier.object is not None:
            return modifier.object
    above = obj.parent
    return above if above is not None and above.type == "ARMATURE" and obj.parent_type == "BONE" else None


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
    if rig is not None and is_posed(rig):
        return True
    modifiers = [each.type for each in obj.modifiers if each.show_viewport and each.type != "ARMATURE"]
    return not _DEFORMING.isdisjoint(modifiers) or _is_pinned(obj) or bool(bending_keys(obj))


def is_posed(rig: bpy.types.Object) -> bool:
    """Return whether the bones of an armature are elsewhere than at rest.

    Parameters
    ----------
    rig : bpy.types.Object
        The armature.

    Returns
    -------
    bool
        True if one of them is.
    """
    if rig.data.pose_position == "REST" or rig.pose is None:
        return False
    size = max(max(rig.dimensions), 1e-6)
    return any(_lies_elsewhere(bone, size) for bone in rig.pose.bones)


def _lies_elsewhere(bone: bpy.types.PoseBone, size: float) -> bool:
    """Return whether a bone is not at rest; `size`: of the armature."""
    turn = bone.matrix.to_3x3() - bone.bone.matrix_local.to_3x3()
    moved = (bone.matrix.translation - bone.bone.matrix_local.translation).length
    return moved > _STILL * size or max(row.length for row in turn) > _STILL


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


def _is_pinned(obj: bpy.types.Object) -> bool:
    """Return whether a shape key that is not of an earlier run is shown alone."""
    keys = obj.data.shape_keys
    if keys is None or not obj.show_only_shape_key or obj.active_shape_key in (None, keys.reference_key):
        return False
    record = read_record(obj.data)
    return record is None or obj.active_shape_key.name not in {*record.keys, *record.in_between_keys}
