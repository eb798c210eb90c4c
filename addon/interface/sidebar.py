"""Shared by all panels of the sidebar: their tab, and the result that they show."""

import bpy

from ..blender.jobs.meant_objects import meant_object
from ..blender.records.record import Record, read_record


class Tab:
    """Mixin for panels in the tab Canonical Form."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Canonical Form"


def record_of(context: bpy.types.Context) -> Record | None:
    """Read the record of the object whose result is shown.

    Parameters
    ----------
    context : bpy.types.Context
        Any context.

    Returns
    -------
    Record or None
        The record; None if there is no result.
    """
    obj = meant_object(context)
    return read_record(obj.data) if obj is not None and obj.type == "MESH" else None
