"""Warnings about parts of an object that its form leaves out."""

from __future__ import annotations

import bpy
import numpy as np

from .mirrors import is_followed
from .wording import told

_ADDING = (
    "ARRAY",
    "BOOLEAN",
    "BUILD",
    "MASK",
    "MIRROR",
    "NODES",
    "REMESH",
    "SCREW",
    "SKIN",
    "SOLIDIFY",
    "VOLUME_TO_MESH",
)
_BENDING = (
    "CAST",
    "CURVE",
    "DISPLACE",
    "HOOK",
    "LATTICE",
    "MESH_DEFORM",
    "SHRINKWRAP",
    "SIMPLE_DEFORM",
    "SURFACE_DEFORM",
    "WARP",
    "WAVE",
)


def object_warnings(obj: bpy.types.Object, deformed: bool, *, scaled: bool = False) -> list[str]:
    """List what the form of an object leaves out: its scale and modifiers.

    Parameters
    ----------
    obj : bpy.types.Object
        The object.
    deformed : bool
        Whether the form is computed of the evaluated mesh, not of the base mesh.
    scaled : bool
        Whether the form is computed with the object's scale, together with other objects.

    Returns
    -------
    list of str
        Sentences that name the remedy.
    """
    warnings = []
    scale = np.abs(np.array(obj.matrix_world.to_scale()))
    if not scaled and scale.max() > 1.001 * scale.min():
        warnings.append(
            told(
                "The scale of {name} is not uniform, and the form was computed on the mesh without "
                "it. Apply the scale (Ctrl+A > Scale) and run again for the form of what you see.",
                name=obj.name,
            )
        )
    modifiers = [] if deformed else [each for each in obj.modifiers if each.show_viewport]
    bending = [each.name for each in modifiers if each.type in _BENDING or (each.type == "ARMATURE" and _in_pose(each))]
    if bending:
        warnings.append(
            told(
                "Some modifiers of {name} bend the form as they bend the mesh: {bending}. Set Mesh "
                "to As Shown to take out the pose that you see.",
                name=obj.name,
                bending=", ".join(bending),
            )
        )
    adding = [each.name for each in modifiers if each.type in _ADDING and not is_followed(each)]
    if adding:
        warnings.append(
            told(
                "Some modifiers of {name} add to the mesh, and the form is of it without them: "
                "{adding}. Apply them, or set Mesh to As Shown.",
                name=obj.name,
                adding=", ".join(adding),
            )
        )
    return warnings


def _in_pose(modifier: bpy.types.ArmatureModifier) -> bool:
    rig = modifier.object
    if rig is None or rig.data.pose_position == "REST":
        return False
    rest = np.eye(4)
    return any(not np.allclose(np.array(bone.matrix_basis), rest, atol=1e-4) for bone in rig.pose.bones)
