"""The panels in the 3D View's sidebar, tab Canonical Form."""

import textwrap

import bpy

from ..blender.jobs.meant_objects import armature_of, meant_object, meant_objects, require_object
from ..blender.objects.chosen_features import CHOSEN_GROUP
from ..blender.records.form_key import form_key
from ..blender.records.record import Record, require_record
from ..blender.results.companions import companions_of, slider_is_gone
from ..blender.results.in_betweens import PROPERTY, has_in_betweens, renamed_keys
from ..blender.results.limb_states import limbs_of
from ..blender.words.wording import CONTEXT, counted_points, told, told_stage
from ..core import Settings
from ..core.method_api.catalogue import FEATURE_OPTIONS, methods
from ..core.method_api.costs import PIECE_SECONDS, memory_estimate, time_estimate
from ..core.method_api.registry import OURS
from ..core.run.load import slowdown
from .contact_panel import VIEW3D_PT_canonical_form_contacts
from .job_operator import OBJECT_OT_canonical_form_cancel
from .limb_operators import (
    OBJECT_OT_canonical_form_in_betweens,
    OBJECT_OT_canonical_form_limb,
    OBJECT_OT_canonical_form_remove_in_betweens,
    OBJECT_OT_canonical_form_select_patch,
)
from .live_update import OBJECT_OT_canonical_form_live
from .operators import OBJECT_OT_canonical_form, OBJECT_OT_canonical_form_clear
from .pose_panel import VIEW3D_PT_canonical_form_pose_like, least_sure
from .properties import METHOD_NAMES, chosen_value, hand_over
from .rig_panel import VIEW3D_PT_canonical_form_rig
from .sidebar import Tab, record_of
from .tool_operators import OBJECT_OT_canonical_form_choose, OBJECT_OT_canonical_form_distance

_MAIN = ("quality", "preserve_detail")
_EVERY_METHOD = (
    *FEATURE_OPTIONS,
    "method",
    "value",
    "feature_points",
    "quality",
    "pieces",
    "orientation",
    "memory_limit",
)
_BUTTON_SCALE = 1.4  # height of the main button relative to others
_USUAL, _SHORTEST = 42, 20  # characters in a line of the sidebar
_CHARACTER, _MARGIN = 6.4, 55  # width of a character, and of everything next to a line, in pixels
_TOLD = 0.0005  # least edge distortion that is shown: where nothing was unbent, 0.0 % would praise it
_FOLDED = 2  # number of warnings shown without a subpanel


