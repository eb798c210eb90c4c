"""The choices made in the panel, kept with the object that they are about."""

# no `from __future__ import annotations`: Blender reads the annotations below as properties

from typing import Any

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty, PointerProperty

from ..blender.jobs.meant_objects import meant_object
from ..blender.jobs.pose_reading import may_be_reference
from ..blender.objects.chosen_features import CHOSEN_GROUP
from ..blender.objects.rest_reading import rigs_of
from ..blender.records.record import read_record
from ..blender.results.companions import companions_of
from ..blender.words.wording import CONTEXT
from .properties import (
    DISTANCES,
    MESH_ITEMS,
    METHOD_NAMES,
    PART_ITEMS,
    REQUEST_NAMES,
    TRANSFER_ITEMS,
    MethodProperties,
    RequestProperties,
    TransferProperties,
    chosen_value,
    transfer_flag,
)
from .rig_properties import RigProperties

_POINTERS = ("reference", "like", "rig_like")


def _offers_pose(choices: Any, obj: bpy.types.Object) -> bool:
    """Whether an object may show the pose that is wanted: any mesh but the own one, or an armature for its meshes."""
    return obj != choices.id_data and may_be_reference(obj)


def _offers_form(_choices: Any, obj: bpy.types.Object) -> bool:
    """Whether an object has a form to refer to."""
    record = read_record(obj.data) if obj.type == "MESH" else None
    return record is not None and record.report.has_form


def _offers_bones(choices: Any, obj: bpy.types.Object) -> bool:
    """Whether an object lends bones: an armature, or a mesh that one moves."""
    return obj != choices.id_data and (obj.type == "ARMATURE" or (obj.type == "MESH" and len(rigs_of(obj)) == 1))


class CanonicalFormChoices(
    MethodProperties, RequestProperties, TransferProperties, RigProperties, bpy.types.PropertyGroup
):
    """The choices made in the panel for an object."""

    mesh: EnumProperty(  # type: ignore[valid-type]
        name="Mesh",
        translation_context=CONTEXT,
        description="Mesh that the form is computed from",
        items=MESH_ITEMS,
        default="AUTO",
    )
    reference: PointerProperty(  # type: ignore[valid-type]
        name="Reference",
        translation_context=CONTEXT,
        type=bpy.types.Object,
        poll=_offers_form,
        description="Object with a form of the same or a like body: the form is turned as that one is, and its limbs "
        "are numbered and coloured alike",
    )
    like: PointerProperty(  # type: ignore[valid-type]
        name="Like",
        translation_context=CONTEXT,
        type=bpy.types.Object,
        poll=_offers_pose,
        description="Object with a similar body in the pose that is wanted; its mesh may differ",
    )
    rig_like: PointerProperty(  # type: ignore[valid-type]
        name="Bones From",
        translation_context=CONTEXT,
        type=bpy.types.Object,
        poll=_offers_bones,
        description="Object that lends its bones: an armature, or one of its meshes; empty for a human mannequin",
    )
    feature_source: EnumProperty(  # type: ignore[valid-type]
        name="Feature Points From",
        translation_context=CONTEXT,
        description="Where the feature points come from",
        items=(
            ("DETECTED", "Body", "Those of the body above: found, or fixed by hand"),
            ("GROUP", "Vertex Group", "From a vertex group, one vertex per limb"),
        ),
        default="DETECTED",
    )
    anyway: BoolProperty(  # type: ignore[valid-type]
        name="Write Anyway",
        translation_context=CONTEXT,
        description="Keep a T-Pose, an A-Pose, a rig or data of another body that are unlikely to be right, too",
        default=False,
    )
    limb: EnumProperty(  # type: ignore[valid-type]
        name="Limb",
        translation_context=CONTEXT,
        description="What is straightened; limbs can be chosen afterwards, too",
        items=PART_ITEMS,
        default="ALL",
    )
    show_points: BoolProperty(  # type: ignore[valid-type]
        name="Labels in the View",
        translation_context=CONTEXT,
        description="Show the ends of the limbs with their names in the 3D View",
        default=True,
    )
    in_betweens: IntProperty(  # type: ignore[valid-type]
        name="Keys",
        translation_context=CONTEXT,
        description="Number of shape keys between the pose and the form",
        default=5,
        min=1,
        max=31,
    )
    distance: EnumProperty(  # type: ignore[valid-type]
        name="Distance",
        translation_context=CONTEXT,
        description="Which distance is measured",
        items=DISTANCES,
        default="heat",
    )
    isolines: IntProperty(  # type: ignore[valid-type]
        name="Isolines",
        translation_context=CONTEXT,
        description="Number of lines of equal distance; 0 for none",
        default=0,
        min=0,
        soft_max=40,
    )


