"""Operators that give a body an armature, and remove it."""

# no `from __future__ import annotations`: Blender reads the annotations below as properties

from typing import TYPE_CHECKING

import bpy
from bpy.props import BoolProperty, IntProperty

from ..blender.jobs.meant_objects import meant_object, require_object
from ..blender.objects.mesh_reading import refusal
from ..blender.records.rig_record import read_rig
from ..blender.words.advice import explained
from ..blender.words.wording import CONTEXT, listed, told
from ..core import CanonicalFormError
from .job_operator import JobOperator, kept_stages
from .operators import allowed, chosen_objects
from .properties import MethodProperties, settings_of
from .rig_properties import RigOptions

if TYPE_CHECKING:
    from ..blender.rigging.rig_task import RigTask


class OBJECT_OT_canonical_form_rig(JobOperator, MethodProperties, RigOptions, bpy.types.Operator):
    """Give the selected meshes, in any pose, an armature with weights: the bones of a mannequin, or of a reference"""  # noqa: D400

    bl_idname = "object.canonical_form_rig"
    bl_label = "Rig"
    bl_translation_context = CONTEXT
    bl_options = {"UNDO"}

    side: IntProperty(  # type: ignore[valid-type]
        name="Side",
        translation_context=CONTEXT,
        description="Which way the body faces: -1 for the likeliest, or its number from 0",
        default=-1,
        min=-1,
    )
    anyway: BoolProperty(  # type: ignore[valid-type]
        name="Write Anyway",
        translation_context=CONTEXT,
        description="Keep a rig that is unlikely to be right, too",
        default=False,
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Disable the button, with a reason, if the active object cannot be used."""
        return allowed(cls, cls.busy() or refusal(meant_object(context)))

    def wish(self) -> str:
        """Name the wish."""
        return "RIG"

    def task(self, context: bpy.types.Context) -> "RigTask":
        """Read the reference, then the active and the other selected meshes."""
        from ..blender.jobs.pose_reading import named_reference
        from ..blender.rigging.rig_reading import read_rig_source
        from ..blender.rigging.rig_task import RigTask

        source = read_rig_source(named_reference(self.like)) if self.like else None
        objects, self._refused = chosen_objects(context)
        return RigTask(
            objects,
            source,
            settings_of(self),
            self.rest,
            equal=self.equal,
            naming=self.names,
            rigify=self.rigify,
            side=self.side,
            anyway=self.anyway,
            keep=kept_stages(objects),
        )

    def written(self, context: bpy.types.Context, task: "RigTask", outcome: None, interactive: bool) -> None:
        """Report the warnings, then what was made."""
        self.warn([*self._refused, *task.warnings])
        self.report(
            {"INFO"},
            told(
                "{armature}: {bones} bones. Select it, and press Ctrl+Tab to pose it.",
                armature=task.armature,
                bones=task.bones,
            ),
        )


class OBJECT_OT_canonical_form_rig_clear(bpy.types.Operator):
    """Remove the armature that Rig made, with its weights and keys; the mesh is as it was"""  # noqa: D400

    bl_idname = "object.canonical_form_rig_clear"
    bl_label = "Remove Rig"
    bl_translation_context = CONTEXT
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Disable the button, with a reason, if there is nothing to remove."""
        return allowed(cls, JobOperator.busy() or _no_rig(meant_object(context)))

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Remove it from all objects that it moves."""
        from ..blender.rigging.rig_clearing import armature_given_to, bound_to, release

        obj = meant_object(context)
        if obj is None:
            return {"CANCELLED"}
        armature = armature_given_to(obj)
        objects = [obj] if armature is None else bound_to(armature)
        try:
            left = release(objects)
        except CanonicalFormError as error:
            self.report({"ERROR"}, explained(error))
            return {"CANCELLED"}
        self.report({"INFO"}, told("Removed from {names}.", names=listed([each.name for each in objects])))
        if left:
            self.report({"WARNING"}, told("Kept, since they may hold your changes: {left}.", left=listed(left)))
        return {"FINISHED"}


class OBJECT_OT_canonical_form_rig_keep(bpy.types.Operator):
    """Make the pose at rest of the rig that of the mesh: a new Basis. The scan stays as a shape key"""  # noqa: D400

    bl_idname = "object.canonical_form_rig_keep"
    bl_label = "Keep as Rest"
    bl_translation_context = CONTEXT
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Disable the button, with a reason, if the mesh rests as it is."""
        obj = meant_object(context)
        record = read_rig(obj.data) if obj is not None and obj.type == "MESH" else None
        reason = told("The mesh rests as it is.") if record is None or record.rest is None else refusal(obj)
        return allowed(cls, JobOperator.busy() or reason)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Write it to all objects that the armature moves."""
        from ..blender.rigging.kept_rest import keep_rest
        from ..blender.rigging.rig_clearing import armature_given_to, bound_to

        obj = meant_object(context)
        if obj is None:
            return {"CANCELLED"}
        armature = armature_given_to(obj)
        try:
            for each in [obj] if armature is None else bound_to(armature):
                keep_rest(each)
        except CanonicalFormError as error:
            self.report({"ERROR"}, explained(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class OBJECT_OT_canonical_form_rig_pose(bpy.types.Operator):
    """Put the armature that Rig made into one of its poses: that of the scan, or at rest"""  # noqa: D400

    bl_idname = "object.canonical_form_rig_pose"
    bl_label = "Pose of the Rig"
    bl_translation_context = CONTEXT
    bl_options = {"REGISTER", "UNDO"}

    scan: BoolProperty(  # type: ignore[valid-type]
        name="As Scanned",
        translation_context=CONTEXT,
        description="The pose of the scan, and exactly its shape; else the pose at rest",
        default=False,
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Disable the button, with a reason, if there is no such armature."""
        return allowed(cls, _no_rig(meant_object(context)))

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Pose the armature."""
        from ..blender.rigging.rig_clearing import armature_given_to
        from ..blender.rigging.rig_posing import scan_pose_of, take_pose

        obj = require_object(context)
        armature, action = armature_given_to(obj), scan_pose_of(obj.data) if self.scan else None
        if armature is None or (self.scan and action is None):
            self.report({"ERROR"}, told("The armature or its pose is gone."))
            return {"CANCELLED"}
        if take_pose(armature, action):
            self.report({"WARNING"}, told("Bones were renamed or deleted: they stay at rest, and the key Scan off."))
        return {"FINISHED"}


def _no_rig(obj: bpy.types.Object | None) -> str | None:
    """Return that *Rig* has made no armature for an object; None if it has."""
    there = obj is not None and obj.type == "MESH" and read_rig(obj.data) is not None
    return None if there else told("Rig has made no armature for this mesh.")


CLASSES = (
    OBJECT_OT_canonical_form_rig,
    OBJECT_OT_canonical_form_rig_pose,
    OBJECT_OT_canonical_form_rig_keep,
    OBJECT_OT_canonical_form_rig_clear,
)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
