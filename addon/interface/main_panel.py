"""The main panel: what is used, the limbs of the body, and the wishes."""

import bpy

from ..blender.jobs.likeness import MANNEQUINS
from ..blender.jobs.meant_objects import meant_meshes
from ..blender.objects.movers import armature_of, is_any_moved
from ..blender.words.wording import CONTEXT, told
from ..core import Settings
from ..core.method_api.costs import memory_estimate, time_estimate
from ..core.method_api.registry import OURS
from .body_box import draw_body
from .choices import CanonicalFormChoices, choices_of, hand_over, hand_over_rig, there
from .live_update import OBJECT_OT_canonical_form_live
from .mending import draw_refusal
from .operators import OBJECT_OT_canonical_form
from .pose_operators import OBJECT_OT_canonical_form_pose_like
from .properties import chosen_value
from .rig_operators import OBJECT_OT_canonical_form_rig
from .sidebar import Tab, draw_progress, draw_sentence, told_time

_BIG, _LARGER = 1.5, 1.2  # heights of the buttons of wishes
_MUCH = 4.0  # gigabytes that are told beforehand
_IN_ROWS = ("T", "A", "OBJECT", "RIG", "FORM", "FEATURES", "PATCHES", "TRANSFER", "DISTANCE")


class VIEW3D_PT_canonical_form(Tab, bpy.types.Panel):
    """What is used, the limbs of the body, and what an artist wishes."""

    bl_label = "Canonical Form"
    bl_translation_context = CONTEXT

    def draw(self, context: bpy.types.Context) -> None:
        """Draw them, with the progress of a run in place of the row that started it."""
        layout, objects, choices = self.layout, meant_meshes(context), choices_of(context)
        layout.use_property_decorate = False
        if not objects or choices is None:
            draw_sentence(layout.column(align=True), context, told("Select a mesh, or the armature that moves it."))
            draw_progress(layout, ("", *_IN_ROWS))
            return
        _draw_used(layout, context, choices, objects)
        draw_body(layout, context, choices)
        _draw_wishes(layout, choices)
        draw_progress(layout, ("",))
        draw_refusal(layout, context, choices)
        if choices.method != OURS:
            layout.prop(choices, "method")
        _draw_options(layout, context, choices, objects)


def _draw_used(
    layout: bpy.types.UILayout,
    context: bpy.types.Context,
    choices: CanonicalFormChoices,
    objects: list[bpy.types.Object],
) -> None:
    """Say which meshes are used, and what poses them."""
    column = layout.column(align=True)
    name = objects[0].name
    if len(objects) > 1:
        name = told("{name} and {more} more", name=name, more=len(objects) - 1)
    draw_sentence(column, context, name, "OUTLINER_OB_MESH")
    column.label(text=_told_input(context, choices, objects), icon="BLANK1")  # one line, so that nothing moves


def _told_input(context: bpy.types.Context, choices: CanonicalFormChoices, objects: list[bpy.types.Object]) -> str:
    """Say in which pose the meshes are taken."""
    moved, frame = is_any_moved(objects), context.scene.frame_current
    if not moved or choices.mesh == "BASE":
        return told("Input: without the pose") if moved else told("Input: as modelled")
    rig = armature_of(objects[0])
    if rig is None:
        return told("Input: as shown at frame {frame}", frame=frame)
    return told("Input: frame {frame}, by {rig}", rig=rig.name, frame=frame)


