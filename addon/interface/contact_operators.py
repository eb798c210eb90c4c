"""The operator that marks where skin is to be parted, or stays joined."""

# no `from __future__ import annotations`: Blender reads the annotations below as properties

import bpy
from bpy.props import EnumProperty

from ..blender.jobs.meant_objects import meant_object, require_object
from ..blender.objects.marked_contacts import KEEP_GROUP, PART_GROUP, mark
from ..blender.objects.mesh_reading import refusal
from ..blender.words.advice import explained
from ..blender.words.wording import CONTEXT, told
from ..core import CanonicalFormError
from .job_operator import JobOperator
from .operators import allowed

GROUPS = {"PART": PART_GROUP, "KEEP": KEEP_GROUP}
_DESCRIPTIONS = {
    ("PART", "ADD"): "Part the skin at the selection: selected faces are taken out, selected edges are cut, and both "
    "sides are closed. The next form, T-pose or rig uses it",
    ("PART", "REMOVE"): "Do not part the selection any more",
    ("PART", "CLEAR"): "Remove all of these marks",
    ("KEEP", "ADD"): "Never part the selection, as a strap or a handle that belongs to the body",
    ("KEEP", "REMOVE"): "Do not protect the selection any more",
    ("KEEP", "CLEAR"): "Remove all of these marks",
}


class OBJECT_OT_canonical_form_mark(bpy.types.Operator):
    """Mark by hand where skin that has grown together is parted, or where it stays"""  # noqa: D400

    bl_idname = "object.canonical_form_mark"
    bl_label = "Mark Contacts"
    bl_translation_context = CONTEXT
    bl_options = {"REGISTER", "UNDO"}

    marks: EnumProperty(  # type: ignore[valid-type]
        name="Marks",
        translation_context=CONTEXT,
        items=(
            ("PART", PART_GROUP, "The mesh is parted there"),
            ("KEEP", KEEP_GROUP, "Nothing is parted there that is not marked"),
        ),
    )
    how: EnumProperty(  # type: ignore[valid-type]
        name="How",
        translation_context=CONTEXT,
        items=(
            ("ADD", "Add", "Mark the selection, too"),
            ("REMOVE", "Remove", "Take the marks off the selection"),
            ("CLEAR", "Clear", "Take all marks off"),
        ),
    )
    source: EnumProperty(  # type: ignore[valid-type]
        name="Source",
        translation_context=CONTEXT,
        items=(
            ("SELECTED", "Selected", "Selected faces and edges"),
            ("SEAMS", "Seams", "Edges that are marked as seams"),
        ),
    )

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        """Return the tooltip of the button."""
        if properties.source == "SEAMS":
            return told("Part the skin at the edges that are marked as seams")
        return told(_DESCRIPTIONS[properties.marks, properties.how])

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Disable the button, with a reason, if the active object cannot be used."""
        return allowed(cls, JobOperator.busy() or refusal(meant_object(context)))

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Change the marks."""
        group = GROUPS[self.marks]
        try:
            count = mark(require_object(context), group, self.how, seams=self.source == "SEAMS")
        except CanonicalFormError as error:
            self.report({"ERROR"}, explained(error))
            return {"CANCELLED"}
        if count:
            sentence = told(
                "{count:,} vertices are marked: {name}. Press T-Pose, Rig or Straighten again.",
                count=count,
                name=told(group),
            )
        else:
            sentence = told("Nothing is marked any more: {name}.", name=told(group))
        self.report({"INFO"}, sentence)
        return {"FINISHED"}


CLASSES = (OBJECT_OT_canonical_form_mark,)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
