"""Operators that need no result: feature points chosen by hand, and distance fields."""

# no `from __future__ import annotations`: Blender reads the annotations below as properties

from typing import TYPE_CHECKING

import bpy
from bpy.props import EnumProperty, IntProperty, StringProperty

from ..blender.advice import explained
from ..blender.chosen_features import CHOSEN_GROUP, choose_features
from ..blender.meant_objects import meant_object, require_object
from ..blender.mesh_reading import refusal
from ..core import CanonicalFormError
from .job_operator import JobOperator
from .operators import allowed, chosen_objects
from .properties import DISTANCES
from .viewport import show_colours

if TYPE_CHECKING:
    from ..blender.distance_fields import DistanceTask


class OBJECT_OT_canonical_form_choose(bpy.types.Operator):
    """Choose feature points by hand: they are kept in a vertex group, and the next run uses them"""  # noqa: D400

    bl_idname = "object.canonical_form_choose"
    bl_label = "Choose Feature Points"
    bl_options = {"REGISTER", "UNDO"}

    how: EnumProperty(  # type: ignore[valid-type]
        name="How",
        items=(
            ("SET", "From Selection", "The selected vertices are the feature points"),
            ("ADD", "Add", "The selected vertices are feature points too"),
            ("REMOVE", "Remove", "The selected vertices are no longer feature points"),
        ),
    )
    group: StringProperty(  # type: ignore[valid-type]
        name="Vertex Group", description="Group that holds the feature points", default=CHOSEN_GROUP
    )

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        """Describe what the button does."""
        descriptions = {
            "SET": "Take the selected vertices for the feature points, one at the tip of each limb",
            "ADD": "Add the selected vertices to the feature points, those of the last run to begin with",
            "REMOVE": "Remove the selected vertices from the feature points",
        }
        return descriptions[properties.how]

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Disable the button, with a reason, where the active object cannot be used."""
        return allowed(cls, JobOperator.busy() or refusal(meant_object(context)))

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Change the group and select it as the source of the feature points."""
        try:
            name, count = choose_features(require_object(context), self.how, self.group)
        except CanonicalFormError as error:
            self.report({"ERROR"}, explained(error))
            return {"CANCELLED"}
        context.scene.canonical_form.feature_source = "GROUP"
        context.scene.canonical_form.feature_group = name
        points = "1 feature point is" if count == 1 else f"{count} feature points are"
        self.report({"INFO"}, f"{points} in the vertex group {name}. Press Compute to use them.")
        return {"FINISHED"}


class OBJECT_OT_canonical_form_distance(JobOperator, bpy.types.Operator):
    """Measure how far all vertices are from the selected ones, into colours and a vertex group"""  # noqa: D400

    bl_idname = "object.canonical_form_distance"
    bl_label = "Distance from Selected"
    bl_options = {"UNDO"}

    kind: EnumProperty(name="Distance", items=DISTANCES, default="heat")  # type: ignore[valid-type]
    isolines: IntProperty(  # type: ignore[valid-type]
        name="Isolines", description="Number of lines of equal distance; 0 for none", default=0, min=0, soft_max=40
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Disable the button, with a reason, where the active object cannot be used."""
        return allowed(cls, cls.busy() or refusal(meant_object(context)))

    def task(self, context: bpy.types.Context) -> "DistanceTask":
        """Read the mesh and its selection, and the other meshes meant."""
        from ..blender.distance_fields import DistanceTask

        memory_limit = context.scene.canonical_form.memory_limit
        objects = chosen_objects(context)[0]
        return DistanceTask(objects, self.kind, self.isolines, memory_limit=memory_limit)

    def written(self, context: bpy.types.Context, task: "DistanceTask", outcome: str, interactive: bool) -> None:
        """Report where the distances are, with the warnings."""
        from ..blender.distance_fields import WEIGHTS

        self.report({"INFO"}, f"Distances are in the colours {outcome} and the vertex group {WEIGHTS.format(outcome)}.")
        self.warn(task.warnings)
        if task.unreached:
            self.report(
                {"WARNING"}, f"{task.unreached:,} vertices cannot be reached from the selection; shown in grey."
            )
        if interactive:
            show_colours(context)


def draw_in_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    """Add the distance fields to Blender's menus of weights and vertex groups.

    Parameters
    ----------
    menu : bpy.types.Menu
        The menu.
    context : bpy.types.Context
        Its context.
    """
    menu.layout.separator()
    menu.layout.operator_menu_enum(
        OBJECT_OT_canonical_form_distance.bl_idname, "kind", text=OBJECT_OT_canonical_form_distance.bl_label
    )


def draw_in_object_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    """Add the main operator to the Object menu, where Blender's search finds it too.

    Parameters
    ----------
    menu : bpy.types.Menu
        The menu.
    context : bpy.types.Context
        Its context.
    """
    menu.layout.separator()
    menu.layout.operator("object.canonical_form")


CLASSES = (OBJECT_OT_canonical_form_choose, OBJECT_OT_canonical_form_distance)
MENUS = (("VIEW3D_MT_paint_weight", draw_in_menu), ("MESH_MT_vertex_group_context_menu", draw_in_menu),
         ("VIEW3D_MT_object", draw_in_object_menu))  # fmt: skip


def register() -> None:
    """Register the operators and add them to menus."""
    for each in CLASSES:
        bpy.utils.register_class(each)
    for name, draw in MENUS:
        getattr(bpy.types, name).append(draw)


def unregister() -> None:
    """Remove the operators from the menus and unregister them."""
    for name, draw in MENUS:
        getattr(bpy.types, name).remove(draw)
    for each in reversed(CLASSES):
        bpy.utils.unregister_class(each)