def _draw_wishes(layout: bpy.types.UILayout, choices: CanonicalFormChoices) -> None:
    """Draw a row for each wish, or its progress."""
    column = layout.column()
    row = column.column()
    row.scale_y = _BIG
    if not draw_progress(row, tuple(MANNEQUINS)):
        row = row.row(align=True)
        for pose, label in MANNEQUINS.items():
            draw_pose_button(row, choices, pose, told(label), icon="OUTLINER_OB_ARMATURE" if pose == "T" else "NONE")
    row = column.column()
    row.scale_y = _LARGER
    if not draw_progress(row, ("RIG",)):
        button = row.operator(OBJECT_OT_canonical_form_rig.bl_idname, text=told("Rig"), icon="ARMATURE_DATA")
        hand_over_rig(choices, button)
    row = column.column()
    row.scale_y = _LARGER
    if not draw_progress(row, ("FORM", "PATCHES")):
        row = row.row(align=True)
        button = row.operator(OBJECT_OT_canonical_form.bl_idname, text=told("Straighten"), icon="MOD_ARMATURE")
        hand_over(choices, button)
        button.limb = choices.limb or "ALL"
        row.prop(choices, "limb", text="")
    row = column.column()
    if not draw_progress(row, ("OBJECT",)):
        row = row.row(align=True)
        row.prop(choices, "like", text="")
        part = row.row(align=True)
        part.enabled = there(choices.like) is not None
        draw_pose_button(part, choices, "OBJECT", told("Pose Like"))


def draw_pose_button(
    layout: bpy.types.UILayout, choices: CanonicalFormChoices, pose: str, text: str, *, icon: str = "NONE"
) -> bpy.types.OperatorProperties:
    """Draw a button that applies a pose.

    Parameters
    ----------
    layout : bpy.types.UILayout
        Where.
    choices : CanonicalFormChoices
        The choices for what is meant.
    pose : {'OBJECT', 'T', 'A'}
        Which pose: of the object that is chosen, or of a mannequin.
    text, icon : str
        What the button shows.

    Returns
    -------
    bpy.types.OperatorProperties
        Properties of its operator.
    """
    button = layout.operator(OBJECT_OT_canonical_form_pose_like.bl_idname, text=text, icon=icon)
    hand_over(choices, button)
    button.pose = pose
    like = there(choices.like)
    button.like = like.name if pose == "OBJECT" and like is not None else ""
    button.anyway = choices.anyway
    return button


def _draw_options(
    layout: bpy.types.UILayout,
    context: bpy.types.Context,
    choices: CanonicalFormChoices,
    objects: list[bpy.types.Object],
) -> None:
    """Draw what is rarely changed."""
    header, box = layout.panel("canonical_form_options", default_closed=True)
    header.label(text=told("Options"))
    if box is None:
        return
    box.use_property_split = True
    for name in ("mesh", "result", *(("objects",) if len(objects) > 1 else ()), "quality"):
        box.prop(choices, name)
    seconds, memory = _estimates(choices, objects)
    line = told("Straighten: about {time}", time=told_time(seconds))
    if memory > _MUCH:
        line = told("Straighten: about {time}, {memory:.0f} GB", time=told_time(seconds), memory=memory)
    box.label(text=line, icon="TIME")  # always there, so that nothing moves under the mouse
    box.prop(choices, "preserve_detail")
    row = box.row()
    row.active = there(choices.reference) is None
    row.prop(choices, "orientation")
    for name in ("reference", "anyway", "show_points"):
        box.prop(choices, name)
    live = OBJECT_OT_canonical_form_live.running()
    box.operator(
        OBJECT_OT_canonical_form_live.bl_idname, text=told("Live Update"), icon="RECORD_ON", depress=live is not None
    )
    if live is not None:
        draw_sentence(box.column(align=True), context, live.state, "TIME")


def _estimates(choices: CanonicalFormChoices, objects: list[bpy.types.Object]) -> tuple[float, float]:
    """Estimate the seconds and the gigabytes that a form takes."""
    asked = ("method", "quality", "landmark_count", "pieces")
    settings = Settings(**{name: chosen_value(choices, name) for name in asked})
    counts = [len(obj.data.vertices) for obj in objects]
    runs = counts if choices.objects == "EACH" else [sum(counts)]
    memory = max(memory_estimate(count, settings) for count in runs)
    return sum(time_estimate(count, settings) for count in runs), memory


CLASSES = (VIEW3D_PT_canonical_form,)
