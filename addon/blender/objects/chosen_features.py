"""Feature points chosen by hand, stored in a vertex group that belongs to the user."""

from __future__ import annotations

import bpy
import numpy as np

from ...core import CanonicalFormError
from ..mesh_items.weight_reading import weights_of
from ..records.record import read_record
from ..words.wording import told
from .mesh_reading import selected_vertices
from .object_states import object_mode

CHOSEN_GROUP = "Chosen Feature Points"
MOST_FEATURES = 200  # a larger selection is a mistake


def choose_features(obj: bpy.types.Object, how: str, group_name: str) -> tuple[str, int]:
    """Set, add or remove the selected vertices in the group of chosen feature points.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, accepted by `refusal`, in any mode.
    how : {'SET', 'ADD', 'REMOVE'}
        The selected vertices replace the feature points, are added to them or are removed from them.
    group_name : str
        Name of the group, added if missing; with 'ADD' and 'REMOVE' a new group starts with the points of the last run.

    Returns
    -------
    name : str
        Name of the group.
    count : int
        Number of feature points in it.

    Raises
    ------
    CanonicalFormError
        If no vertex is selected, or too many are, or the group is locked or painted; the message names the remedy.
    """
    with object_mode(obj):
        selected = selected_vertices(obj.data)
        if not len(selected):
            raise CanonicalFormError(
                told("No vertex is selected. In Edit Mode, select a vertex at the tip of each limb.")
            )
        group = obj.vertex_groups.get(group_name)
        before = members_of(obj, group.name) if group is not None else []
        now = np.array(before if group is not None else _detected(obj), dtype=np.int64)
        if how == "SET":
            now = selected
        elif how == "ADD":
            now = np.union1d(now, selected)
        else:
            now = np.setdiff1d(now, selected)
        if len(now) > MOST_FEATURES:
            raise CanonicalFormError(
                told(
                    "That would make {count:,} feature points. Select one vertex a limb, {most} in all.",
                    count=len(now),
                    most=MOST_FEATURES,
                )
            )
        if group is not None and (group.lock_weight or (how == "SET" and _is_painted(group, before))):
            raise CanonicalFormError(
                told(
                    "The vertex group {name} is locked or has weights of its own. Choose another group.",
                    name=group.name,
                )
            )
        active = obj.vertex_groups.active.name if obj.vertex_groups.active else None
        if group is None:
            group = obj.vertex_groups.new(name=group_name)
        group.remove(np.setdiff1d(before, now).astype(int).tolist())
        group.add(np.setdiff1d(now, before).astype(int).tolist(), 1.0, "REPLACE")
        if active is not None:
            obj.vertex_groups.active_index = obj.vertex_groups.find(active)
        return group.name, len(now)


def members_of(obj: bpy.types.Object, group_name: str) -> list[int]:
    """Return the members of a vertex group.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode.
    group_name : str
        Name of one of its groups.

    Returns
    -------
    list of int
        Vertices with a weight above 0.
    """
    members: list[int] = np.flatnonzero(weights_of(obj, [group_name])[group_name]).tolist()
    return members


def _is_painted(group: bpy.types.VertexGroup, members: list[int]) -> bool:
    """Return whether a group has weights between 0 and 1, so that it serves another purpose."""
    return any(0 < group.weight(index) < 1 for index in members)


def _detected(obj: bpy.types.Object) -> list[int]:
    """Return the feature points of the last run."""
    record = read_record(obj.data)
    if record is None:
        return []
    return [point for point in record.report.feature_points if 0 <= point < len(obj.data.vertices)]
