"""Operators that fix the ends of limbs by hand, with a click on what is shown."""

# no `from __future__ import annotations`: Blender reads the annotations below as properties

from contextlib import ExitStack
from typing import ClassVar

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty, StringProperty

from ..blender.jobs.meant_objects import meant_meshes, meant_object
from ..blender.objects.body_points import fix_point, forget_points, remove_point, swap_sides
from ..blender.objects.mesh_reading import refusal
from ..blender.objects.object_states import object_mode
from ..blender.objects.picking import Picked, mirrored_vertex, picked
from ..blender.words.advice import explained
from ..blender.words.limb_words import LIMBS, OTHER, told_limb
from ..blender.words.wording import CONTEXT, told
from ..core import CanonicalFormError
from ..core.symmetry.limb_names import mate_of
from .job_operator import JobOperator, redraw_sidebars
from .operators import allowed

LIMB_ITEMS = [(name, label, f"The end of the limb: {label}") for name, label in {**LIMBS, "other": OTHER}.items()]
_DESCRIPTIONS = {
    "SWAP": "Call what is left right, and what is right left",
    "FORGET": "Let the ends of the limbs be found again, without what was fixed by hand",
    "REMOVE": "This is no limb: take its point off the body",
}


class OBJECT_OT_canonical_form_fix_point(bpy.types.Operator):
    """Click here, then on the body where this limb ends. Hold Shift to set the other side, too. Form, T-pose and rig use it"""  # noqa: D400, E501 (Blender's tooltip)

    bl_idname = "object.canonical_form_fix_point"
    bl_label = "Fix Limb"
    bl_translation_context = CONTEXT
    bl_options = {"UNDO"}

    limb: EnumProperty(name="Limb", translation_context=CONTEXT, description="Which limb ends there", items=LIMB_ITEMS)  # type: ignore[valid-type]
    owner: StringProperty(name="Object", translation_context=CONTEXT, description="Object that has the vertex")  # type: ignore[valid-type]
    vertex: IntProperty(  # type: ignore[valid-type]
        name="Vertex",
        translation_context=CONTEXT,
        description="Vertex where the limb ends; -1 to click on it",
        default=-1,
        min=-1,
    )
    mirror: BoolProperty(name="Other Side, Too", translation_context=CONTEXT, description="Set its mirror image, too")  # type: ignore[valid-type]

    waits_for: ClassVar[str] = ""  # the limb whose button waits for a click
    presses: ClassVar[int] = 0  # of such buttons: only the last one waits

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Disable the button, with a reason, if the active object cannot be used."""
        return allowed(cls, JobOperator.busy() or refusal(meant_object(context)))

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Wait for a click on the body."""
        if self.vertex >= 0 or context.window is None:
            return self.execute(context)
        kind = OBJECT_OT_canonical_form_fix_point
        kind.presses += 1
        kind.waits_for = self.limb
        self._press, self._mode = kind.presses, context.mode
        context.window.cursor_modal_set("EYEDROPPER")
        said = told("Click where this limb ends: {limb}. Shift: both sides. Esc: cancel", limb=self._told)
        _say(context, said)
        _redraw(context)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Take the vertex under a click; everything but clicks and Esc goes through, so that the view can be turned."""
        if self._press != OBJECT_OT_canonical_form_fix_point.presses:  # another button was pressed
            return {"CANCELLED", "PASS_THROUGH"}
        left = context.mode != self._mode  # clicks mean something else there
        if left or (event.type in ("ESC", "RIGHTMOUSE") and event.value == "PRESS"):
            self.cancel(context)
            return {"CANCELLED", "PASS_THROUGH"} if left else {"CANCELLED"}
        if event.type != "LEFTMOUSE" or event.value not in ("PRESS", "CLICK"):
            return {"PASS_THROUGH"}
        view = _view_under(context, event)
        if view is None or JobOperator.busy() is not None:  # points do not change under a run
            return {"PASS_THROUGH"}
        found = under_mouse(context, event, *view)
        if found is None:
            _say(context, told("That is not on the body. Click on it, or press Esc."))
            return {"RUNNING_MODAL"}
        self.cancel(context)
        self.owner, self.vertex, self.mirror = found.obj.name, found.vertex, event.shift
        if found.image and self.limb != "other":
            self.limb = mate_of(self.limb)
        return self.execute(context)

    def cancel(self, context: bpy.types.Context) -> None:
        """Give the mouse and the texts back."""
        OBJECT_OT_canonical_form_fix_point.waits_for = ""
        context.window.cursor_modal_restore()
        _say(context, None)
        _redraw(context)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Set the point, and where it is wished that of the other side."""
        objects = meant_meshes(context)
        obj = bpy.data.objects.get(self.owner) if self.owner else meant_object(context)
        name = "" if self.limb == "other" else self.limb
        try:
            if not _has_vertex(obj, objects, self.vertex):
                self.report({"ERROR"}, told("There is no such vertex on the body."))
                return {"CANCELLED"}
            assert obj is not None
            fix_point(objects, obj, self.vertex, name)
            if self.mirror and mate_of(name) != name:
                there = mirrored_vertex(objects, Picked(obj, self.vertex))
                if there is None:
                    self.report({"WARNING"}, told("The body is not symmetric there: only this side was set."))
                else:
                    fix_point(objects, there.obj, there.vertex, mate_of(name))
        except CanonicalFormError as error:
            self.report({"ERROR"}, explained(error))
            return {"CANCELLED"}
        self.vertex = -1  # the next press waits for a click
        _redraw(context)
        return {"FINISHED"}

    @property
    def _told(self) -> str:
        return told_limb("" if self.limb == "other" else self.limb)


