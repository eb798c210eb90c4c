"""The panel that gives a body an armature."""

import bpy

from ..blender.jobs.meant_objects import meant_object, meant_objects
from ..blender.records.rig_record import RigRecord, read_rig
from ..blender.words.wording import CONTEXT, told
from .pose_panel import least_sure, match_estimate, next_side
from .rig_operators import (
    OBJECT_OT_canonical_form_rig,
    OBJECT_OT_canonical_form_rig_clear,
    OBJECT_OT_canonical_form_rig_keep,
    hand_over_rig,
)
from .sidebar import Tab


class VIEW3D_PT_canonical_form_rig(Tab, bpy.types.Panel):
    """An armature for a body in any pose."""

    bl_label = "Rig"
    bl_translation_context = CONTEXT
    bl_parent_id = "VIEW3D_PT_canonical_form"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draw the choices, the button, and what the last run says."""
        layout, chosen = self.layout, context.scene.canonical_form
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop_search(chosen, "rig_like", bpy.data, "objects", text=told("Bones From"))
        layout.prop(chosen, "rig_rest", text=told("Rest"))
        layout.prop(chosen, "rig_equal")
        names = layout.row()
        names.enabled = not chosen.rig_like  # bones of others have names
        names.prop(chosen, "rig_names", text=told("Names"))
        layout.prop(chosen, "rig_rigify")
        layout.prop(chosen, "anyway")
        hand_over_rig(chosen, layout.operator(OBJECT_OT_canonical_form_rig.bl_idname, icon="ARMATURE_DATA"))
        record = shown_rig(context)
        if record is not None:
            draw_other_rig(layout, chosen, record)
            for line in least_sure(record.confidence):
                layout.label(text=line, icon="ERROR")
            if record.rest is not None:
                layout.operator(OBJECT_OT_canonical_form_rig_keep.bl_idname)
            layout.operator(OBJECT_OT_canonical_form_rig_clear.bl_idname, icon="X")
        objects = [obj for obj in meant_objects(context) if obj is not None and obj.type == "MESH"]
        if objects:
            memory, seconds = match_estimate(chosen, objects, None)
            text = told("A rig: about {memory:.1f} GB, {seconds:,.0f} s", memory=memory, seconds=seconds)
            layout.label(text=text, icon="MEMORY")


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


def draw_other_rig(layout: bpy.types.UILayout, chosen: bpy.types.PropertyGroup, record: RigRecord) -> None:
    """Draw the button that rigs the body facing another way, if there are several.

    Parameters
    ----------
    layout : bpy.types.UILayout
        Where.
    chosen : bpy.types.PropertyGroup
        The choices made in the panel.
    record : RigRecord
        The rig.
    """
    if len(record.sides) < 2:
        return
    text, side = next_side(record.side, len(record.sides), stands=not record.source)
    button = layout.operator(OBJECT_OT_canonical_form_rig.bl_idname, text=text)
    hand_over_rig(chosen, button)
    button.side = side
