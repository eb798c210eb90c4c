"""Every action of the panel in Blender's menus, where menu search (F3) also finds them."""

from __future__ import annotations

import bpy

from ..blender.jobs.likeness import MANNEQUINS
from ..blender.jobs.meant_objects import meant_object
from ..blender.results.limb_states import limbs_of
from ..blender.words.wording import CONTEXT, told
from .choices import choices_of, hand_over, hand_over_rig, hand_over_transfer, there
from .contact_operators import OBJECT_OT_canonical_form_mark
from .keeping_operators import OBJECT_OT_canonical_form_copy, OBJECT_OT_canonical_form_keep
from .limb_operators import (
    OBJECT_OT_canonical_form_in_betweens,
    OBJECT_OT_canonical_form_limb,
    OBJECT_OT_canonical_form_remove_in_betweens,
    OBJECT_OT_canonical_form_select_patch,
)
from .live_update import OBJECT_OT_canonical_form_live
from .main_panel import draw_pose_button
from .operators import OBJECT_OT_canonical_form, OBJECT_OT_canonical_form_clear
from .point_operators import OBJECT_OT_canonical_form_fix_point, OBJECT_OT_canonical_form_points
from .pose_operators import (
    OBJECT_OT_canonical_form_match_colours,
    OBJECT_OT_canonical_form_transfer,
)
from .result_panel import draw_other_side
from .rig_operators import (
    OBJECT_OT_canonical_form_rig,
    OBJECT_OT_canonical_form_rig_clear,
    OBJECT_OT_canonical_form_rig_keep,
    OBJECT_OT_canonical_form_rig_pose,
)
from .sidebar import record_of
from .tool_operators import OBJECT_OT_canonical_form_choose, OBJECT_OT_canonical_form_distance


class VIEW3D_MT_canonical_form(bpy.types.Menu):
    """What the panel does, with the choices made there."""

    bl_label = "Canonical Form"
    bl_translation_context = CONTEXT

    def draw(self, context: bpy.types.Context) -> None:
        """Draw the actions, in the order of the panel."""
        layout, chosen, record = self.layout, choices_of(context), record_of(context)
        if chosen is None:
            layout.label(text=told("Select a mesh, or the armature that moves it."))
            return
        for pose, text in (*MANNEQUINS.items(), ("OBJECT", "Pose Like")):
            draw_pose_button(layout, chosen, pose, told(text))
        draw_other_side(layout, chosen, None if record is None else record.report.like)
        hand_over_rig(chosen, layout.operator(OBJECT_OT_canonical_form_rig.bl_idname))
        hand_over_transfer(chosen, layout.operator(OBJECT_OT_canonical_form_transfer.bl_idname))
        like = there(chosen.like)
        source = "" if like is None else like.name
        layout.operator(OBJECT_OT_canonical_form_match_colours.bl_idname).like = source
        layout.separator()
        steps = {"FORM": told("Straighten"), "FEATURES": told("Find the Limbs"), "PATCHES": told("Patches Only")}
        for step, text in steps.items():
            button = layout.operator(OBJECT_OT_canonical_form.bl_idname, text=text)
            hand_over(chosen, button)
            button.step = step
        layout.operator(OBJECT_OT_canonical_form_live.bl_idname)
        layout.operator_menu_enum(OBJECT_OT_canonical_form_fix_point.bl_idname, "limb")
        layout.operator(OBJECT_OT_canonical_form_points.bl_idname, text=told("Swap L/R")).how = "SWAP"
        layout.separator()
        layout.operator(OBJECT_OT_canonical_form_in_betweens.bl_idname).count = chosen.in_betweens
        layout.operator(OBJECT_OT_canonical_form_remove_in_betweens.bl_idname)
        layout.menu(VIEW3D_MT_canonical_form_limbs.__name__)
        layout.menu(VIEW3D_MT_canonical_form_patches.__name__)
        layout.separator()
        layout.operator_menu_enum(OBJECT_OT_canonical_form_choose.bl_idname, "how")
        layout.operator_menu_enum(OBJECT_OT_canonical_form_mark.bl_idname, "marks")
        layout.operator_menu_enum(OBJECT_OT_canonical_form_distance.bl_idname, "kind")
        layout.separator()
        layout.operator(OBJECT_OT_canonical_form_keep.bl_idname)
        layout.operator(OBJECT_OT_canonical_form_copy.bl_idname)
        layout.operator(OBJECT_OT_canonical_form_clear.bl_idname)
        layout.operator(OBJECT_OT_canonical_form_rig_pose.bl_idname)
        layout.operator(OBJECT_OT_canonical_form_rig_keep.bl_idname)
        layout.operator(OBJECT_OT_canonical_form_rig_clear.bl_idname)