class OBJECT_OT_canonical_form_points(bpy.types.Operator):
    """Change the ends of the limbs that were fixed by hand"""  # noqa: D400 (Blender's tooltip)

    bl_idname = "object.canonical_form_points"
    bl_label = "Change Limbs"
    bl_translation_context = CONTEXT
    bl_options = {"REGISTER", "UNDO"}

    how: EnumProperty(  # type: ignore[valid-type]
        name="How",
        translation_context=CONTEXT,
        items=(
            ("SWAP", "Swap Left and Right", _DESCRIPTIONS["SWAP"]),
            ("FORGET", "Find by Itself", _DESCRIPTIONS["FORGET"]),
            ("REMOVE", "Remove", _DESCRIPTIONS["REMOVE"]),
        ),
    )
    owner: StringProperty(name="Object", translation_context=CONTEXT, description="Object that has the vertex")  # type: ignore[valid-type]
    vertex: IntProperty(name="Vertex", translation_context=CONTEXT, description="Vertex of the point", default=-1)  # type: ignore[valid-type]

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        """Return the tooltip of the button."""
        return told(_DESCRIPTIONS[properties.how])

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Disable the button, with a reason, if the active object cannot be used."""
        return allowed(cls, JobOperator.busy() or refusal(meant_object(context)))

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Change the points."""
        first = meant_object(context)
        objects = sorted(meant_meshes(context), key=lambda obj: obj != first)
        try:
            if self.how == "SWAP":
                swap_sides(objects)
            elif self.how == "FORGET":
                forget_points(objects)
            else:
                obj = bpy.data.objects.get(self.owner)
                if obj not in objects:
                    self.report({"ERROR"}, told("There is no such vertex on the body."))
                    return {"CANCELLED"}
                remove_point(objects, obj, self.vertex)
        except CanonicalFormError as error:
            self.report({"ERROR"}, explained(error))
            return {"CANCELLED"}
        _redraw(context)
        return {"FINISHED"}


def _say(context: bpy.types.Context, sentence: str | None) -> None:
    """Say what is waited for, in the status bar and above the views; None for nothing any more."""
    if context.workspace is not None:
        context.workspace.status_text_set(sentence)
    for area in context.window.screen.areas:
        if area.type == "VIEW_3D":
            area.header_text_set(sentence)


def _view_under(
    context: bpy.types.Context, event: bpy.types.Event
) -> tuple[bpy.types.Region, bpy.types.RegionView3D] | None:
    """Find the view under the mouse; None where something lies on it."""
    for area in context.window.screen.areas:
        if area.type != "VIEW_3D":
            continue
        over = [
            region
            for region in area.regions
            if 0 <= event.mouse_x - region.x < region.width and 0 <= event.mouse_y - region.y < region.height
        ]
        if [region.type for region in over] == ["WINDOW"]:
            return over[0], area.spaces.active.region_3d
    return None


def under_mouse(
    context: bpy.types.Context, event: bpy.types.Event, region: bpy.types.Region, view_3d: bpy.types.RegionView3D
) -> Picked | None:
    """Find the vertex of the body under the mouse.

    Parameters
    ----------
    context : bpy.types.Context
        Whose body is meant.
    event : bpy.types.Event
        Where the mouse is.
    region : bpy.types.Region
        The view's region.
    view_3d : bpy.types.RegionView3D
        The view.

    Returns
    -------
    Picked or None
        The vertex; None beside the body.
    """
    from bpy_extras.view3d_utils import region_2d_to_origin_3d, region_2d_to_vector_3d

    at = (event.mouse_x - region.x, event.mouse_y - region.y)
    ray = region_2d_to_origin_3d(region, view_3d, at), region_2d_to_vector_3d(region, view_3d, at)
    objects = [obj for obj in meant_meshes(context) if refusal(obj) is None]
    with ExitStack() as modes:  # what is edited is not in the mesh yet
        for obj in objects:
            modes.enter_context(object_mode(obj))
        return picked(context, objects, *ray)


def _has_vertex(obj: bpy.types.Object | None, objects: list[bpy.types.Object], vertex: int) -> bool:
    """Return whether a vertex is one of the body."""
    if obj is None or obj not in objects or refusal(obj) is not None:
        return False
    with object_mode(obj):
        return 0 <= vertex < len(obj.data.vertices)


def _redraw(context: bpy.types.Context) -> None:
    """Show the dots where they are now."""
    redraw_sidebars(context)
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


CLASSES = (OBJECT_OT_canonical_form_fix_point, OBJECT_OT_canonical_form_points)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
