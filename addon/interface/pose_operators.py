"""Operators that put a mesh into the pose of another object or a mannequin."""

# no `from __future__ import annotations`: Blender reads the annotations below as properties

from typing import TYPE_CHECKING

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty, StringProperty

from ..blender.jobs.likeness import MANNEQUINS
from ..blender.jobs.meant_objects import meant_object
from ..blender.objects.mesh_reading import refusal
from ..blender.words.wording import CONTEXT, told
from ..core import CanonicalFormError
from .job_operator import JobOperator, kept_stages
from .operators import allowed, chosen_objects, leaves_refining_out, takes_shown, tell_results
from .properties import TRANSFER_ITEMS, MethodProperties, RequestProperties, settings_of
from .viewport import show_colours

if TYPE_CHECKING:
    from ..blender.jobs.form_task import FormTask
    from ..blender.transfer.transfer_task import TransferTask

_DESCRIPTIONS = {
    "OBJECT": "Put the selected meshes into the pose of the reference, and keep the result as a shape key",
    "T": "Put the selected meshes into a T-pose, as a shape key. Limbs are found automatically; Keep as Rest makes "
    "it the real shape",
    "A": "Put the selected meshes into an A-pose, as a shape key. Limbs are found automatically; Keep as Rest makes "
    "it the real shape",
}


