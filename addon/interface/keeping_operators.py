"""Operators that keep a result: as the mesh's own shape, or as a new object."""

import bpy

from ..blender.jobs.meant_objects import meant_object, require_object
from ..blender.objects.mesh_reading import refusal
from ..blender.results.kept_form import copy_of_shown, keep_form, keep_refusal
from ..blender.results.new_objects import make_active
from ..blender.words.advice import explained
from ..blender.words.wording import CONTEXT, listed, told
from ..core import CanonicalFormError
from .job_operator import JobOperator
from .operators import allowed, result_refusal
from .properties import list_patches
from .viewport import any_result, restore_shading


class OBJECT_OT_canonical_form_keep(bpy.types.Operator):
    """Make what the result shows the mesh's own shape: a new Basis. The shape from before stays as a shape key"""  # noqa: D400

    bl_idname = "object.canonical_form_keep"
    bl_label = "Keep Canonical Form as Rest"
    bl_translation_context = CONTEXT
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Disable the button, with a reason, if there is nothing to keep."""
        obj = meant_object(context)
        return allowed(cls, JobOperator.busy() or keep_refusal(obj) or refusal(obj))

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Write the new Basis to all objects of the body."""
        obj = require_object(context)
        try:
            name, left = keep_form(obj)
        except CanonicalFormError as error:
            self.report({"ERROR"}, explained(error))
            return {"CANCELLED"}
        list_patches(obj.data)
        self.report({"INFO"}, told("That is its shape now. The one from before is the key {key}.", key=name))
        if left:
            self.report({"WARNING"}, told("Kept, since they may hold your changes: {left}.", left=listed(left)))
        if not any_result():
            restore_shading(context)
        return {"FINISHED"}


class OBJECT_OT_canonical_form_copy(bpy.types.Operator):
    """Add an object shaped as this one is shown now, without keys and modifiers. Nothing is computed again"""  # noqa: D400

    bl_idname = "object.canonical_form_copy"
    bl_label = "Canonical Form to New Object"
    bl_translation_context = CONTEXT
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Disable the button, with a reason, if there is no result."""
        return allowed(cls, JobOperator.busy() or result_refusal(meant_object(context)))

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Add a copy of each object of the body."""
        try:
            added = copy_of_shown(require_object(context))
        except CanonicalFormError as error:
            self.report({"ERROR"}, explained(error))
            return {"CANCELLED"}
        if context.mode == "OBJECT":
            make_active(added)
        self.report({"INFO"}, told("What is shown is on {names}.", names=listed([each.name for each in added])))
        return {"FINISHED"}


CLASSES = (OBJECT_OT_canonical_form_keep, OBJECT_OT_canonical_form_copy)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
