"""The panels of what came of a rig, of how one is made, and of what is transferred from another body."""

import bpy

from ..blender.jobs.meant_objects import meant_object, require_object
from ..blender.records.rig_record import RigRecord, read_rig
from ..blender.results.match_colours import source_colours
from ..blender.rigging.rig_clearing import armature_given_to
from ..blender.rigging.rig_posing import scan_pose_of, taken_pose
from ..blender.words.wording import CONTEXT, told
from .choices import CanonicalFormChoices, choices_of, hand_over_rig, hand_over_transfer, there
from .pose_operators import OBJECT_OT_canonical_form_match_colours, OBJECT_OT_canonical_form_transfer
from .properties import TRANSFER_ITEMS, transfer_flag
from .result_panel import draw_unsure, draw_warnings, least_sure, next_side
from .rig_operators import (
    OBJECT_OT_canonical_form_rig,
    OBJECT_OT_canonical_form_rig_clear,
    OBJECT_OT_canonical_form_rig_keep,
    OBJECT_OT_canonical_form_rig_pose,
)
from .sidebar import Tab, draw_progress, draw_sentence, record_of


class VIEW3D_PT_canonical_form_rigged(Tab, bpy.types.Panel):
    """What the last rig is like, and what can be done with it."""

    bl_label = "Rig"
    bl_translation_context = CONTEXT
    bl_parent_id = "VIEW3D_PT_canonical_form"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Show the panel if a rig was made."""
        return shown_rig(context) is not None

    def draw(self, context: bpy.types.Context) -> None:
        """Draw whether it looks right, its poses, and Remove."""
        record, choices = shown_rig(context), choices_of(context)
        if record is not None and choices is not None:
            _draw_made(self.layout, context, choices, record)


class VIEW3D_PT_canonical_form_rig(Tab, bpy.types.Panel):
    """An armature for a body in any pose, and data of another body."""

    bl_label = "Rig and Transfer"
    bl_translation_context = CONTEXT
    bl_parent_id = "VIEW3D_PT_canonical_form"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Show the panel if there is something to rig."""
        return choices_of(context) is not None

    def draw(self, context: bpy.types.Context) -> None:
        """Draw the choices."""
        layout, choices = self.layout, choices_of(context)
        if choices is None:
            return
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(choices, "rig_like", text=told("Bones From"))
        layout.prop(choices, "rig_rest", text=told("Rest"))
        names = layout.row()
        names.enabled = there(choices.rig_like) is None  # bones of others have names
        names.prop(choices, "rig_names", text=told("Names"))
        layout.prop(choices, "rig_equal")
        layout.prop(choices, "rig_rigify")
        _draw_transfer(layout, context, choices)


def _draw_made(
    layout: bpy.types.UILayout, context: bpy.types.Context, choices: CanonicalFormChoices, record: RigRecord
) -> None:
    """Draw what the last rig is like, and what can be done with it."""
    column = layout.column(align=True)
    doubts = least_sure(record.confidence)
    draw_unsure(column, context, doubts)
    if not doubts and not record.warnings:
        draw_sentence(column, context, told("No warnings: look from all sides"), "HIDE_OFF")
    draw_warnings(layout, context, record.warnings)
    draw_other_rig(layout, choices, record)
    if record.scan is not None:
        _draw_poses(layout, require_object(context))
    row = layout.row(align=True)
    if record.rest is not None:
        row.operator(OBJECT_OT_canonical_form_rig_keep.bl_idname)
    row.operator(OBJECT_OT_canonical_form_rig_clear.bl_idname, icon="X")


def _draw_poses(layout: bpy.types.UILayout, obj: bpy.types.Object) -> None:
    """Draw the poses of the rig; that which it is in is pressed."""
    armature = armature_given_to(obj)
    pose = "" if armature is None else taken_pose(armature, scan_pose_of(obj.data))
    row, kind = layout.row(align=True), OBJECT_OT_canonical_form_rig_pose
    row.operator(kind.bl_idname, text=told("At Rest"), depress=pose == "REST").scan = False
    row.operator(kind.bl_idname, text=told("As Scanned"), depress=pose == "SCAN").scan = True


def _draw_transfer(layout: bpy.types.UILayout, context: bpy.types.Context, choices: CanonicalFormChoices) -> None:
    """Draw what is taken over from another body."""
    header, box = layout.panel("canonical_form_transfer", default_closed=False)
    header.label(text=told("Transfer from Another Body"))
    if box is None:
        return
    box.prop(choices, "like", text=told("From"))
    grid = box.grid_flow(columns=3, even_columns=True, align=True)
    grid.use_property_split = False
    grid.enabled = there(choices.like) is not None
    for kind, *_ in TRANSFER_ITEMS:
        grid.prop(choices, transfer_flag(kind))
    column = box.column()
    column.enabled = there(choices.like) is not None
    if not draw_progress(column, ("TRANSFER",)):
        hand_over_transfer(choices, column.operator(OBJECT_OT_canonical_form_transfer.bl_idname))
    record = record_of(context)
    like = None if record is None else record.report.like
    source = None if like is None or like.pose != "OBJECT" else bpy.data.objects.get(like.name)
    if source is not None and source.type == "MESH":
        if source_colours(source.data) is not None:
            text = told("Remove Colours from {name}", name=source.name)
        else:
            text = told("Show Colours on {name}", name=source.name)
        box.operator(OBJECT_OT_canonical_form_match_colours.bl_idname, text=text).like = source.name


def shown_rig(context: bpy.types.Context) -> RigRecord | None:
    """Read the rig of the object that is meant.

    Parameters
    ----------
    context : bpy.types.Context
        Any context.

    Returns
    -------
    RigRecord or None
        The record; None if the object was given no armature.
    """
    obj = meant_object(context)
    return read_rig(obj.data) if obj is not None and obj.type == "MESH" else None


def draw_other_rig(layout: bpy.types.UILayout, choices: CanonicalFormChoices, record: RigRecord) -> None:
    """Draw the button that rigs the body facing another way, if there are several.

    Parameters
    ----------
    layout : bpy.types.UILayout
        Where.
    choices : CanonicalFormChoices
        The choices for what is meant.
    record : RigRecord
        The rig.
    """
    if len(record.sides) < 2:
        return
    text, side = next_side(record.side, len(record.sides), stands=not record.source)
    button = layout.operator(OBJECT_OT_canonical_form_rig.bl_idname, text=text, icon="FILE_REFRESH")
    hand_over_rig(choices, button)
    button.side = side


CLASSES = (VIEW3D_PT_canonical_form_rigged, VIEW3D_PT_canonical_form_rig)
