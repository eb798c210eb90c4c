"""The colours of a reference, which a match transfers; also shown on the reference, for comparison."""

from __future__ import annotations

import re

import bpy
import numpy as np

from ...core import CanonicalFormError
from ..mesh_items.colour_attributes import add_colours
from ..mesh_items.palette import places
from ..objects.mesh_reading import read_mesh, refusal
from ..objects.object_states import object_mode
from ..objects.placement import placement_of
from ..words.wording import told

SOURCE_COLOURS = "Match Source"
_OURS = re.compile(rf"{SOURCE_COLOURS}( Colours)*(\.\d{{3,}})?")  # Blender may append a number


def has_source_colours(obj: bpy.types.Object) -> bool:
    """Return whether a reference shows its colours.

    Parameters
    ----------
    obj : bpy.types.Object
        The reference.

    Returns
    -------
    bool
        True if it does.
    """
    return _name(obj) is not None


def are_source_colours(name: str) -> bool:
    """Return whether colours are those that a reference shows, by their name.

    Parameters
    ----------
    name : str
        Name of a colour attribute.

    Returns
    -------
    bool
        True if they are.
    """
    return _OURS.fullmatch(name) is not None


def toggle_source_colours(obj: bpy.types.Object | None) -> bool:
    """Show on a reference the colours that matches transfer from it, or remove them.

    Parameters
    ----------
    obj : bpy.types.Object or None
        The reference.

    Returns
    -------
    bool
        Whether it shows them now.

    Raises
    ------
    CanonicalFormError
        If it does not exist or cannot be changed; the message names the remedy.
    """
    reason = told("The reference is gone. Choose another.") if obj is None else refusal(obj)
    if obj is None or reason is not None:
        raise CanonicalFormError(reason or "")
    with object_mode(obj):
        colours = obj.data.color_attributes
        shown = _name(obj)
        if shown is not None:
            colours.remove(colours[shown])
            return False
        vertices = read_mesh(obj.data)[0] @ placement_of(obj, True)[:3, :3].T
        attribute = add_colours(obj, SOURCE_COLOURS)
        shades = np.append(places(vertices), np.ones((len(vertices), 1)), axis=1)
        attribute.data.foreach_set("color", shades.astype(np.float32).ravel())
        colours.active_color_name = attribute.name
    return True


def _name(obj: bpy.types.Object) -> str | None:
    """Return the name of the colours, which is extended if a vertex group has it."""
    return next((each.name for each in obj.data.color_attributes if are_source_colours(each.name)), None)
