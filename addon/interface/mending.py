"""Buttons beside a doubt or a refusal: they do what mends it."""

import re
from collections.abc import Collection

import bpy

from ..blender.jobs.likeness import MANNEQUINS
from ..blender.jobs.meant_objects import meant_meshes, meant_object
from ..blender.objects.body_points import body_points
from ..blender.objects.marked_contacts import PART_GROUP
from ..blender.words.limb_words import told_limb
from ..blender.words.wording import told
from .choices import CanonicalFormChoices, hand_over, hand_over_rig
from .contact_operators import OBJECT_OT_canonical_form_mark
from .job_operator import OBJECT_OT_canonical_form_cancel
from .point_operators import OBJECT_OT_canonical_form_fix_point
from .pose_operators import OBJECT_OT_canonical_form_pose_like
from .rig_operators import OBJECT_OT_canonical_form_rig
from .sidebar import draw_sentence

_LIMBS = ("head", "left_hand", "right_hand", "left_foot", "right_foot")
_MOST = 4  # buttons
_BONES = {"hand": r"arm|hand|wrist|elbow|finger|thumb|shoulder", "foot": r"leg|thigh|shin|foot|toe|ankle|knee"}
_SIDES = {"left_": r"left|(^|[._ -])l([._ -]|$)", "right_": r"right|(^|[._ -])r([._ -]|$)"}


def draw_refusal(layout: bpy.types.UILayout, context: bpy.types.Context, choices: CanonicalFormChoices) -> None:
    """Say why what was asked for last was refused, with what mends it.

    Parameters
    ----------
    layout : bpy.types.UILayout
        Where.
    context : bpy.types.Context
        Any context.
    choices : CanonicalFormChoices
        The choices for what is meant.
    """
    refused, obj = OBJECT_OT_canonical_form_cancel.refused, meant_object(context)
    if refused is None or obj is None or obj.name != refused.owner:
        return
    column = layout.column(align=True)
    draw_sentence(column, context, refused.sentence, "ERROR")
    if refused.mend == "ANYWAY" and refused.wish in (*MANNEQUINS, "RIG"):
        row = column.row(align=True)
        if refused.wish == "RIG":
            button = row.operator(OBJECT_OT_canonical_form_rig.bl_idname, text=told("Make Anyway"))
            hand_over_rig(choices, button)
        else:
            button = row.operator(OBJECT_OT_canonical_form_pose_like.bl_idname, text=told("Make Anyway"))
            hand_over(choices, button)
            button.pose = refused.wish
        button.anyway = True
        draw_limbs_to_fix(column, context)
    else:
        draw_mends(column, context, choices, [refused.mend])


def draw_mends(
    layout: bpy.types.UILayout, context: bpy.types.Context, choices: CanonicalFormChoices, mends: Collection[str]
) -> None:
    """Draw what mends doubts.

    Parameters
    ----------
    layout : bpy.types.UILayout
        Where.
    context : bpy.types.Context
        Any context.
    choices : CanonicalFormChoices
        The choices for what is meant.
    mends : collection of str
        As in `advice.MENDS`.
    """
    if "PART" in mends:
        row = layout.row(align=True)
        row.prop_enum(choices, "contacts", "open", text=told("Open by Itself"))
        button = row.operator(OBJECT_OT_canonical_form_mark.bl_idname, text=told(PART_GROUP))
        button.marks, button.how, button.source = "PART", "ADD", "SELECTED"
    if "LIMBS" in mends:
        draw_limbs_to_fix(layout, context)


def draw_limbs_to_fix(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw a button for each of the first limbs that are missing; if none is, one that adds a point.

    Parameters
    ----------
    layout : bpy.types.UILayout
        Where.
    context : bpy.types.Context
        Any context.
    """
    points, _ = body_points(meant_meshes(context))
    known = {name for each in points for name in each.names}
    missing = [name for name in _LIMBS if name not in known][:_MOST]
    grid = layout.grid_flow(row_major=True, columns=min(2, max(1, len(missing))), even_columns=True, align=True)
    for name in missing or ["other"]:
        draw_fix(grid, name)


def draw_fix(layout: bpy.types.UILayout, name: str) -> None:
    """Draw the button that fixes a limb by a click on the body.

    Parameters
    ----------
    layout : bpy.types.UILayout
        Where.
    name : str
        The limb, as the core names it; "other" for one without a name.
    """
    kind = OBJECT_OT_canonical_form_fix_point
    text = told("Add a Limb") if name == "other" else told_limb(name)
    layout.operator(kind.bl_idname, text=text, icon="EYEDROPPER", depress=kind.waits_for == name).limb = name


def limb_of_bone(bone: str) -> str:
    """Return the limb that a bone belongs to, by its name.

    Parameters
    ----------
    bone : str
        Name of the bone.

    Returns
    -------
    str
        The limb, as the core names it; "" if the name does not tell.

    Examples
    --------
    >>> limb_of_bone("forearm.L"), limb_of_bone("RightUpLeg"), limb_of_bone("spine")
    ('left_hand', 'right_foot', '')
    """
    name = bone.lower()
    side = next((side for side, words in _SIDES.items() if re.search(words, name)), "")
    limb = next((limb for limb, words in _BONES.items() if re.search(words, name)), "")
    return side + limb if side and limb else ""