class VIEW3D_PT_canonical_form(Tab, bpy.types.Panel):
    """The main button, the progress of a run, and the options that most runs need."""

    bl_label = "Canonical Form"
    bl_translation_context = CONTEXT

    def draw(self, context: bpy.types.Context) -> None:
        """Draw the button, or the progress, and the options."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        chosen, obj, objects = context.scene.canonical_form, meant_object(context), meant_objects(context)
        job = OBJECT_OT_canonical_form_cancel.job
        if job is not None:
            row = layout.row(align=True)
            row.scale_y = _BUTTON_SCALE
            row.progress(factor=job.fraction, text=f"{job.fraction:.0%}  {told_stage(job.stage)}", type="BAR")
            row.operator(OBJECT_OT_canonical_form_cancel.bl_idname, text="", icon="X")
        else:
            row = layout.row(align=True)
            row.scale_y = _BUTTON_SCALE
            label = told("Compute {count} Objects", count=len(objects)) if len(objects) > 1 else told("Compute")
            button = row.operator(OBJECT_OT_canonical_form.bl_idname, text=label, icon="ARMATURE_DATA")
            hand_over(chosen, button)
            live = OBJECT_OT_canonical_form_live.running()
            row.operator(OBJECT_OT_canonical_form_live.bl_idname, text="", icon="PLAY", depress=live is not None)
            if live is not None:
                _draw_sentence(layout.column(align=True), live.state, _line_length(context), "TIME")
        if chosen_value(chosen, "method") != OURS:
            layout.prop(chosen, "method")
        for name in (*_MAIN, "mesh", "result"):
            layout.prop(chosen, name)
        row = layout.row()
        row.active = not chosen.reference
        row.prop(chosen, "orientation")
        layout.prop_search(chosen, "reference", bpy.data, "objects")
        if len(objects) > 1:
            layout.prop(chosen, "objects")
        _offer_shown(layout, chosen, obj)
        if obj is not None and obj.type == "MESH":
            layout.label(text=_estimate(chosen, objects), icon="MEMORY")


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
        """Draw the slider, the measures, the warnings and Clear."""
        layout, objects = self.layout, companions_of(require_object(context))
        mesh, record = objects[0].data, require_record(require_object(context).data)
        layout.use_property_decorate = False
        key = form_key(mesh)
        if slider_is_gone(objects[0]):
            layout.label(text=told("Its slider is gone. Compute again"), icon="ERROR")
        if has_in_betweens(mesh):
            row = layout.row(align=True)
            row.prop(mesh.shape_keys, f'["{PROPERTY}"]', text=_slider(record), slider=True)
            row.operator(OBJECT_OT_canonical_form_in_betweens.bl_idname, text="", icon="X").count = 0
            if renamed_keys(mesh):
                said = told("A key was renamed. Restore its name, or")
                _draw_sentence(layout.column(align=True), said, _line_length(context), "ERROR")
                layout.operator(OBJECT_OT_canonical_form_remove_in_betweens.bl_idname, text=told("Remove Anyway"))
        elif key is not None:
            layout.prop(key, "value", text=_slider(record), slider=True)
        if key is not None or has_in_betweens(mesh):  # always shown, so that nothing moves under the mouse
            row = layout.row(align=True)
            chosen = context.scene.canonical_form
            button = row.operator(
                OBJECT_OT_canonical_form_in_betweens.bl_idname, text=told("In-betweens"), icon="IPO_EASE_IN_OUT"
            )
            button.count = chosen.in_betweens
            row.prop(chosen, "in_betweens")
        if len(objects) > 1:
            layout.label(text=told("{count} objects are one body", count=len(objects)), icon="OBJECT_DATA")
        _draw_frame(layout, record, context.scene)
        _draw_report(layout.column(align=True), record)
        _draw_warnings(layout, record.report.warnings, _line_length(context))
        layout.prop(context.scene.canonical_form, "show_points")
        layout.operator(OBJECT_OT_canonical_form_clear.bl_idname, text=told("Clear"), icon="TRASH")


class VIEW3D_UL_canonical_form_patches(bpy.types.UIList):
    """The patches with their colours."""

    def draw_item(self, context, layout, data, item, icon, active_data, active_property, index=0, flt_flag=0):  # type: ignore[no-untyped-def]
        """Draw one row: colour, name, and whether the key removes the pose of this limb."""
        limbs = limbs_of(data)
        row = layout.row(align=True)
        swatch = row.row()
        swatch.ui_units_x = 1.2
        swatch.enabled = not data.is_editmode  # colours cannot be written in Edit Mode
        swatch.prop(item, "colour", text="")
        button = row.operator(
            OBJECT_OT_canonical_form_select_patch.bl_idname, text=f"{item.name}  ({item.size:,})", emboss=False
        )
        button.patch = index + 1
        if index < len(limbs):
            only = row.operator(OBJECT_OT_canonical_form_limb.bl_idname, text="", icon="SOLO_ON", emboss=False)
            only.patch, only.only = index + 1, True
            icon = "CHECKBOX_HLT" if limbs[index] else "CHECKBOX_DEHLT"
            toggle = row.operator(OBJECT_OT_canonical_form_limb.bl_idname, text="", icon=icon, emboss=False)
            toggle.patch, toggle.only = index + 1, False


class VIEW3D_PT_canonical_form_patches(Tab, bpy.types.Panel):
    """The patches: a click selects their vertices, the check box takes the pose out of the limb."""

    bl_label = "Patches"
    bl_translation_context = CONTEXT
    bl_parent_id = "VIEW3D_PT_canonical_form"

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
        limbs = limbs_of(mesh)
        if limbs:
            row = layout.row()
            row.enabled = not all(limbs)  # always shown, so that nothing moves under the mouse
            every = row.operator(OBJECT_OT_canonical_form_limb.bl_idname, text=told("All Limbs"), icon="CHECKBOX_HLT")
            every.patch = 0


class VIEW3D_PT_canonical_form_features(Tab, bpy.types.Panel):
    """The source of the feature points."""

    bl_label = "Feature Points"
    bl_translation_context = CONTEXT
    bl_parent_id = "VIEW3D_PT_canonical_form"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draw the source of the feature points, its options, and the steps."""
        layout, chosen, obj = self.layout, context.scene.canonical_form, meant_object(context)
        layout.use_property_split = True
        layout.use_property_decorate = False
        row = layout.row()
        row.use_property_split = False
        row.prop(chosen, "feature_source", expand=True)
        if chosen.feature_source == "DETECTED":
            layout.prop(chosen, "feature_count")
            row = layout.row()
            row.active = chosen.feature_count == 0
            row.prop(chosen, "prominence")
        elif obj is not None and obj.type == "MESH":
            layout.prop_search(chosen, "feature_group", obj, "vertex_groups", text=told("Group"))
        row = layout.row(align=True)
        for how, text, icon in (("SET", "From Selection", "NONE"), ("ADD", "", "ADD"), ("REMOVE", "", "REMOVE")):
            button = row.operator(OBJECT_OT_canonical_form_choose.bl_idname, text=text, icon=icon)
            button.how, button.group = how, chosen.feature_group or CHOSEN_GROUP
        row = layout.row(align=True)
        for step, text in (("FEATURES", told("Detect Only")), ("PATCHES", told("Patches Only"))):
            button = row.operator(OBJECT_OT_canonical_form.bl_idname, text=text)
            hand_over(chosen, button)
            button.step = step


