"""The panels of the tools: skin that has grown together, and distances."""

import bpy

from ..blender.jobs.meant_objects import meant_object
from ..blender.words.wording import CONTEXT, told
from .choices import choices_of
from .contact_operators import GROUPS, OBJECT_OT_canonical_form_mark
from .properties import chosen_value
from .sidebar import Tab, draw_progress
from .tool_operators import OBJECT_OT_canonical_form_distance

_BUTTONS = (("ADD", "ADD"), ("REMOVE", "REMOVE"), ("CLEAR", "X"))  # what each does, and its icon


class VIEW3D_PT_canonical_form_tools(Tab, bpy.types.Panel):
    """Tools that are needed now and then."""

    bl_label = "Tools"
    bl_translation_context = CONTEXT
    bl_parent_id = "VIEW3D_PT_canonical_form"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Show the panel if there is something to use them on."""
        return choices_of(context) is not None

    def draw(self, context: bpy.types.Context) -> None:
        """Draw nothing: each tool has a panel."""


class VIEW3D_PT_canonical_form_contacts(Tab, bpy.types.Panel):
    """Where skin has grown together: found, or marked by hand."""

    bl_label = "Grown Together"
    bl_translation_context = CONTEXT
    bl_parent_id = "VIEW3D_PT_canonical_form_tools"

    def draw(self, context: bpy.types.Context) -> None:
        """Draw whether contacts are searched for, and the marks."""
        layout, obj, choices = self.layout, meant_object(context), choices_of(context)
        if choices is None:
            return
        row = layout.row(align=True)
        row.prop(choices, "contacts", expand=True)
        for marks, group in GROUPS.items():
            marked = obj is not None and obj.type == "MESH" and group in obj.vertex_groups
            row = layout.row(align=True)
            for how, icon in _BUTTONS:
                part = row.row(align=True)
                part.enabled = how == "ADD" or marked
                text = told(group) if how == "ADD" else ""
                button = part.operator(OBJECT_OT_canonical_form_mark.bl_idname, text=text, icon=icon)
                button.marks, button.how, button.source = marks, how, "SELECTED"
        button = layout.operator(OBJECT_OT_canonical_form_mark.bl_idname, text=told("Part at Seams"), icon="EDGESEL")
        button.marks, button.how, button.source = "PART", "ADD", "SEAMS"


class VIEW3D_PT_canonical_form_distance(Tab, bpy.types.Panel):
    """Distances from the selected vertices."""

    bl_label = "Distance from Selected"
    bl_translation_context = CONTEXT
    bl_parent_id = "VIEW3D_PT_canonical_form_tools"

    def draw(self, context: bpy.types.Context) -> None:
        """Draw the kind, the isolines and the button."""
        layout, choices = self.layout, choices_of(context)
        if choices is None:
            return
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(choices, "distance", text=told("Kind"))
        layout.prop(choices, "isolines")
        if not draw_progress(layout, ("DISTANCE",)):
            button = layout.operator(
                OBJECT_OT_canonical_form_distance.bl_idname, text=told("Measure"), icon="DRIVER_DISTANCE"
            )
            button.kind, button.isolines = chosen_value(choices, "distance"), choices.isolines


CLASSES = (
    VIEW3D_PT_canonical_form_tools,
    VIEW3D_PT_canonical_form_contacts,
    VIEW3D_PT_canonical_form_distance,
)