class OBJECT_OT_canonical_form_pose_like(JobOperator, MethodProperties, RequestProperties, bpy.types.Operator):
    """Put the selected meshes into the pose of another object, and keep the result as a shape key"""  # noqa: D400

    bl_idname = "object.canonical_form_pose_like"
    bl_label = "Pose Like"
    bl_translation_context = CONTEXT
    bl_options = {"UNDO"}

    pose: EnumProperty(  # type: ignore[valid-type]
        name="Pose",
        translation_context=CONTEXT,
        description="Whose pose is taken",
        items=(
            ("OBJECT", "Object", "That of an object with a similar body, as shown"),
            ("T", MANNEQUINS["T"], "Standing, arms held out sideways: for bodies on two legs"),
            ("A", MANNEQUINS["A"], "Standing, arms lowered by 45 degrees: for bodies on two legs"),
        ),
        default="OBJECT",
    )
    like: StringProperty(name="Like", translation_context=CONTEXT, description="Object whose pose is taken")  # type: ignore[valid-type]
    side: IntProperty(  # type: ignore[valid-type]
        name="Side",
        translation_context=CONTEXT,
        description="Which way to match left and right, front and back: -1 for the likeliest, or its number from 0",
        default=-1,
        min=-1,
    )

    anyway: BoolProperty(  # type: ignore[valid-type]
        name="Write Anyway",
        translation_context=CONTEXT,
        description="Keep a T-Pose or an A-Pose that is unlikely to be right, too",
        default=False,
    )

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        """Return the tooltip of the button."""
        if properties.side >= 0:
            return told("Match the other way round: where left and right, or front and back, came out wrong")
        return told(_DESCRIPTIONS[properties.pose])

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Disable the button, with a reason, if the active object cannot be used."""
        return allowed(cls, cls.busy() or refusal(meant_object(context)))

    def wish(self) -> str:
        """Name the pose."""
        return self.pose

    def task(self, context: bpy.types.Context) -> "FormTask":
        """Read the reference, then the active and the other selected meshes."""
        from ..blender.jobs.form_task import FormTask
        from ..blender.jobs.likeness import Likeness
        from ..blender.jobs.pose_reading import named_reference, read_likeness
        from ..blender.jobs.request import Request

        objects, self._refused = chosen_objects(context)
        likeness = Likeness(self.pose, side=self.side, anyway=self.anyway)
        if self.pose == "OBJECT":
            likeness = read_likeness(named_reference(self.like), self.side, objects)
        objects = [obj for obj in objects if self.pose != "OBJECT" or obj.name != self.like]
        if not objects:
            raise CanonicalFormError(
                told("{like} is the reference itself. Select the mesh that is to be posed.", like=self.like)
            )
        deformed = takes_shown(self.mesh, objects)
        request = Request(
            settings=settings_of(self),
            value=self.value,
            feature_group=self.feature_group,
            deformed=deformed,
            unrefined=deformed and leaves_refining_out(self),
            new_object=self.result == "OBJECT",
            objects=self.objects,
            likeness=likeness,
            keep=kept_stages(objects),
        )
        return FormTask(objects, request)

    def written(self, context: bpy.types.Context, task: "FormTask", outcome: list[str], interactive: bool) -> None:
        """Report the warnings, then summarise the results in one line."""
        tell_results(self, context, task, self._refused, interactive)


class OBJECT_OT_canonical_form_transfer(JobOperator, MethodProperties, bpy.types.Operator):
    """Transfer data from another object to the matching points of the selected meshes"""  # noqa: D400 (tooltip)

    bl_idname = "object.canonical_form_transfer"
    bl_label = "Transfer"
    bl_translation_context = CONTEXT
    bl_options = {"UNDO"}

    like: StringProperty(  # type: ignore[valid-type]
        name="Reference",
        translation_context=CONTEXT,
        description="Object to transfer from: a mesh, or an armature for all its meshes",
    )
    kinds: EnumProperty(  # type: ignore[valid-type]
        name="Kinds",
        translation_context=CONTEXT,
        description="Data to transfer",
        items=TRANSFER_ITEMS,
        options={"ENUM_FLAG"},
        default={"GROUPS"},
    )
    side: IntProperty(  # type: ignore[valid-type]
        name="Side",
        translation_context=CONTEXT,
        description="Which way to match left and right, front and back: its number from 0; -1 for that of Pose Like, "
        "or the likeliest",
        default=-1,
        min=-1,
    )
    anyway: BoolProperty(  # type: ignore[valid-type]
        name="Write Anyway",
        translation_context=CONTEXT,
        description="Transfer from an object that is unlikely to fit, too",
        default=False,
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Disable the button, with a reason, if the active object cannot be used."""
        return allowed(cls, cls.busy() or refusal(meant_object(context)))

    def wish(self) -> str:
        """Name the wish."""
        return "TRANSFER"

    def task(self, context: bpy.types.Context) -> "TransferTask":
        """Read the reference, then the active and the other selected meshes."""
        from ..blender.jobs.pose_reading import named_reference
        from ..blender.transfer.transfer_task import TransferTask, side_of

        objects, self._refused = chosen_objects(context)
        side = side_of(objects[0], self.like) if self.side < 0 else self.side
        return TransferTask(
            objects, named_reference(self.like), self.kinds, settings_of(self), side, anyway=self.anyway
        )

    def written(self, context: bpy.types.Context, task: "TransferTask", outcome: None, interactive: bool) -> None:
        """Report the warnings, then what was transferred."""
        self.warn([*self._refused, *task.warnings])
        things = ", ".join(task.told) or told("nothing")
        self.report({"INFO"}, told("Transferred from {like}: {things}.", like=self.like, things=things))


class OBJECT_OT_canonical_form_match_colours(bpy.types.Operator):
    """Show the colours that the match carries over on the reference too, or remove them there"""  # noqa: D400

    bl_idname = "object.canonical_form_match_colours"
    bl_label = "Colours on the Reference"
    bl_translation_context = CONTEXT
    bl_options = {"REGISTER", "UNDO"}

    like: StringProperty(  # type: ignore[valid-type]
        name="Reference", translation_context=CONTEXT, description="Object whose colours were carried over"
    )

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Show or remove them."""
        from ..blender.jobs.pose_reading import named_reference
        from ..blender.results.match_colours import toggle_source_colours

        try:
            shown, kept = toggle_source_colours(named_reference(self.like))
        except CanonicalFormError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        if shown:
            show_colours(context)
        if kept:
            self.report({"WARNING"}, told("Kept, since they may hold your changes: {left}.", left=kept))
        return {"FINISHED"}


CLASSES = (
    OBJECT_OT_canonical_form_pose_like,
    OBJECT_OT_canonical_form_match_colours,
    OBJECT_OT_canonical_form_transfer,
)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
