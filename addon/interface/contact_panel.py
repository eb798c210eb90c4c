"""The panel about skin that has grown together."""

import bpy

from ..blender.jobs.meant_objects import meant_object
from ..blender.words.wording import CONTEXT, told
from .contact_operators import GROUPS, OBJECT_OT_canonical_form_mark
from .sidebar import Tab

_BUTTONS = (("ADD", "ADD"), ("REMOVE", "REMOVE"), ("CLEAR", "X"))  # what each does, and its icon


class VIEW3D_PT_canonical_form_contacts(Tab, bpy.types.Panel):
    """Where skin has grown together: found, or marked by hand."""

    bl_label = "Grown Together"
    bl_translation_context = CONTEXT
    bl_parent_id = "VIEW3D_PT_canonical_form"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draw whether contacts are searched for, and the marks."""
        layout, obj = self.layout, meant_object(context)
        row = layout.row(align=True)
        row.prop(context.scene.canonical_form, "contacts", expand=True)
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
