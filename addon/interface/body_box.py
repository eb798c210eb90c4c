"""The ends of the limbs in the panel: what was found, what is missing, and buttons that fix it by hand."""

import bpy

from ..blender.jobs.meant_objects import meant_meshes
from ..blender.objects.body_points import BodyPoints, body_points
from ..blender.words.limb_words import LIMBS, told_limb
from ..blender.words.wording import told
from .choices import CanonicalFormChoices, hand_over
from .operators import OBJECT_OT_canonical_form
from .point_operators import OBJECT_OT_canonical_form_fix_point, OBJECT_OT_canonical_form_points
from .sidebar import draw_progress

_ROWS = (("head",), ("left_hand", "right_hand"), ("left_foot", "right_foot"))
_MOST = 4  # points without a name that have a row
_FOUND, _BY_HAND, _MISSING = "CHECKMARK", "PINNED", "X"


def draw_body(layout: bpy.types.UILayout, context: bpy.types.Context, choices: CanonicalFormChoices) -> None:
    """Draw the limbs with their states, and the buttons that change them.

    Parameters
    ----------
    layout : bpy.types.UILayout
        Where.
    context : bpy.types.Context
        Any context.
    choices : CanonicalFormChoices
        The choices for what is meant.
    """
    header, box = layout.panel("canonical_form_body", default_closed=False)
    header.label(text=told("Body"))
    if box is None:
        return
    objects = meant_meshes(context)
    points, by_hand = body_points(objects)
    listed = _listed(objects, points)
    owners = {name: (obj, vertex) for obj, vertex, name in reversed(listed) if name}
    column = box.column(align=True)
    if not draw_progress(column, ("FEATURES",)):
        part = column.row(align=True)
        part.enabled = not by_hand
        button = part.operator(
            OBJECT_OT_canonical_form.bl_idname, text=told("Find the Limbs (optional)"), icon="VIEWZOOM"
        )
        hand_over(choices, button)
        button.step = "FEATURES"
    for names in (*_ROWS, *((("tail",),) if "tail" in owners else ())):
        row = column.row(align=True)
        for name in names:
            icon = _MISSING if name not in owners else _BY_HAND if by_hand else _FOUND
            button = row.operator(
                OBJECT_OT_canonical_form_fix_point.bl_idname,
                text=told_limb(name),
                icon=icon if listed else "BLANK1",
                depress=name == OBJECT_OT_canonical_form_fix_point.waits_for,
            )
            button.limb = name
        if names == ("tail",):
            _draw_remove(row, *owners["tail"])
    others = [(obj, vertex) for obj, vertex, name in listed if name not in LIMBS]
    for number, (obj, vertex) in enumerate(others[:_MOST], start=1):
        row = column.row(align=True)
        row.label(text=told("Other {number}", number=number), icon=_BY_HAND if by_hand else _FOUND)
        _draw_remove(row, obj, vertex)
    if len(others) > _MOST:
        column.label(text=told("{count} more", count=len(others) - _MOST))
    row = column.row(align=True)
    row.operator(OBJECT_OT_canonical_form_fix_point.bl_idname, text=told("Add"), icon="ADD").limb = "other"
    part = row.row(align=True)
    part.enabled = bool(listed)
    part.operator(OBJECT_OT_canonical_form_points.bl_idname, text=told("Swap L/R"), icon="ARROW_LEFTRIGHT").how = "SWAP"
    part = row.row(align=True)
    part.enabled = by_hand
    part.operator(OBJECT_OT_canonical_form_points.bl_idname, text=told("Undo All"), icon="LOOP_BACK").how = "FORGET"


def _listed(objects: list[bpy.types.Object], points: list[BodyPoints]) -> list[tuple[bpy.types.Object, int, str]]:
    """List the points of a body: object, vertex and name of each."""
    return [(obj, *each) for obj, own in zip(objects, points, strict=True) for each in zip(*own, strict=True)]


def _draw_remove(row: bpy.types.UILayout, obj: bpy.types.Object, vertex: int) -> None:
    """Draw the button that takes a point off the body."""
    button = row.operator(OBJECT_OT_canonical_form_points.bl_idname, text="", icon="X")
    button.how, button.owner, button.vertex = "REMOVE", obj.name, vertex
