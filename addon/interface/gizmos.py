"""The dots of the limbs as handles: dragged along the surface, they fix where a limb ends."""

# no `from __future__ import annotations`: Blender reads the annotations below

from typing import Any

import bpy
from mathutils import Matrix, Vector

from ..blender.jobs.meant_objects import meant_meshes
from ..blender.objects.picking import Picked
from ..core.symmetry.limb_names import mate_of
from .choices import choices_of
from .job_operator import OBJECT_OT_canonical_form_cancel
from .overlay import ShownPoint, shown_points
from .point_operators import OBJECT_OT_canonical_form_fix_point, under_mouse

_RADIUS = 9.0  # in pixels, of what takes the mouse
_MOST = 16  # handles


class VIEW3D_GT_canonical_form_point(bpy.types.Gizmo):
    """The handle of one point."""

    bl_idname = "VIEW3D_GT_canonical_form_point"
    point: ShownPoint | None
    at: Vector | None
    found: Picked | None

    def setup(self) -> None:
        """Begin without a point."""
        self.point = self.at = self.found = None

    def draw(self, context: bpy.types.Context) -> None:
        """Draw a ring where the mouse is over the dot, or drags it; the dot itself is part of the overlay."""
        if self.at is not None and (self.is_highlight or self.is_modal):
            radius = _RADIUS * context.preferences.system.ui_scale
            self.draw_preset_circle(Matrix.Translation(self.at.to_3d()) @ Matrix.Scale(radius, 4))

    def test_select(self, context: bpy.types.Context, location: Any) -> int:
        """Return whether the mouse is over the dot."""
        if self.at is None:
            return -1
        radius = _RADIUS * context.preferences.system.ui_scale
        return 0 if (Vector(location) - self.at).length <= radius else -1

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Begin to drag."""
        self.found = None
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event, tweak: set[str]) -> set[str]:
        """Follow the mouse on the body."""
        if event.type == "MOUSEMOVE":
            self.found = under_mouse(context, event, context.region, context.region_data)
            self.at = Vector((event.mouse_region_x, event.mouse_region_y))
            context.area.tag_redraw()
        return {"RUNNING_MODAL"}

    def exit(self, context: bpy.types.Context, cancel: bool) -> None:
        """Fix the point where it was dropped; beside the body, or with Esc, it stays where it was."""
        point, found = self.point, self.found
        self.found = None
        if cancel or point is None or found is None or (found.obj, found.vertex) == (point.obj, point.vertex):
            return
        name = mate_of(point.name) if found.image else point.name
        where = {"limb": name or "other", "owner": found.obj.name, "vertex": found.vertex}
        if name:
            bpy.ops.object.canonical_form_fix_point("INVOKE_DEFAULT", True, **where)  # True: with an undo step
        elif bpy.ops.object.canonical_form_fix_point("INVOKE_DEFAULT", **where) == {"FINISHED"}:
            bpy.ops.object.canonical_form_points(  # put where it was dropped, not beside it
                "EXEC_DEFAULT", True, how="REMOVE", owner=point.obj.name, vertex=point.vertex
            )


class VIEW3D_GGT_canonical_form_points(bpy.types.GizmoGroup):
    """The handles of all points of the body that is meant."""

    bl_idname = "VIEW3D_GGT_canonical_form_points"
    bl_label = "Ends of the Limbs"
    bl_space_type = "VIEW_3D"
    bl_region_type = "WINDOW"
    bl_options = {"PERSISTENT"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Offer handles where the dots are drawn, unless something is computed or a click is waited for."""
        choices = choices_of(context)
        busy = OBJECT_OT_canonical_form_cancel.job is not None or OBJECT_OT_canonical_form_fix_point.waits_for
        return choices is not None and choices.show_points and not busy and context.space_data.overlay.show_overlays

    def setup(self, context: bpy.types.Context) -> None:
        """Make the handles; those without a point take no mouse."""
        for _ in range(_MOST):
            handle = self.gizmos.new(VIEW3D_GT_canonical_form_point.bl_idname)
            handle.color = handle.color_highlight = (1.0, 1.0, 1.0)
            handle.alpha = handle.alpha_highlight = 1.0
            handle.use_draw_modal = True

    def draw_prepare(self, context: bpy.types.Context) -> None:
        """Put the handles where the dots are."""
        from bpy_extras.view3d_utils import location_3d_to_region_2d

        if any(handle.is_modal for handle in self.gizmos):
            return
        points = shown_points(meant_meshes(context), context.evaluated_depsgraph_get())[:_MOST]
        for handle, point in zip(self.gizmos, [*points, *[None] * (_MOST - len(points))], strict=True):
            handle.point = point
            handle.at = None
            if point is not None:
                handle.at = location_3d_to_region_2d(context.region, context.region_data, point.place)


CLASSES = (VIEW3D_GT_canonical_form_point, VIEW3D_GGT_canonical_form_points)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
