"""Colour attributes on a mesh."""

from __future__ import annotations

import bpy


def add_colours(obj: bpy.types.Object, name: str) -> bpy.types.Attribute:
    """Add a colour attribute with one colour per vertex.

    Blender shows a vertex group instead of colours of the same name, so the name is extended if a group has it.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode.
    name : str
        Preferred name.

    Returns
    -------
    bpy.types.Attribute
        The attribute. Adding another one may move it in memory.
    """
    while name in obj.vertex_groups:
        name += " Colours"
    return obj.data.color_attributes.new(name=name, type="FLOAT_COLOR", domain="POINT")
