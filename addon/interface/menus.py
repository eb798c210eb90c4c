"""Every action of the panel in Blender's menus, where menu search (F3) also finds them."""

from __future__ import annotations

import bpy

from ..blender.jobs.likeness import MANNEQUINS
from ..blender.jobs.meant_objects import meant_object
from ..blender.results.limb_states import limbs_of
from ..blender.words.wording import CONTEXT, told
from .contact_operators import OBJECT_OT_canonical_form_mark
from .limb_operators import (
    OBJECT_OT_canonical_form_in_betweens,
    OBJECT_OT_canonical_form_limb,
    OBJECT_OT_canonical_form_remove_in_betweens,
    OBJECT_OT_canonical_form_select_patch,
)
from .live_update import OBJECT_OT_canonical_form_live
from .operators import OBJECT_OT_canonical_form, OBJECT_OT_canonical_form_clear
from .pose_operators import (
    OBJECT_OT_canonical_form_match_colours,
    OBJECT_OT_canonical_form_pose_like,
    OBJECT_OT_canonical_form_transfer,
)
from .pose_panel import draw_other_side, shown_likeness
from .properties import hand_over, hand_over_transfer
from .rig_operators import (
    OBJECT_OT_canonical_form_rig,
    OBJECT_OT_canonical_form_rig_clear,
    OBJECT_OT_canonical_form_rig_keep,
    hand_over_rig,
)
from .tool_operators import OBJECT_OT_canonical_form_choose, OBJECT_OT_canonical_form_distance


class VIEW3D_MT_canonical_form(bpy.types.Menu):
    """What the panel does, with the choices made there."""

    bl_label = "Canonical Form"
    bl_translation_context = CONTEXT

    def draw(self, context: bpy.types.Context) -> None:
        """Draw the actions, in the order of the panel."""
        layout, chosen = self.layout, context.scene.canonical_form
        steps = {"FORM": told("Compute"), "FEATURES": told("Detect Only"), "PATCHES": told("Patches Only")}
        for step, text in steps.items():
            button = layout.operator(OBJECT_OT_canonical_form.bl_idname, text=text)
            hand_over(chosen, button)
            button.step = step
        layout.operator(OBJECT_OT_canonical_form_live.bl_idname)
        layout.separator()
        for pose, text in (("OBJECT", told("Pose Like")), *MANNEQUINS.items()):
            button = layout.operator(OBJECT_OT_canonical_form_pose_like.bl_idname, text=text)
            hand_over(chosen, button)
            button.pose, button.like = pose, chosen.like if pose == "OBJECT" else ""
        draw_other_side(layout, chosen, shown_likeness(context))
        hand_over_transfer(chosen, layout.operator(OBJECT_OT_canonical_form_transfer.bl_idname))
        layout.operator(OBJECT_OT_canonical_form_match_colours.bl_idname).like = chosen.like
        hand_over_rig(chosen, layout.operator(OBJECT_OT_canonical_form_rig.bl_idname))
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
        layout.operator(OBJECT_OT_canonical_form_clear.bl_idname)
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
