"""The panels in the 3D View's sidebar, tab Canonical Form."""

import bpy

from ..blender.result_writing import record_of
from ..core import Settings
from ..core.memory import memory_estimate
from .operators import OBJECT_OT_canonical_form, OBJECT_OT_canonical_form_clear
from .properties import METHOD_NAMES

_CATEGORY = "Canonical Form"
_MAIN = ("quality", "preserve_detail", "prominence")


class VIEW3D_PT_canonical_form(bpy.types.Panel):
    """Compute, and what the last run found."""

    bl_label = "Canonical Form"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = _CATEGORY

    def draw(self, context: bpy.types.Context) -> None:
        """Draw the buttons and the result."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        chosen = context.scene.canonical_form
        for name in _MAIN:
            layout.prop(chosen, name)
        button = layout.operator(OBJECT_OT_canonical_form.bl_idname, text="Compute", icon="ARMATURE_DATA")
        for name in METHOD_NAMES:
            setattr(button, name, getattr(chosen, name))
        obj = context.object
        if obj is not None and obj.type == "MESH":
            count = len(obj.data.vertices)
            memory = memory_estimate(count, Settings(quality=chosen.quality, as_published=chosen.as_published))
            layout.label(text=f"{count:,} vertices, about {memory:.1f} GB", icon="MEMORY")
        record = record_of(obj.data) if obj is not None and obj.type == "MESH" else None
        if record is None:
            return
        keys = obj.data.shape_keys
        key = keys.key_blocks.get(next(iter(record["key"]))) if keys is not None else None
        if key is not None:
            layout.prop(key, "value", text="Pose to Form", slider=True)
        _draw_report(layout.box().column(align=True), record["report"])
        layout.operator(OBJECT_OT_canonical_form_clear.bl_idname, text="Clear", icon="TRASH")


class VIEW3D_PT_canonical_form_advanced(bpy.types.Panel):
    """The options of the method."""

    bl_label = "Advanced"
    bl_parent_id = "VIEW3D_PT_canonical_form"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = _CATEGORY
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draw every option that the main panel does not show."""
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        column = self.layout.column()
        for name in METHOD_NAMES:
            if name not in _MAIN:
                column.prop(context.scene.canonical_form, name)


def _draw_report(column: bpy.types.UILayout, report: dict) -> None:
    measures = report["measures"]
    lines = [
        f"{len(report['feature_points'])} feature points and patches",
        f"{sum(report['timings'].values()):.1f} s, {report['stress']['steps']} steps",
        f"{report['pair_reduction']:.1%} of {report['vertices'] ** 2 / 1e6:.3g} million pairs saved",
        f"Edge distortion: median {measures['edge_distortion_median']:.1%}",
    ]
    if measures["compactness_error"] is not None:
        lines.append(f"Compactness error: {1e4 * measures['compactness_error']:.2f}e-4")
    for line in lines:
        column.label(text=line)
    for warning in report["warnings"]:
        first, *rest = _wrapped(warning, 44)
        column.label(text=first, icon="ERROR")
        for line in rest:
            column.label(text=line, icon="BLANK1")


def _wrapped(sentence: str, width: int) -> list[str]:
    import textwrap

    return textwrap.wrap(sentence, width)


CLASSES = (VIEW3D_PT_canonical_form, VIEW3D_PT_canonical_form_advanced)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
