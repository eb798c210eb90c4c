"""Tells whether groups and colours of a mesh that was edited since a run are only what Blender made of them."""

from __future__ import annotations

import re

import bpy
import numpy as np

from ..mesh_items.weight_reading import weights_of
from ..records.hidden_attributes import HIDDEN_PATCHES
from ..records.record import Record

_OURS = re.compile(
    r"(Feature Points|Patch \d+|Contacts|Match Confidence|Auto Diffusion Function|Patches|Match)(\.\d+)?$"
)
_WEIGHT, _COLOUR = 1e-3, 0.02  # by which what Blender makes of weights and colours is off


def is_ours_by_name(name: str) -> bool:
    """Return whether a group or colour attribute is called as ours are: a record from elsewhere may name any.

    Parameters
    ----------
    name : str
        Its name.

    Returns
    -------
    bool
        True if it is.

    Examples
    --------
    >>> is_ours_by_name("Patch 12.001"), is_ours_by_name("Patch of grass")
    (True, False)
    """
    return _OURS.match(name) is not None


def is_made_up(obj: bpy.types.Object, record: Record) -> bool:
    """Return whether groups and colours hold what Blender has made up for new vertices, and nobody's work.

    What a run writes adds up to 1 at every vertex, and so does what Blender mixes of it; what is painted does not.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode.
    record : Record
        The record of the run.

    Returns
    -------
    bool
        True if the mesh has other vertices than at the run, and patches and their colours still agree.
    """
    mesh, names = obj.data, record.patch_names
    if not HIDDEN_PATCHES.is_changed(mesh, record) or not names or any(name not in obj.vertex_groups for name in names):
        return False
    weights = np.stack(list(weights_of(obj, names).values()), axis=1)  # (n, patches)
    if len(weights) == 0 or np.abs(weights.sum(axis=1) - 1).max() > _WEIGHT:
        return False
    palette = np.array(record.palette)
    for name in record.colours:
        attribute = mesh.color_attributes.get(name)
        if attribute is None or not name.startswith("Patches") or len(attribute.data) != len(weights):
            continue
        colours = np.empty(4 * len(weights), dtype=np.float32)
        attribute.data.foreach_get("color", colours)
        if np.abs(colours.reshape(-1, 4)[:, :3] - weights @ palette).max() > _COLOUR:
            return False
    return True