class VIEW3D_PT_canonical_form_distance(Tab, bpy.types.Panel):
    """Distances from the selected vertices."""

    bl_label = "Distance from Selected"
    bl_translation_context = CONTEXT
    bl_parent_id = "VIEW3D_PT_canonical_form"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draw the kind, the isolines and the button."""
        layout, chosen = self.layout, context.scene.canonical_form
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(chosen, "distance", text=told("Kind"))
        layout.prop(chosen, "isolines")
        button = layout.operator(
            OBJECT_OT_canonical_form_distance.bl_idname, text=told("Measure"), icon="DRIVER_DISTANCE"
        )
        button.kind, button.isolines = chosen_value(chosen, "distance"), chosen.isolines


class VIEW3D_PT_canonical_form_advanced(Tab, bpy.types.Panel):
    """The options of the method."""

    bl_label = "Advanced"
    bl_translation_context = CONTEXT
    bl_parent_id = "VIEW3D_PT_canonical_form"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draw every option that the other panels do not show."""
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        column, chosen = self.layout.column(), context.scene.canonical_form
        method = methods()[chosen_value(chosen, "method")]
        for name in ("value", *METHOD_NAMES):
            if name not in (*_MAIN, "orientation", "prominence", "feature_count", "contacts"):
                row = column.row()
                row.active = name in (*_EVERY_METHOD, *method.uses) and name not in method.fixed
                row.prop(chosen, name)


def _estimate(chosen: bpy.types.PropertyGroup, objects: list[bpy.types.Object]) -> str:
    """Estimate memory and time of a run."""
    asked = ("method", "quality", "landmark_count", "pieces")
    settings = Settings(**{name: chosen_value(chosen, name) for name in asked})
    counts = [len(obj.data.vertices) for obj in objects]
    runs = counts if chosen.objects == "EACH" else [sum(counts)]
    memory = max(memory_estimate(count, settings) for count in runs)
    seconds = max(slowdown() * sum(time_estimate(count, settings) for count in runs), 1.0)
    estimate = told("{count:,} vertices, about {memory:.1f} GB, {seconds:,.0f} s", count=sum(counts), memory=memory,
                    seconds=seconds)  # fmt: skip
    return estimate if settings.together else told("{estimate} and {each:g} s a loose part", estimate=estimate,
                                                   each=PIECE_SECONDS)  # fmt: skip


def _slider(record: Record) -> str:
    """Return the name of the slider."""
    like = record.report.like
    return told("Pose to Form") if like is None else told("Pose to {key}", key=like.key)


