"""The colours of a reference, which a match transfers; also shown on the reference, for comparison."""

from __future__ import annotations

import bpy
import numpy as np

from ...core import CanonicalFormError
from ..mesh_items.colour_attributes import add_colours
from ..mesh_items.fingerprints import colour_fingerprint
from ..mesh_items.palette import places
from ..objects.mesh_reading import read_mesh, refusal
from ..objects.object_states import object_mode
from ..objects.placement import placement_of
from ..words.wording import told

SOURCE_COLOURS = "Match Source"
SOURCE_PROPERTY = "canonical_form_match_source"
"""Property of a mesh: name and fingerprint of the colours that it shows as a reference."""


def source_colours(mesh: bpy.types.Mesh) -> str | None:
    """Return the name of the colours that a reference shows of a match.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh of the reference.

    Returns
    -------
    str or None
        The name; None if it shows none. Colours of the user's own that have the name do not count.
    """
    name, _ = _recorded(mesh)
    return name if name in mesh.color_attributes else None


def toggle_source_colours(obj: bpy.types.Object | None) -> tuple[bool, str]:
    """Show on a reference the colours that matches transfer from it, or remove them.

    Parameters
    ----------
    obj : bpy.types.Object or None
        The reference.

    Returns
    -------
    shown : bool
        Whether it shows them now.
    kept : str
        Name of colours that stay because they were changed since; empty if none were.

    Raises
    ------
    CanonicalFormError
        If it does not exist or cannot be changed; the message names the remedy.
    """
    reason = told("The reference is gone. Choose another.") if obj is None else refusal(obj)
    if obj is None or reason is not None:
        raise CanonicalFormError(reason or "")
    with object_mode(obj):
        mesh, colours = obj.data, obj.data.color_attributes
        shown = source_colours(mesh)
        if shown is not None:
            unchanged = _recorded(mesh)[1] == colour_fingerprint(colours[shown])
            del mesh[SOURCE_PROPERTY]
            if unchanged:
                colours.remove(colours[shown])
            return False, "" if unchanged else shown
        vertices = read_mesh(mesh)[0] @ placement_of(obj, True)[:3, :3].T
        attribute = add_colours(obj, SOURCE_COLOURS)
        shades = np.append(places(vertices), np.ones((len(vertices), 1)), axis=1)
        attribute.data.foreach_set("color", shades.astype(np.float32).ravel())
        colours.active_color_name = attribute.name
        mesh[SOURCE_PROPERTY] = [attribute.name, colour_fingerprint(attribute)]
    return True, ""


def _recorded(mesh: bpy.types.Mesh) -> tuple[str, str]:
    """Return name and fingerprint of the colours as recorded; empty if there is no record."""
    value = mesh.get(SOURCE_PROPERTY)
    texts = list(value) if isinstance(value, list) else []
    return (texts[0], texts[1]) if len(texts) == 2 and all(isinstance(each, str) for each in texts) else ("", "")
