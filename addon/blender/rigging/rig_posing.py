"""Puts the armature that *Rig* made into the pose of the scan, or to rest."""

from __future__ import annotations

import bpy
import numpy as np
from mathutils import Matrix

from ..mesh_items.action_curves import curves_of
from ..records.rig_record import SCAN, read_rig, recorded_key
from .rig_clearing import bound_to

_FRAME = 1.0  # at which poses are keyed
_SAME = 1e-4  # of a rotation, or of a unit: what rounding does to a pose


def scan_pose_of(mesh: bpy.types.Mesh) -> bpy.types.Action | None:
    """Return the action that holds the pose of the scan.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        A mesh with an armature of *Rig*.

    Returns
    -------
    bpy.types.Action or None
        The action; None if the mesh rests as it was scanned, or the action was removed.
    """
    record = read_rig(mesh)
    return None if record is None or record.scan is None else bpy.data.actions.get(record.scan)


def take_pose(armature: bpy.types.Object, action: bpy.types.Action | None) -> list[str]:
    """Put an armature into a pose once, all its bones, and its meshes exactly into the shape of the scan.

    Parameters
    ----------
    armature : bpy.types.Object
        The armature.
    action : bpy.types.Action or None
        The pose of the scan; None for the pose at rest.

    Returns
    -------
    list of str
        What of the pose could not be taken, as bones were renamed or deleted: paths of the animation.
    """
    missing, values = [], []
    for curve in curves_of(action) if action is not None else ():  # Blender's own way takes selected bones only
        if _resolves(armature, curve.data_path):
            values.append((curve.data_path, curve.array_index, curve.evaluate(_FRAME)))
        else:
            missing.append(curve.data_path)
    for bone in armature.pose.bones:
        bone.matrix_basis = Matrix.Identity(4)
    for value in values:
        _set(armature, *value)
    for obj in bound_to(armature):
        record = read_rig(obj.data)
        for name, known in record.keys.items() if record is not None else ():
            key = recorded_key(obj.data, name, known) if name.startswith(SCAN) else None
            if key is not None:
                key.value = float(action is not None and not missing)
    return list(dict.fromkeys(missing))


def taken_pose(armature: bpy.types.Object, action: bpy.types.Action | None) -> str:
    """Tell which of its poses an armature is in.

    Parameters
    ----------
    armature : bpy.types.Object
        The armature.
    action : bpy.types.Action or None
        The pose of the scan.

    Returns
    -------
    {'REST', 'SCAN', ''}
        The pose at rest, that of the scan, or neither.
    """
    turned = np.array([bone.matrix_basis for bone in armature.pose.bones])  # (bones, 4, 4)
    if np.abs(turned - np.eye(4)).max() <= _SAME:
        return "REST"
    for curve in curves_of(action) if action is not None else ():
        try:
            now = armature.path_resolve(curve.data_path)
        except ValueError:  # a bone was renamed or deleted
            return ""
        value = now[curve.array_index] if hasattr(now, "__len__") else now
        if abs(value - curve.evaluate(_FRAME)) > _SAME:
            return ""
    return "" if action is None else "SCAN"


def _resolves(armature: bpy.types.Object, path: str) -> bool:
    """Return whether an armature has what a curve animates."""
    try:
        armature.path_resolve(path)
    except ValueError:
        return False
    return True


def _set(armature: bpy.types.Object, path: str, index: int, value: float) -> None:
    """Set what a curve animates: an element of a vector, a number, or a custom property."""
    if path.endswith('"]'):
        owner, _, name = path.rpartition('["')
        armature.path_resolve(owner)[name[:-2]] = value
        return
    owner, _, name = path.rpartition(".")
    target = armature.path_resolve(owner)
    now = getattr(target, name)
    if hasattr(now, "__len__"):
        now[index] = value
    else:
        setattr(target, name, value)
