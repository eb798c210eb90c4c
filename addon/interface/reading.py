"""The operator that shows a sentence whole of which the sidebar has room for two lines only."""

# no `from __future__ import annotations`: Blender reads the annotations below as properties

import textwrap

import bpy
from bpy.props import StringProperty

from ..blender.words.wording import CONTEXT

_WIDTH, _CHARACTERS = 420, 62  # of the box, in pixels, and characters in a line of it


class OBJECT_OT_canonical_form_read(bpy.types.Operator):
    """Read the whole sentence"""  # noqa: D400 (Blender's tooltip)

    bl_idname = "object.canonical_form_read"
    bl_label = "Read On"
    bl_translation_context = CONTEXT
    bl_options = {"INTERNAL"}

    sentence: StringProperty(translation_context=CONTEXT, options={"HIDDEN"})  # type: ignore[valid-type]

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        """Return the sentence: who waits with the mouse over the button need not press it."""
        return str(properties.sentence)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Show it in a box."""
        return context.window_manager.invoke_popup(self, width=_WIDTH)

    def draw(self, context: bpy.types.Context) -> None:
        """Draw it over as many lines as it needs."""
        column = self.layout.column(align=True)
        for line in textwrap.wrap(self.sentence, _CHARACTERS):
            column.label(text=line)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Report it, for scripts."""
        self.report({"INFO"}, self.sentence)
        return {"FINISHED"}


CLASSES = (OBJECT_OT_canonical_form_read,)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
