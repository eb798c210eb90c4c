"""The panel for two meshes: take the pose of another object, and transfer data from it."""

import bpy

from ..blender.jobs.likeness import MANNEQUINS
from ..blender.jobs.meant_objects import meant_objects
from ..blender.records.form_report import LikeReport
from ..blender.records.rig_record import DOUBTFUL
from ..blender.results.match_colours import source_colours
from ..blender.words.wording import CONTEXT, told
from ..core import Settings
from ..core.method_api.costs import match_memory_estimate, match_time_estimate
from ..core.run.load import slowdown
from .pose_operators import (
    OBJECT_OT_canonical_form_match_colours,
    OBJECT_OT_canonical_form_pose_like,
    OBJECT_OT_canonical_form_transfer,
)
from .properties import TRANSFER_ITEMS, chosen_value, hand_over, hand_over_transfer, transfer_flag
from .sidebar import Tab, record_of


class VIEW3D_PT_canonical_form_pose_like(Tab, bpy.types.Panel):
    """Another's pose: that of an object, or of a mannequin."""

    bl_label = "Pose Like"
    bl_translation_context = CONTEXT
    bl_parent_id = "VIEW3D_PT_canonical_form"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draw the reference, the buttons, and the confidence of the last match."""
        layout, chosen = self.layout, context.scene.canonical_form
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop_search(chosen, "like", bpy.data, "objects")
        row = layout.row()
        row.enabled = bool(chosen.like)
        _pose_button(row, chosen, "OBJECT", chosen.like, "Pose Like")
        row = layout.row(align=True)
        for pose, label in MANNEQUINS.items():
            _pose_button(row, chosen, pose, "", label)
        layout.prop(chosen, "anyway")
        like = shown_likeness(context)
        draw_other_side(layout, chosen, like)
        source = None if like is None or like.pose != "OBJECT" else bpy.data.objects.get(like.name)
        if source is not None and source.type == "MESH":
            if source_colours(source.data) is not None:
                text = told("Remove Colours from {name}", name=source.name)
            else:
                text = told("Show Colours on {name}", name=source.name)
            layout.operator(OBJECT_OT_canonical_form_match_colours.bl_idname, text=text).like = source.name
        column = layout.column(heading=told("Data to Transfer"))
        column.enabled = bool(chosen.like)
        for kind, *_ in TRANSFER_ITEMS:
            column.prop(chosen, transfer_flag(kind))
        button = column.operator(OBJECT_OT_canonical_form_transfer.bl_idname)
        hand_over_transfer(chosen, button)
        objects = [obj for obj in meant_objects(context) if obj is not None and obj.type == "MESH"]
        if objects:
            layout.label(text=_estimate(chosen, objects), icon="MEMORY")


def shown_likeness(context: bpy.types.Context) -> LikeReport | None:
    """Read how the object whose result is shown was posed like another.

    Parameters
    ----------
    context : bpy.types.Context
        Any context.

    Returns
    -------
    LikeReport or None
        The report; None if it was not.
    """
    record = record_of(context)
    return None if record is None else record.report.like


def least_sure(bones: dict[str, float]) -> list[str]:
    """Name the bone that fits worst, if it hardly fits.

    Parameters
    ----------
    bones : dict of str to float
        How well each bone fits, 0 to 1.

    Returns
    -------
    list of str
        One line, or none.
    """
    name = min(bones, key=lambda each: bones[each], default="")
    sure = bones.get(name, 1.0)
    return [told("Fits worst: {bone}, {sure:.0%}", bone=name, sure=sure)] if sure < DOUBTFUL else []


def draw_other_side(layout: bpy.types.UILayout, chosen: bpy.types.PropertyGroup, like: LikeReport | None) -> None:
    """Draw the button that matches another side, if there are several.

    Parameters
    ----------
    layout : bpy.types.UILayout
        Where.
    chosen : bpy.types.PropertyGroup
        The choices made in the panel.
    like : LikeReport or None
        How the object was posed like another.
    """
    if like is None or len(like.sides) < 2:
        return
    text, side = next_side(like.side, len(like.sides), stands=like.pose in MANNEQUINS)
    _pose_button(layout, chosen, like.pose, like.name, text).side = side


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


def _estimate(chosen: bpy.types.PropertyGroup, objects: list[bpy.types.Object]) -> str:
    """Estimate memory and time of a match with the reference, or with a mannequin if there is none."""
    like = bpy.data.objects.get(chosen.like)
    other = len(like.data.vertices) if like is not None and like.type == "MESH" else None
    memory, seconds = match_estimate(chosen, objects, other)
    return told("A match: about {memory:.1f} GB, {seconds:,.0f} s", memory=memory, seconds=seconds)


def match_estimate(
    chosen: bpy.types.PropertyGroup, objects: list[bpy.types.Object], other: int | None
) -> tuple[float, float]:
    """Estimate what a match takes.

    Parameters
    ----------
    chosen : bpy.types.PropertyGroup
        The choices made in the panel.
    objects : list of bpy.types.Object
        The meshes.
    other : int or None
        Number of vertices that they are matched with; None for a mannequin.

    Returns
    -------
    memory, seconds : float
        Gigabytes and seconds.
    """
    from ..core.modelling.mannequins import VERTEX_COUNT

    settings = Settings(**{name: chosen_value(chosen, name) for name in ("method", "quality", "pieces")})
    counts = sum(len(obj.data.vertices) for obj in objects), VERTEX_COUNT if other is None else other
    return match_memory_estimate(*counts, settings), match_time_estimate(*counts, settings) * slowdown()


def _pose_button(
    layout: bpy.types.UILayout, chosen: bpy.types.PropertyGroup, pose: str, name: str, text: str
) -> bpy.types.OperatorProperties:
    """Draw a button that applies a pose."""
    button = layout.operator(OBJECT_OT_canonical_form_pose_like.bl_idname, text=text)
    hand_over(chosen, button)
    button.pose, button.like = pose, name
    button.anyway = chosen.anyway
    return button