def _draw_report(column: bpy.types.UILayout, record: Record) -> None:
    """Draw the results and measures, one per line."""
    report = record.report
    seconds = report.seconds
    distortion = told("Edge distortion: median {distortion:.1%}", distortion=report.edge_distortion or 0.0)
    if report.like is not None:
        sure = told("{confidence:.0%} match confidence, {seconds:.1f} s", confidence=report.like.confidence,
                    seconds=seconds)  # fmt: skip
        if report.like.source == "bones":
            sure = told("By the bones of its rig, {seconds:.1f} s", seconds=seconds)
        lines = [sure, *least_sure(report.like.bones), distortion]
    else:
        found = counted_points(len(report.feature_points), record.has_patches)
        lines = [told("{points}, {seconds:.1f} s", points=found, seconds=seconds)]
        if report.has_form:
            lines += _limbs_told(report.measures)
            if report.method is not None and report.method != OURS:
                known = methods().get(report.method)  # a file may be from a later version
                label = report.method if known is None else told(known.label)
                lines.insert(0, told("Method: {method}", method=label))
            saved = report.pair_reduction
            if saved > 0:  # a mesh of a few vertices has more distances than pairs
                pairs = report.pair_count / (1 - saved) if saved < 1 else report.pair_count
                lines.append(told("{saved:.1%} of {pairs:.3g} million pairs saved", saved=saved, pairs=pairs / 1e6))
            if (report.edge_distortion or 0.0) >= _TOLD:
                lines.append(distortion)
            if report.compactness_error is not None:
                lines.append(told("Compactness error: {error:.2f} · 10⁻⁴", error=1e4 * report.compactness_error))
    for line in lines:
        column.label(text=line)


def _limbs_told(measures: dict[str, float | None]) -> list[str]:
    """Say how many limbs were straightened, in a line or none."""
    bent, count = (int(measures.get(name) or 0) for name in ("limbs_bent", "limbs_straightened"))
    if bent == 0:
        return []
    before, after = (measures.get(name) or 0.0 for name in ("bend_in_pose", "bend_in_form"))
    return [
        told("Straightened {count} of {bent} limbs: {before:.0f}° to {after:.0f}°", count=count, bent=bent,
             before=before, after=after)
    ]  # fmt: skip


def _offer_shown(layout: bpy.types.UILayout, chosen: bpy.types.PropertyGroup, obj: bpy.types.Object | None) -> None:
    """Offer the displayed pose if an armature deforms the mesh and the base mesh would be used."""
    rig = armature_of(obj) if obj is not None and obj.type == "MESH" else None
    if rig is not None and chosen.mesh != "SHOWN":
        layout.label(text=told("{name} poses the mesh:", name=rig.name), icon="ARMATURE_DATA")
        row = layout.row()
        row.use_property_split = False
        row.prop_enum(chosen, "mesh", "SHOWN", text=told("Take the Pose as Shown"))


def _draw_frame(layout: bpy.types.UILayout, record: Record, scene: bpy.types.Scene) -> None:
    """Show the frame of the form, and offer another run if the scene is at a different frame."""
    frame = record.report.frame
    if frame is None:
        return
    row = layout.row()
    row.label(text=told("The pose of frame {frame}", frame=frame))
    if scene.frame_current != frame and record.report.has_form:
        button = row.operator(
            OBJECT_OT_canonical_form.bl_idname, text=told("Again at {frame}", frame=scene.frame_current)
        )
        hand_over(scene.canonical_form, button)
        button.mesh = "SHOWN"


def _draw_warnings(layout: bpy.types.UILayout, warnings: list[str], length: int) -> None:
    """Draw the warnings, collapsed under their number if there are many."""
    if len(warnings) > _FOLDED:
        header, layout = layout.panel("canonical_form_warnings", default_closed=True)
        header.label(text=told("{count} warnings", count=len(warnings)), icon="ERROR")
    if layout is None:
        return
    column = layout.column(align=True)
    for warning in warnings:
        _draw_sentence(column, warning, length, "ERROR")


def _draw_sentence(layout: bpy.types.UILayout, sentence: str, length: int, icon: str) -> None:
    """Draw a sentence over as many lines as it needs."""
    for number, line in enumerate(textwrap.wrap(sentence, length)):
        layout.label(text=line, icon="BLANK1" if number else icon)


def _line_length(context: bpy.types.Context) -> int:
    """Estimate the number of characters that fit into a line of the region."""
    if context.region is None:  # in background mode
        return _USUAL
    width = context.region.width / context.preferences.system.ui_scale
    return max(_SHORTEST, int((width - _MARGIN) / _CHARACTER))


CLASSES = (
    VIEW3D_UL_canonical_form_patches,
    VIEW3D_PT_canonical_form,
    VIEW3D_PT_canonical_form_result,
    VIEW3D_PT_canonical_form_patches,
    VIEW3D_PT_canonical_form_pose_like,
    VIEW3D_PT_canonical_form_rig,
    VIEW3D_PT_canonical_form_features,
    VIEW3D_PT_canonical_form_contacts,
    VIEW3D_PT_canonical_form_distance,
    VIEW3D_PT_canonical_form_advanced,
)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
