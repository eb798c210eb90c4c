"""The panel of the result: its slider, whether it looks right, its limbs, and what can be done with it."""

import bpy

from ..blender.jobs.likeness import MANNEQUINS
from ..blender.jobs.meant_objects import require_object
from ..blender.records.form_key import form_key
from ..blender.records.form_report import LikeReport
from ..blender.records.record import Record, require_record
from ..blender.records.rig_record import DOUBTFUL
from ..blender.results.companions import companions_of, slider_is_gone
from ..blender.results.in_betweens import PROPERTY, has_in_betweens, renamed_keys
from ..blender.results.limb_states import limbs_of
from ..blender.words.advice import CUT
from ..blender.words.limb_words import told_part
from ..blender.words.wording import CONTEXT, told
from .choices import CanonicalFormChoices, choices_of, hand_over
from .keeping_operators import OBJECT_OT_canonical_form_copy, OBJECT_OT_canonical_form_keep
from .limb_operators import (
    OBJECT_OT_canonical_form_in_betweens,
    OBJECT_OT_canonical_form_limb,
    OBJECT_OT_canonical_form_remove_in_betweens,
    OBJECT_OT_canonical_form_select_patch,
)
from .mending import draw_fix, draw_mends, limb_of_bone
from .operators import OBJECT_OT_canonical_form, OBJECT_OT_canonical_form_clear
from .pose_operators import OBJECT_OT_canonical_form_pose_like
from .preferences import preferences_of
from .sidebar import Tab, draw_sentence, record_of

_FOLDED = 2  # number of warnings shown without a subpanel
_SURE = 0.4  # mean confidence of a match above which nothing is said


