"""The panels for researchers: the figures of the last run, feature points, and the options of the method."""

import bpy

from ..blender.jobs.meant_objects import meant_object
from ..blender.objects.chosen_features import CHOSEN_GROUP
from ..blender.records.record import Record
from ..blender.words.wording import CONTEXT, counted_points, told
from ..core.method_api.catalogue import FEATURE_OPTIONS, methods
from ..core.method_api.registry import OURS
from .choices import CanonicalFormChoices, choices_of, hand_over
from .operators import OBJECT_OT_canonical_form
from .properties import METHOD_NAMES, chosen_value
from .sidebar import Tab, draw_sentence, record_of
from .tool_operators import OBJECT_OT_canonical_form_choose

_READINGS = ("start", "pair_weight", "biharmonic_scale")  # of the paper: shown with its methods only
_ELSEWHERE = ("quality", "preserve_detail", "orientation", "prominence", "feature_count", "contacts")
_EVERY_METHOD = (
    *FEATURE_OPTIONS,
    "method",
    "value",
    "feature_points",
    "feature_names",
    "quality",
    "pieces",
    "orientation",
    "memory_limit",
)
_TOLD = 0.0005  # least edge distortion that is shown: where nothing was unbent, 0.0 % would praise it


class VIEW3D_PT_canonical_form_research(Tab, bpy.types.Panel):
    """What a researcher measures and changes."""

    bl_label = "For Researchers"
    bl_translation_context = CONTEXT
    bl_parent_id = "VIEW3D_PT_canonical_form"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Show the panel if there is something to compute."""
        return choices_of(context) is not None

    def draw(self, context: bpy.types.Context) -> None:
        """Draw the figures of the last run."""
        record, column = record_of(context), self.layout.column(align=True)
        if record is None:
            return
        for line in figures_of(record):
            draw_sentence(column, context, line)
        for note in record.report.notes:
            draw_sentence(column, context, note, "INFO")


class VIEW3D_PT_canonical_form_features(Tab, bpy.types.Panel):
    """The source of the feature points."""

    bl_label = "Feature Points"
    bl_translation_context = CONTEXT
    bl_parent_id = "VIEW3D_PT_canonical_form_research"

    def draw(self, context: bpy.types.Context) -> None:
        """Draw the source of the feature points, its options, and the steps."""
        layout, choices, obj = self.layout, choices_of(context), meant_object(context)
        if choices is None:
            return
        layout.use_property_split = True
        layout.use_property_decorate = False
        row = layout.row()
        row.use_property_split = False
        row.prop(choices, "feature_source", expand=True)
        if choices.feature_source == "DETECTED":
            layout.prop(choices, "feature_count")
            row = layout.row()
            row.active = choices.feature_count == 0
            row.prop(choices, "prominence")
        elif obj is not None and obj.type == "MESH":
            layout.prop_search(choices, "feature_group", obj, "vertex_groups", text=told("Group"))
        row = layout.row(align=True)
        for how, text, icon in (("SET", "From Selection", "NONE"), ("ADD", "", "ADD"), ("REMOVE", "", "REMOVE")):
            button = row.operator(OBJECT_OT_canonical_form_choose.bl_idname, text=text, icon=icon)
            button.how, button.group = how, choices.feature_group or CHOSEN_GROUP
        row = layout.row(align=True)
        for step, text in (("FEATURES", told("Detect Only")), ("PATCHES", told("Patches Only"))):
            _draw_step(row, choices, step, text)


def _draw_step(layout: bpy.types.UILayout, choices: CanonicalFormChoices, step: str, text: str) -> None:
    """Draw the button of a step."""
    button = layout.operator(OBJECT_OT_canonical_form.bl_idname, text=text)
    hand_over(choices, button)
    button.step = step


class VIEW3D_PT_canonical_form_method(Tab, bpy.types.Panel):
    """The options of the method."""

    bl_label = "Method"
    bl_translation_context = CONTEXT
    bl_parent_id = "VIEW3D_PT_canonical_form_research"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draw every option that the other panels do not show."""
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        column, choices = self.layout.column(), choices_of(context)
        if choices is None:
            return
        method = methods()[chosen_value(choices, "method")]
        for name in ("value", *METHOD_NAMES):
            if name not in _ELSEWHERE and (name not in _READINGS or name in method.uses):
                row = column.row()
                row.active = name in (*_EVERY_METHOD, *method.uses) and name not in method.fixed
                row.prop(choices, name)


def figures_of(record: Record) -> list[str]:
    """List the figures of a run.

    Parameters
    ----------
    record : Record
        The record of the run.

    Returns
    -------
    list of str
        One line each.
    """
    report = record.report
    seconds = report.seconds
    distortion = told("Edge distortion: median {distortion:.1%}", distortion=report.edge_distortion or 0.0)
    if report.like is not None:
        sure = told("{confidence:.0%} match confidence, {seconds:.1f} s", confidence=report.like.confidence,
                    seconds=seconds)  # fmt: skip
        if report.like.source == "bones":
            sure = told("By the bones of its rig, {seconds:.1f} s", seconds=seconds)
        return [sure, distortion]
    found = counted_points(len(report.feature_points), record.has_patches)
    lines = [told("{points}, {seconds:.1f} s", points=found, seconds=seconds)]
    if not report.has_form:
        return lines
    if report.method is not None and report.method != OURS:
        known = methods().get(report.method)  # a file may be from a later version
        label = report.method if known is None else told(known.label)
        lines.insert(0, told("Method: {method}", method=label))
    lines += _limbs_told(report.measures)
    if report.pair_reduction > 0:  # a mesh of a few vertices has more distances than pairs
        lines.append(told("{count:,} pairs, {saved:.2%} saved", count=report.pair_count, saved=report.pair_reduction))
    if (report.edge_distortion or 0.0) >= _TOLD:
        lines.append(distortion)
    if report.compactness_error is not None:
        lines.append(told("Compactness error: {error:.2f} · 10⁻⁴", error=1e4 * report.compactness_error))
    return lines


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


CLASSES = (
    VIEW3D_PT_canonical_form_research,
    VIEW3D_PT_canonical_form_features,
    VIEW3D_PT_canonical_form_method,
)
