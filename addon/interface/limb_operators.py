"""Operators on the result: remove the pose of single limbs, add smooth in-betweens, select a patch."""

# no `from __future__ import annotations`: Blender reads the annotations below as properties

from typing import TYPE_CHECKING, Any

import bpy
import numpy as np
from bpy.props import BoolProperty, IntProperty

from ..blender.jobs.meant_objects import meant_object, require_object
from ..blender.mesh_items.slider import release
from ..blender.objects.mesh_reading import refusal
from ..blender.objects.object_states import object_mode
from ..blender.records.form_key import form_key
from ..blender.records.hidden_attributes import patches_of
from ..blender.results.companions import companions_of, lead
from ..blender.results.in_betweens import has_in_betweens, remove_in_betweens
from ..blender.results.limb_states import limbs_of, variant_refusal
from ..blender.words.wording import CONTEXT, listed, told
from ..core import InvalidSettingsError
from .job_operator import JobOperator, kept_stages
from .operators import allowed

if TYPE_CHECKING:
    from ..blender.results.variants import VariantTask


class OBJECT_OT_canonical_form_limb(JobOperator, bpy.types.Operator):
    """Take the pose out of this limb, or put it back. The rest of the mesh stays where it is"""  # noqa: D400

    bl_idname = "object.canonical_form_limb"
    bl_label = "Toggle Limb"
    bl_translation_context = CONTEXT
    bl_options = {"UNDO"}

    patch: IntProperty(  # type: ignore[valid-type]
        name="Patch",
        translation_context=CONTEXT,
        description="Number of the patch, from 1; 0 for all",
        default=0,
        min=0,
    )
    only: BoolProperty(  # type: ignore[valid-type]
        name="Only",
        translation_context=CONTEXT,
        description="Take the pose out of this limb and leave it in all others",
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Disable the button, with a reason, if there is no form."""
        return allowed(cls, cls.busy() or variant_refusal(meant_object(context)) or refusal(meant_object(context)))

    def task(self, context: bpy.types.Context) -> "VariantTask":
        """Read the mesh and change the flags of the patches."""
        from ..blender.results.variants import VariantTask

        now = limbs_of(require_object(context).data)
        if self.patch > len(now):
            raise InvalidSettingsError(
                told("Patch {patch} does not exist; there are {count}.", count=len(now), patch=self.patch)
            )
        if self.patch == 0:
            limbs = [True] * len(now)
        elif self.only:
            limbs = [number == self.patch - 1 for number in range(len(now))]
        else:
            limbs = [flag != (number == self.patch - 1) for number, flag in enumerate(now)]
        obj = require_object(context)
        return VariantTask(obj, limbs=limbs, keep=kept_stages(companions_of(obj)))

    def written(self, context: bpy.types.Context, task: "VariantTask", outcome: Any, interactive: bool) -> None:
        """Report how many patches have their pose removed."""
        self.report(
            {"INFO"},
            told("{out} of {count} limbs are straightened.", out=sum(task.limbs), count=len(task.limbs)),
        )
        obj = meant_object(context)
        if self.patch and obj is not None and obj.type == "MESH":
            obj.data.canonical_form_patch = self.patch - 1  # the row that was clicked
        self.warn(task.warnings)


class OBJECT_OT_canonical_form_in_betweens(JobOperator, bpy.types.Operator):
    """Add shape keys between pose and form, driven by one slider, so that limbs unbend like joints"""  # noqa: D400

    bl_idname = "object.canonical_form_in_betweens"
    bl_label = "Smooth In-betweens"
    bl_translation_context = CONTEXT
    bl_options = {"UNDO"}

    count: IntProperty(  # type: ignore[valid-type]
        name="Keys",
        translation_context=CONTEXT,
        description="Number of shape keys between; 0 removes them",
        default=5,
        min=0,
        max=31,
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Disable the button, with a reason, if there is no form."""
        return allowed(cls, cls.busy() or variant_refusal(meant_object(context)) or refusal(meant_object(context)))

    def task(self, context: bpy.types.Context) -> "VariantTask":
        """Read the mesh."""
        from ..blender.results.variants import VariantTask

        obj = require_object(context)
        return VariantTask(obj, in_betweens=self.count, keep=kept_stages(companions_of(obj)))

    def written(self, context: bpy.types.Context, task: "VariantTask", outcome: Any, interactive: bool) -> None:
        """Report the number of keys; another object may be active by then."""
        count = task.in_betweens
        self.report(
            {"INFO"},
            told("{count} keys lie between pose and form.", count=count) if count else told("In-betweens removed."),
        )
        self.warn(task.warnings)


class OBJECT_OT_canonical_form_remove_in_betweens(bpy.types.Operator):
    """Remove the slider and the keys between pose and form. Renamed or changed keys are kept"""  # noqa: D400

    bl_idname = "object.canonical_form_remove_in_betweens"
    bl_label = "Remove In-betweens Anyway"
    bl_translation_context = CONTEXT
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Disable the button, with a reason, if there are none."""
        obj = meant_object(context)
        nothing = obj is None or obj.type != "MESH" or not has_in_betweens(obj.data)
        reason = told("The active object has no in-betweens.") if nothing else refusal(obj)
        return allowed(cls, JobOperator.busy() or reason)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Remove them from the object and its companions."""
        obj = require_object(context)
        with object_mode(obj):
            objects = [each for each in companions_of(obj) if refusal(each) is None]
            left = []
            for each in objects:
                release(each.data.shape_keys)
                left += remove_in_betweens(each)
            lead([each for each in objects if form_key(each.data) is not None])
        if left:
            self.report({"WARNING"}, told("Kept, since they may hold your changes: {left}.", left=listed(left)))
        return {"FINISHED"}


class OBJECT_OT_canonical_form_select_patch(bpy.types.Operator):
    """Select the vertices of this patch. Shift-click to add them to the selection"""  # noqa: D400

    bl_idname = "object.canonical_form_select_patch"
    bl_label = "Select Patch"
    bl_translation_context = CONTEXT
    bl_options = {"REGISTER", "UNDO"}

    patch: IntProperty(  # type: ignore[valid-type]
        name="Patch", translation_context=CONTEXT, description="Number of the patch, from 1", default=1, min=1
    )
    extend: BoolProperty(name="Extend", translation_context=CONTEXT, description="Keep what is selected")  # type: ignore[valid-type]

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Disable the button, with a reason, if there are no patches."""
        obj = meant_object(context)
        nothing = obj is None or obj.type != "MESH" or not len(obj.data.canonical_form_patches)
        return allowed(cls, told("The active object has no patches. Compute them first.") if nothing else refusal(obj))

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Extend the selection if Shift is held."""
        self.extend = event.shift
        return self.execute(context)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Select the vertices, and the edges and faces between them."""
        obj = require_object(context)
        with object_mode(obj):
            for each in companions_of(obj):
                patches = patches_of(each.data)
                if patches is None and each == obj:
                    self.report({"ERROR"}, told("The mesh was changed since the run. Compute it again first."))
                    return {"CANCELLED"}
                if patches is not None and refusal(each) is None:
                    select_vertices(each.data, patches == self.patch - 1, self.extend)
                    each.data.canonical_form_patch = self.patch - 1
        return {"FINISHED"}


def select_vertices(mesh: bpy.types.Mesh, chosen: Any, extend: bool) -> None:
    """Select vertices of a mesh, and the edges and faces between them.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh, with its objects in Object Mode.
    chosen : (n,) ndarray of bool
        The vertices.
    extend : bool
        Keep the current selection.
    """
    if extend:
        now = np.empty(len(mesh.vertices), dtype=bool)
        mesh.vertices.foreach_get("select", now)
        chosen = chosen | now
    _set_selection(mesh, ".select_vert", "POINT", chosen)
    edges = np.empty(2 * len(mesh.edges), dtype=np.int32)
    mesh.edges.foreach_get("vertices", edges)
    _set_selection(mesh, ".select_edge", "EDGE", chosen[edges].reshape(-1, 2).all(axis=1))
    corners = np.empty(len(mesh.loops), dtype=np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    starts = np.empty(len(mesh.polygons), dtype=np.int32)
    mesh.polygons.foreach_get("loop_start", starts)
    whole = np.logical_and.reduceat(chosen[corners], starts) if len(starts) else np.zeros(0, dtype=bool)
    _set_selection(mesh, ".select_poly", "FACE", whole)
    mesh.update()


def _set_selection(mesh: bpy.types.Mesh, name: str, domain: str, values: Any) -> None:
    """Write a selection to a new attribute, as Blender 5.0 crashes on the old one if everything was selected."""
    if name in mesh.attributes:
        mesh.attributes.remove(mesh.attributes[name])
    mesh.attributes.new(name=name, type="BOOLEAN", domain=domain).data.foreach_set("value", values)


CLASSES = (
    OBJECT_OT_canonical_form_limb,
    OBJECT_OT_canonical_form_in_betweens,
    OBJECT_OT_canonical_form_remove_in_betweens,
    OBJECT_OT_canonical_form_select_patch,
)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
