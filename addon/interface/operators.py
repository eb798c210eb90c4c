"""The operators: compute the canonical form of the active mesh, and clear it."""

import bpy

from ..blender.computing import clear_from, compute_on
from ..blender.mesh_reading import refusal
from ..blender.result_writing import record_of
from ..core import CanonicalFormError
from .properties import MethodProperties, settings_of


class OBJECT_OT_canonical_form(MethodProperties, bpy.types.Operator):
    """Take the pose out of the active mesh and keep the result as a shape key"""  # noqa: D400 (Blender's tooltip)

    bl_idname = "object.canonical_form"
    bl_label = "Canonical Form"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Refuse with a reason where the active object cannot be used."""
        reason = refusal(context.object)
        if reason is not None:
            cls.poll_message_set(reason)
        return reason is None

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Compute and write the form."""
        manager = context.window_manager
        manager.progress_begin(0, 100)
        try:
            form, report = compute_on(
                context.object, settings_of(self), self.value, lambda done, _: manager.progress_update(100 * done)
            )
        except CanonicalFormError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        finally:
            manager.progress_end()
        for warning in report["warnings"]:
            self.report({"WARNING"}, warning)
        users = context.object.data.users - (1 if context.object.data.use_fake_user else 0)
        shared = f" {users} objects share this mesh and show it." if users > 1 else ""
        self.report(
            {"INFO"},
            f"{len(form.feature_points)} feature points, {sum(form.timings.values()):.1f} s, "
            f"{form.pair_reduction:.0%} of the pairs saved.{shared}",
        )
        return {"FINISHED"}


class OBJECT_OT_canonical_form_clear(bpy.types.Operator):
    """Remove the shape key, vertex groups and colours that Canonical Form wrote, and nothing else"""  # noqa: D400

    bl_idname = "object.canonical_form_clear"
    bl_label = "Clear Canonical Form"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Refuse with a reason where there is nothing to clear."""
        obj = context.object
        reason = None
        if obj is None or obj.type != "MESH" or record_of(obj.data) is None:
            reason = "The active object has no canonical form."
        else:
            reason = refusal(obj)
        if reason is not None:
            cls.poll_message_set(reason)
        return reason is None

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Remove the results."""
        try:
            left = clear_from(context.object)
        except CanonicalFormError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        if left:
            self.report({"WARNING"}, f"Kept, since they were changed after the run: {', '.join(left)}.")
        return {"FINISHED"}


CLASSES = (OBJECT_OT_canonical_form, OBJECT_OT_canonical_form_clear)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