class VIEW3D_PT_canonical_form_result(Tab, bpy.types.Panel):
    """The result of the last run and what can be done with it."""

    bl_label = "Result"
    bl_translation_context = CONTEXT
    bl_parent_id = "VIEW3D_PT_canonical_form"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Show the panel if there is a result."""
        return record_of(context) is not None

    def draw(self, context: bpy.types.Context) -> None:
        """Draw the slider, the verdict with what mends it, and Clear."""
        layout, objects = self.layout, companions_of(require_object(context))
        mesh, record = objects[0].data, require_record(require_object(context).data)
        choices = choices_of(context)
        layout.use_property_decorate = False
        key = form_key(mesh)
        if slider_is_gone(objects[0]):
            draw_sentence(layout, context, told("Its slider is gone. Compute again"), "ERROR")
        if has_in_betweens(mesh):
            row = layout.row(align=True)
            row.prop(mesh.shape_keys, f'["{PROPERTY}"]', text=_slider(record), slider=True)
            row.operator(OBJECT_OT_canonical_form_in_betweens.bl_idname, text="", icon="X").count = 0
            if renamed_keys(mesh):
                said = told("A key was renamed. Restore its name, or")
                draw_sentence(layout.column(align=True), context, said, "ERROR")
                layout.operator(OBJECT_OT_canonical_form_remove_in_betweens.bl_idname, text=told("Remove Anyway"))
        elif key is not None:
            layout.prop(key, "value", text=_slider(record), slider=True)
        if choices is not None:
            _draw_verdict(layout, context, choices, record)
        if (key is not None or has_in_betweens(mesh)) and choices is not None:
            row = layout.row(align=True)  # always shown, so that nothing moves under the mouse
            button = row.operator(
                OBJECT_OT_canonical_form_in_betweens.bl_idname, text=told("In-betweens"), icon="IPO_EASE_IN_OUT"
            )
            button.count = choices.in_betweens
            row.prop(choices, "in_betweens", text="")
        row = layout.row(align=True)
        if record.has_form:
            row.operator(OBJECT_OT_canonical_form_keep.bl_idname, text=told("Keep as Rest"))
            row.operator(OBJECT_OT_canonical_form_copy.bl_idname, text=told("New Object"))
            row = layout.row(align=True)
        row.operator(OBJECT_OT_canonical_form_clear.bl_idname, text=told("Clear"))


def _draw_verdict(
    layout: bpy.types.UILayout, context: bpy.types.Context, choices: CanonicalFormChoices, record: Record
) -> None:
    """Say whether the result looks right, and draw the buttons that mend it."""
    report, like = record.report, record.report.like
    warnings = report.doubts
    unsure = [] if like is None else least_sure(like.bones)
    column = layout.column(align=True)
    frame = report.frame
    if frame is not None:
        row = column.row(align=True)
        row.label(text=told("Of frame {frame} (bones stay posed)", frame=frame))
        if context.scene.frame_current != frame and report.has_form:
            button = row.operator(
                OBJECT_OT_canonical_form.bl_idname, text=told("Again at {frame}", frame=context.scene.frame_current)
            )
            hand_over(choices, button)
            button.mesh = "SHOWN"
    hardly_alike = like is not None and like.source == "match" and like.confidence < _SURE
    draw_unsure(column, context, unsure)
    if hardly_alike:
        draw_sentence(column, context, told("The bodies are hardly alike: check the pose"), "ERROR")
    if not warnings and not unsure and not hardly_alike and record.has_form:
        draw_sentence(column, context, told("No warnings: look from all sides"), "HIDE_OFF")
    draw_warnings(layout, context, warnings)
    mends = {report.mends[each] for each in warnings if each in report.mends}
    draw_mends(layout, context, choices, mends)
    if CUT in mends and record.has_form:
        _draw_cut(layout, choices, like)
    if like is not None:
        draw_other_side(layout, choices, like)


def _draw_cut(layout: bpy.types.UILayout, choices: CanonicalFormChoices, like: LikeReport | None) -> None:
    """Draw the button that makes the result again as an object that is cut open where skin was parted."""
    if like is None:
        button = layout.operator(OBJECT_OT_canonical_form.bl_idname, text=told("Cut in a New Object"))
        hand_over(choices, button)
    else:
        button = _draw_again(layout, choices, like, told("Cut in a New Object"), like.side)
    button.result = "OBJECT"


def _draw_again(
    layout: bpy.types.UILayout,
    choices: CanonicalFormChoices,
    like: LikeReport,
    text: str,
    side: int,
    icon: str = "NONE",
) -> bpy.types.OperatorProperties:
    """Draw a button that takes the same pose again, of a side; return the properties of its operator."""
    button = layout.operator(OBJECT_OT_canonical_form_pose_like.bl_idname, text=text, icon=icon)
    hand_over(choices, button)
    button.pose, button.like, button.anyway, button.side = like.pose, like.name, choices.anyway, side
    return button


def draw_warnings(layout: bpy.types.UILayout, context: bpy.types.Context, warnings: list[str]) -> None:
    """Draw the warnings, collapsed under their number if there are many.

    Parameters
    ----------
    layout : bpy.types.UILayout
        Where.
    context : bpy.types.Context
        Any context.
    warnings : list of str
        The sentences, in the user's language.
    """
    inside: bpy.types.UILayout | None = layout
    if len(warnings) > _FOLDED:
        header, inside = layout.panel("canonical_form_warnings", default_closed=True)
        header.label(text=told("{count} warnings", count=len(warnings)), icon="ERROR")
    if inside is None:
        return
    column = inside.column(align=True)
    for warning in warnings:
        draw_sentence(column, context, warning, "ERROR")


def _slider(record: Record) -> str:
    """Return the name of the slider."""
    like = record.report.like
    return told("Pose to Form") if like is None else told("Pose to {key}", key=like.key)


def least_sure(bones: dict[str, float]) -> list[str]:
    """Name the bone that fits worst, if it hardly fits.

    Parameters
    ----------
    bones : dict of str to float
        How well each bone fits, 0 to 1.

    Returns
    -------
    list of str
        Its name, or none.
    """
    name = min(bones, key=lambda each: bones[each], default="")
    return [name] if bones.get(name, 1.0) < DOUBTFUL else []


def draw_unsure(layout: bpy.types.UILayout, context: bpy.types.Context, bones: list[str]) -> None:
    """Say which bones hardly fit, with the button that fixes their limbs.

    Parameters
    ----------
    layout : bpy.types.UILayout
        Where.
    context : bpy.types.Context
        Any context.
    bones : list of str
        Their names.
    """
    for bone in bones:
        draw_sentence(layout, context, told("Check {bone}: it hardly fits", bone=bone), "ERROR")
        limb = limb_of_bone(bone)
        if limb:
            draw_fix(layout, limb)


def draw_other_side(layout: bpy.types.UILayout, choices: CanonicalFormChoices, like: LikeReport | None) -> None:
    """Draw the button that matches another side, if there are several.

    Parameters
    ----------
    layout : bpy.types.UILayout
        Where.
    choices : CanonicalFormChoices
        The choices for what is meant.
    like : LikeReport or None
        How the object was posed like another.
    """
    if like is None or len(like.sides) < 2:
        return
    text, side = next_side(like.side, len(like.sides), stands=like.pose in MANNEQUINS)
    _draw_again(layout, choices, like, text, side, "FILE_REFRESH")


def next_side(side: int, count: int, *, stands: bool) -> tuple[str, int]:
    """Name the button that takes the next way to face, and return that.

    Parameters
    ----------
    side : int
        The present one.
    count : int
        How many there are.
    stands : bool
        Whether a body that stands was matched with a mannequin: it faces one way or the other.

    Returns
    -------
    text : str
        What the button says.
    side : int
        The next one.
    """
    following = (side + 1) % count
    if stands and count == 2:
        return told("Flip Front/Back"), following
    return told("Other Side ({side} of {count})", side=following + 1, count=count), following


class VIEW3D_UL_canonical_form_patches(bpy.types.UIList):
    """The limbs with their colours."""

    def draw_item(self, context, layout, data, item, icon, active_data, active_property, index=0, flt_flag=0):  # type: ignore[no-untyped-def]
        """Draw one row: colour, name, and whether the key removes the pose of this limb."""
        limbs = limbs_of(data)
        row = layout.row(align=True)
        swatch = row.row()
        swatch.ui_units_x = 1.2
        swatch.enabled = not data.is_editmode  # colours cannot be written in Edit Mode
        swatch.prop(item, "colour", text="")
        names = require_record(data).report.feature_names
        text = told_part(names[index] if index < len(names) else "", index + 1)
        button = row.operator(OBJECT_OT_canonical_form_select_patch.bl_idname, text=text, emboss=False)
        button.patch = index + 1
        if index < len(limbs):
            only = row.operator(OBJECT_OT_canonical_form_limb.bl_idname, text="", icon="SOLO_ON", emboss=False)
            only.patch, only.only = index + 1, True
            icon = "CHECKBOX_HLT" if limbs[index] else "CHECKBOX_DEHLT"
            toggle = row.operator(OBJECT_OT_canonical_form_limb.bl_idname, text="", icon=icon, emboss=False)
            toggle.patch, toggle.only = index + 1, False


class VIEW3D_PT_canonical_form_limbs(Tab, bpy.types.Panel):
    """The limbs: a click selects their vertices, the check box takes the pose out of the limb."""

    bl_label = "Limbs"
    bl_translation_context = CONTEXT
    bl_parent_id = "VIEW3D_PT_canonical_form_result"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Show the panel if there are patches."""
        return record_of(context) is not None and len(require_object(context).data.canonical_form_patches) > 0

    def draw(self, context: bpy.types.Context) -> None:
        """Draw the list."""
        layout, mesh = self.layout, require_object(context).data
        lines = min(len(mesh.canonical_form_patches), 10)
        layout.template_list(
            "VIEW3D_UL_canonical_form_patches", "", mesh, "canonical_form_patches", mesh, "canonical_form_patch",
            rows=lines, maxrows=10,
        )  # fmt: skip
        limbs, preferences = limbs_of(mesh), preferences_of(context)
        row = layout.row()
        part = row.row()
        part.enabled = bool(limbs) and not all(limbs)  # always shown, so that nothing moves under the mouse
        part.operator(OBJECT_OT_canonical_form_limb.bl_idname, text=told("All Limbs")).patch = 0
        if preferences is not None:
            row.prop(preferences, "show_colours", toggle=True)


CLASSES = (VIEW3D_UL_canonical_form_patches, VIEW3D_PT_canonical_form_result, VIEW3D_PT_canonical_form_limbs)
