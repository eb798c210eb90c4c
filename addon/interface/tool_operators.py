"""Operators that need no result: choosing feature points by hand, and distance fields."""

# no `from __future__ import annotations`: Blender reads the annotations below as properties

from typing import TYPE_CHECKING

import bpy
from bpy.props import EnumProperty, IntProperty, StringProperty

from ..blender.jobs.meant_objects import meant_object, require_object
from ..blender.objects.chosen_features import CHOSEN_GROUP, choose_features
from ..blender.objects.mesh_reading import refusal
from ..blender.words.advice import explained
from ..blender.words.wording import CONTEXT, told
from ..core import CanonicalFormError
from .choices import choices_of
from .job_operator import JobOperator
from .operators import allowed, chosen_objects
from .properties import DISTANCES
from .viewport import show_colours

if TYPE_CHECKING:
    from ..blender.jobs.distance_task import DistanceTask

_DESCRIPTIONS = {
    "SET": "Take the selected vertices for the feature points, one at the tip of each limb",
    "ADD": "Add the selected vertices to the feature points, those of the last run to begin with",
    "REMOVE": "Remove the selected vertices from the feature points",
}


class OBJECT_OT_canonical_form_choose(bpy.types.Operator):
    """Choose feature points by hand: they are kept in a vertex group, and the next run uses them"""  # noqa: D400

    bl_idname = "object.canonical_form_choose"
    bl_label = "Choose Feature Points"
    bl_translation_context = CONTEXT
    bl_options = {"REGISTER", "UNDO"}

    how: EnumProperty(  # type: ignore[valid-type]
        name="How",
        translation_context=CONTEXT,
        items=(
            ("SET", "From Selection", "The selected vertices are the feature points"),
            ("ADD", "Add", "The selected vertices are feature points too"),
            ("REMOVE", "Remove", "The selected vertices are no longer feature points"),
        ),
    )
    group: StringProperty(  # type: ignore[valid-type]
        name="Vertex Group",
        translation_context=CONTEXT,
        description="Group that holds the feature points",
        default=CHOSEN_GROUP,
    )

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        """Return the tooltip of the button."""
        return told(_DESCRIPTIONS[properties.how])

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Disable the button, with a reason, if the active object cannot be used."""
        return allowed(cls, JobOperator.busy() or refusal(meant_object(context)))

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Change the group and select it as the source of the feature points."""
        try:
            name, count = choose_features(require_object(context), self.how, self.group)
        except CanonicalFormError as error:
            self.report({"ERROR"}, explained(error))
            return {"CANCELLED"}
        choices = choices_of(context)
        if choices is not None:
            choices.feature_source, choices.feature_group = "GROUP", name
        if count == 1:
            sentence = told("1 feature point is in the vertex group {name}. Press Compute to use it.", name=name)
        else:
            sentence = told("{count} feature points are in the vertex group {name}. Press Compute to use them.",
                            count=count, name=name)  # fmt: skip
        self.report({"INFO"}, sentence)
        return {"FINISHED"}


class OBJECT_OT_canonical_form_distance(JobOperator, bpy.types.Operator):
    """Measure distances from the selected vertices and write them as colours and a vertex group"""  # noqa: D400

    bl_idname = "object.canonical_form_distance"
    bl_label = "Distance from Selected"
    bl_translation_context = CONTEXT
    bl_options = {"UNDO"}

    kind: EnumProperty(name="Distance", translation_context=CONTEXT, items=DISTANCES, default="heat")  # type: ignore[valid-type]
    isolines: IntProperty(  # type: ignore[valid-type]
        name="Isolines",
        translation_context=CONTEXT,
        description="Number of lines of equal distance; 0 for none",
        default=0,
        min=0,
        soft_max=40,
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Disable the button, with a reason, if the active object cannot be used."""
        return allowed(cls, cls.busy() or refusal(meant_object(context)))

    def wish(self) -> str:
        """Name the wish."""
        return "DISTANCE"

    def task(self, context: bpy.types.Context) -> "DistanceTask":
        """Read the mesh with its selection, and the other meshes of the run."""
        from ..blender.jobs.distance_task import DistanceTask

        choices, objects = choices_of(context), chosen_objects(context)[0]
        memory_limit = 0.0 if choices is None else choices.memory_limit
        return DistanceTask(objects, self.kind, self.isolines, memory_limit=memory_limit)

    def written(self, context: bpy.types.Context, task: "DistanceTask", outcome: str, interactive: bool) -> None:
        """Report where the distances were written, with the warnings."""
        self.report(
            {"INFO"},
            told(
                "Distances are in the colours {colours} and the vertex group {group}.",
                colours=outcome,
                group=task.group,
            ),
        )
        self.warn(task.warnings)
        if task.unreached:
            self.report(
                {"WARNING"},
                told(
                    "{unreached:,} vertices cannot be reached from the selection; shown in grey.",
                    unreached=task.unreached,
                ),
            )
        if interactive:
            show_colours(context)


CLASSES = (OBJECT_OT_canonical_form_choose, OBJECT_OT_canonical_form_distance)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
