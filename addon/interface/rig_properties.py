"""What a rig is made from, and how it rests, as Blender properties of the panel and of the operator."""

# no `from __future__ import annotations`: Blender reads the annotations below as properties

from typing import Any

from bpy.props import BoolProperty, EnumProperty, StringProperty

from ..blender.words.wording import CONTEXT

_RESTS = (
    ("NONE", "As It Stands", "The mesh rests as it is"),
    ("T", "T-Pose", "It rests with arms held out sideways; the scan stays as the Basis"),
    ("A", "A-Pose", "It rests with arms lowered by 45 degrees; the scan stays as the Basis"),
    ("REFERENCE", "As the Reference", "It rests in the pose in which the reference rests; the scan stays as the Basis"),
)
_NAMES = (
    ("RIGIFY", "Rigify", "Those of Blender's Rigify: upper_arm.L"),
    ("MIXAMO", "Mixamo", "Those of Mixamo, whose animations then fit: mixamorig:LeftArm"),
    ("UNREAL", "Unreal", "Those of the Unreal Engine: upperarm_l"),
    ("VRM", "VRM", "Those of VRM and Unity's humanoid: leftUpperArm"),
)


def _rig_properties(prefix: str) -> dict[str, Any]:
    """List the properties by name."""
    return {
        f"{prefix}like": StringProperty(
            name="Bones From",
            translation_context=CONTEXT,
            description="Object that lends its bones: an armature, or one of its meshes; empty for a human mannequin",
        ),
        f"{prefix}rest": EnumProperty(
            name="Rest",
            translation_context=CONTEXT,
            description="The pose in which the mesh and its bones rest",
            items=_RESTS,
            default="T",
        ),
        f"{prefix}equal": BoolProperty(
            name="Equal Left and Right",
            translation_context=CONTEXT,
            description="Make bones of the left and the right side equally long",
            default=True,
        ),
        f"{prefix}names": EnumProperty(
            name="Names",
            translation_context=CONTEXT,
            description="How the bones of the mannequin are called, so that animations of other programs find them",
            items=_NAMES,
            default="RIGIFY",
        ),
        f"{prefix}rigify": BoolProperty(
            name="Rigify",
            translation_context=CONTEXT,
            description="Generate Rigify's rig, with its controls, on the bones of the mannequin",
            default=False,
        ),
    }


class RigProperties:
    """The choices of the panel, kept with the scene."""

    __annotations__ = _rig_properties("rig_")


class RigOptions:
    """The same as options of an operator."""

    __annotations__ = _rig_properties("")