def choices_of(context: bpy.types.Context) -> CanonicalFormChoices | None:
    """Return the choices for what a run applies to.

    Parameters
    ----------
    context : bpy.types.Context
        Any context.

    Returns
    -------
    CanonicalFormChoices or None
        Those of the object that is meant, or of the one with the slider if it is part of a body; None if none is meant.
    """
    obj = meant_object(context)
    if obj is None:
        return None
    if obj.type == "MESH":
        obj = companions_of(obj)[0]
    found: CanonicalFormChoices = obj.canonical_form
    return found


def hand_over(choices: CanonicalFormChoices, operator: Any) -> None:
    """Copy the choices to the operator of a button.

    Parameters
    ----------
    choices : CanonicalFormChoices
        The choices.
    operator : bpy.types.OperatorProperties
        Properties of the button's operator.
    """
    for name in (*METHOD_NAMES, *REQUEST_NAMES):
        setattr(operator, name, _handed(choices, name))
    if choices.feature_source == "DETECTED":
        operator.feature_group = ""
    else:
        operator.feature_points = operator.feature_names = ""
        operator.feature_group = choices.feature_group or CHOSEN_GROUP


def hand_over_transfer(choices: CanonicalFormChoices, operator: Any) -> None:
    """Copy the choices to the operator of a button that transfers data.

    Parameters
    ----------
    choices : CanonicalFormChoices
        The choices.
    operator : bpy.types.OperatorProperties
        Properties of the button's operator.
    """
    for name in METHOD_NAMES:
        setattr(operator, name, chosen_value(choices, name))
    operator.like = _handed(choices, "like")
    operator.anyway = choices.anyway
    operator.kinds = {kind for kind, *_ in TRANSFER_ITEMS if getattr(choices, transfer_flag(kind))}


def hand_over_rig(choices: CanonicalFormChoices, operator: Any) -> None:
    """Copy the choices to the operator of a button that makes a rig.

    Parameters
    ----------
    choices : CanonicalFormChoices
        The choices.
    operator : bpy.types.OperatorProperties
        Properties of the button's operator.
    """
    for name in METHOD_NAMES:
        setattr(operator, name, chosen_value(choices, name))
    operator.like = _handed(choices, "rig_like")
    operator.rest, operator.names = chosen_value(choices, "rig_rest"), chosen_value(choices, "rig_names")
    operator.equal, operator.rigify, operator.anyway = choices.rig_equal, choices.rig_rigify, choices.anyway


def _handed(choices: CanonicalFormChoices, name: str) -> Any:
    """Return a choice as operators take it: of an object its name."""
    if name not in _POINTERS:
        return chosen_value(choices, name)
    obj = there(getattr(choices, name))
    return "" if obj is None else obj.name


def there(obj: bpy.types.Object | None) -> bpy.types.Object | None:
    """Return an object that was chosen; None if it was deleted: a choice keeps it in the file.

    Parameters
    ----------
    obj : bpy.types.Object or None
        The object.

    Returns
    -------
    bpy.types.Object or None
        The object, if a scene has it.
    """
    return obj if obj is not None and obj.users_scene else None


def register() -> None:
    """Register the choices and add them to objects."""
    bpy.utils.register_class(CanonicalFormChoices)
    bpy.types.Object.canonical_form = PointerProperty(type=CanonicalFormChoices)


def unregister() -> None:
    """Remove the choices from objects, and unregister them."""
    del bpy.types.Object.canonical_form
    bpy.utils.unregister_class(CanonicalFormChoices)
