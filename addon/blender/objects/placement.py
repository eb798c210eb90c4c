"""Where objects stand to each other: the transforms from their own spaces to one that they share."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
import numpy as np
from mathutils import Matrix, Vector

if TYPE_CHECKING:
    from ...core.numerics.arrays import FloatArray


def placement_of(obj: bpy.types.Object, deformed: bool) -> FloatArray:
    """Find the transform from an object's own space to the scene's.

    Parameters
    ----------
    obj : bpy.types.Object
        The object.
    deformed : bool
        Whether the object is where it is seen. Otherwise, as its armature does not bend the base mesh, an object that
        hangs on a bone is where it is in the rest position.

    Returns
    -------
    (4, 4) ndarray of float
        The transform, for columns.
    """
    return np.array(obj.matrix_world if deformed else _resting(obj))


def world_rotation(placement: FloatArray) -> FloatArray:
    """Find how an object is turned in the scene.

    Parameters
    ----------
    placement : (4, 4) ndarray of float
        Its transform, for columns.

    Returns
    -------
    (3, 3) ndarray of float
        The nearest proper rotation, for columns.
    """
    left, _, right = np.linalg.svd(placement[:3, :3])
    if np.linalg.det(left @ right) < 0:
        left[:, -1] *= -1
    return np.asarray(left @ right)


def _resting(obj: bpy.types.Object) -> Matrix:
    """Find the transform of an object with all armatures above it in the rest position."""
    if not _hangs_on_bone(obj):
        return obj.matrix_world
    parent = obj.parent
    above = _resting(parent)
    bone = parent.data.bones.get(obj.parent_bone) if obj.parent_type == "BONE" and parent.type == "ARMATURE" else None
    if bone is not None:  # children hang on the bone's tail
        above = above @ bone.matrix_local @ Matrix.Translation(Vector((0.0, bone.length, 0.0)))
    return above @ obj.matrix_parent_inverse @ obj.matrix_basis


def _hangs_on_bone(obj: bpy.types.Object) -> bool:
    """Return whether an object, or one that it is a child of, is the child of a bone."""
    above: bpy.types.Object | None = obj
    while above is not None and above.parent is not None:
        if above.parent_type == "BONE":
            return True
        above = above.parent
    return False