class VIEW3D_MT_canonical_form_limbs(bpy.types.Menu):
    """The limbs: the pose taken out of one, or given back to it."""

    bl_label = "Limbs"
    bl_translation_context = CONTEXT

    def draw(self, context: bpy.types.Context) -> None:
        """Draw two entries per limb, and one for all limbs."""
        layout, obj = self.layout, meant_object(context)
        layout.operator(OBJECT_OT_canonical_form_limb.bl_idname, text=told("All Limbs")).patch = 0
        names = _patches_of(obj)
        for patch, limb in enumerate(names if names and obj is not None and limbs_of(obj.data) else [], start=1):
            for only, text in ((True, told("Only {name}", name=limb)), (False, told("Toggle {name}", name=limb))):
                button = layout.operator(OBJECT_OT_canonical_form_limb.bl_idname, text=text)
                button.patch, button.only = patch, only


class VIEW3D_MT_canonical_form_patches(bpy.types.Menu):
    """The patches, to be selected."""

    bl_label = "Select Patch"
    bl_translation_context = CONTEXT

    def draw(self, context: bpy.types.Context) -> None:
        """Draw one entry per patch."""
        for patch, name in enumerate(_patches_of(meant_object(context)), start=1):
            button = self.layout.operator(OBJECT_OT_canonical_form_select_patch.bl_idname, text=name)
            button.patch = patch


def _patches_of(obj: bpy.types.Object | None) -> list[str]:
    """Return the names of the patches of an object, in order."""
    return [patch.name for patch in obj.data.canonical_form_patches] if obj is not None and obj.type == "MESH" else []


def draw_actions(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    """Add all actions to a menu as a submenu.

    Parameters
    ----------
    menu : bpy.types.Menu
        The menu.
    context : bpy.types.Context
        Its context.
    """
    menu.layout.separator()
    menu.layout.menu(VIEW3D_MT_canonical_form.__name__)


def draw_distances(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    """Add the distance fields to a menu of weights or vertex groups.

    Parameters
    ----------
    menu : bpy.types.Menu
        The menu.
    context : bpy.types.Context
        Its context.
    """
    menu.layout.separator()
    menu.layout.operator_menu_enum(OBJECT_OT_canonical_form_distance.bl_idname, "kind")


CLASSES = (VIEW3D_MT_canonical_form, VIEW3D_MT_canonical_form_limbs, VIEW3D_MT_canonical_form_patches)
MENUS = (
    ("VIEW3D_MT_object", draw_actions),
    ("VIEW3D_MT_edit_mesh", draw_actions),
    ("VIEW3D_MT_paint_weight", draw_distances),
    ("MESH_MT_vertex_group_context_menu", draw_distances),
)


def register() -> None:
    """Register the menus and add them to Blender's menus."""
    for each in CLASSES:
        bpy.utils.register_class(each)
    for name, draw in MENUS:
        getattr(bpy.types, name).append(draw)


def unregister() -> None:
    """Remove them from Blender's menus and unregister them."""
    for name, draw in MENUS:
        getattr(bpy.types, name).remove(draw)
    for each in reversed(CLASSES):
        bpy.utils.unregister_class(each)
