"""Transforms from the local spaces of objects to a shared space."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
import numpy as np
from mathutils import Matrix, Vector

if TYPE_CHECKING:
    from ...core.numerics.arrays import FloatArray


def placement_of(obj: bpy.types.Object, deformed: bool) -> FloatArray:
    """Return the transform from an object's local space to world space.

    Parameters
    ----------
    obj : bpy.types.Object
        The object.
    deformed : bool
        Whether to use the current transform. Otherwise an object parented to a bone is placed as in the rest position,
        as its armature does not deform the base mesh.

    Returns
    -------
    (4, 4) ndarray of float
        The transform, for column vectors.
    """
    _evaluate(obj)
    return np.array(obj.matrix_world if deformed else _resting(obj))


def world_rotation(placement: FloatArray) -> FloatArray:
    """Return the rotation of an object in the scene.

    Parameters
    ----------
    placement : (4, 4) ndarray of float
        Its transform, for column vectors.

    Returns
    -------
    (3, 3) ndarray of float
        The nearest proper rotation, for column vectors.
    """
    left, _, right = np.linalg.svd(placement[:3, :3])
    if np.linalg.det(left @ right) < 0:
        left[:, -1] *= -1
    return np.asarray(left @ right)


def _evaluate(obj: bpy.types.Object) -> None:
    """Have Blender compute the transform of an object outside the view layer; until then it lies at the origin.

    The object itself stays out of the temporary scene, as Blender would compute its modifiers, too.
    """
    if obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).is_evaluated:
        return
    scene, follower = bpy.data.scenes.new("Placement"), bpy.data.objects.new("Placement", None)
    try:
        scene.frame_current = bpy.context.scene.frame_current
        scene.collection.objects.link(follower)
        follower.constraints.new("COPY_TRANSFORMS").target = obj
        scene.view_layers[0].update()
    finally:
        bpy.data.batch_remove([scene, follower])


def _resting(obj: bpy.types.Object) -> Matrix:
    """Return the transform of an object with all parent armatures in the rest position."""
    if not _hangs_on_bone(obj):
        return obj.matrix_world
    parent = obj.parent
    above = _resting(parent)
    bone = parent.data.bones.get(obj.parent_bone) if obj.parent_type == "BONE" and parent.type == "ARMATURE" else None
    if bone is not None:  # children are attached to the bone's tail
        above = above @ bone.matrix_local @ Matrix.Translation(Vector((0.0, bone.length, 0.0)))
    return above @ obj.matrix_parent_inverse @ obj.matrix_basis


def _hangs_on_bone(obj: bpy.types.Object) -> bool:
    """Return whether an object or one of its parents is parented to a bone."""
    above: bpy.types.Object | None = obj
    while above is not None and above.parent is not None:
        if above.parent_type == "BONE":
            return True
        above = above.parent
    return False
