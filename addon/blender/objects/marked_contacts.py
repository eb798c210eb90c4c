"""Where skin is to be parted, or stays joined: marked by hand, in vertex groups that belong to the user."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import bpy
import numpy as np

from ...core import CanonicalFormError, Settings
from ..mesh_items.weight_reading import weights_of
from ..words.wording import told
from .mesh_reading import selected_vertices
from .object_states import object_mode

if TYPE_CHECKING:
    from ...core.numerics.arrays import IntArray

PART_GROUP, KEEP_GROUP = "Part Here", "Keep Joined"


class Marks(NamedTuple):
    """Marked vertices of an object.

    Attributes
    ----------
    part_here : list of int
        Vertices between which it is parted.
    keep_joined : list of int
        Vertices at which only what is marked is parted.
    """

    part_here: list[int]
    keep_joined: list[int]


def read_marks(obj: bpy.types.Object, count: int) -> Marks:
    """Read the marks of an object.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in any mode.
    count : int
        Number of vertices of the mesh that is computed.

    Returns
    -------
    Marks
        Its marks.

    Raises
    ------
    CanonicalFormError
        If it has marks, and modifiers have changed its number of vertices.
    """
    with object_mode(obj):
        weights = weights_of(obj, (PART_GROUP, KEEP_GROUP))
    marks = Marks(*(np.flatnonzero(weights.get(name, ())).tolist() for name in (PART_GROUP, KEEP_GROUP)))
    if any(marks) and count != len(obj.data.vertices):
        raise CanonicalFormError(
            told(
                "{name} is marked with Part Here or Keep Joined, and its modifiers change the number of vertices. Set "
                "Mesh to Base Mesh, or remove the marks.",
                name=obj.name,
            )
        )
    return marks


def all_marks(settings: Settings, marks: Sequence[Marks]) -> list[Marks]:
    """Add the marks that settings have to those of the first object.

    Parameters
    ----------
    settings : Settings
        Options of a run.
    marks : sequence of Marks
        Marks on each object, at least one.

    Returns
    -------
    list of Marks
        Marks on each object.
    """
    given = [settings.part_here or (), settings.keep_joined or ()]
    return [Marks(*([*more, *own] for own, more in zip(marks[0], given, strict=True))), *marks[1:]]


def with_marks(settings: Settings, marks: Sequence[Marks], starts: Sequence[int]) -> Settings:
    """Add the marks of objects to settings, by their numbers on a mesh of all objects, one after the other.

    Parameters
    ----------
    settings : Settings
        The options; their marks are those of the first object.
    marks : sequence of Marks
        Marks on each object, at least one.
    starts : sequence of int
        Where the vertices of each begin, and maybe where those of the last end.

    Returns
    -------
    Settings
        The options with all marks.

    Examples
    --------
    >>> with_marks(Settings(part_here=[1]), [Marks([2], []), Marks([0], [])], [0, 10, 20]).part_here
    (1, 2, 10)
    """
    part_here, keep_joined = (
        [start + vertex for start, own in zip(starts, each, strict=False) for vertex in own]
        for each in zip(*all_marks(settings, marks), strict=True)
    )
    return replace(settings, part_here=part_here, keep_joined=keep_joined)


def mark(obj: bpy.types.Object, group_name: str, how: str, *, seams: bool = False) -> int:
    """Add the selected vertices, or those of seams, to marks, or remove them.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, accepted by `refusal`, in any mode.
    group_name : {'Part Here', 'Keep Joined'}
        Which marks; their vertex group is added if it is missing, and removed with its last vertex.
    how : {'ADD', 'REMOVE', 'CLEAR'}
        Whether vertices are added or removed, or all are removed.
    seams : bool
        Whether the vertices of edges that are marked as seams are meant, instead of those selected.

    Returns
    -------
    int
        Number of marked vertices now.

    Raises
    ------
    CanonicalFormError
        If none are selected, or the group is locked.
    """
    with object_mode(obj):
        meant = _on_seams(obj.data) if seams else selected_vertices(obj.data)
        if not len(meant) and how != "CLEAR":
            if seams:
                raise CanonicalFormError(told("No edge is marked as a seam."))
            raise CanonicalFormError(
                told("Nothing is selected. In Edit Mode, select the edges or faces where the skin has grown together.")
            )
        group = obj.vertex_groups.get(group_name)
        if group is not None and group.lock_weight:
            raise CanonicalFormError(told("The vertex group {name} is locked. Unlock it first.", name=group_name))
        active = obj.vertex_groups.active.name if obj.vertex_groups.active else None
        if group is None and how == "ADD":
            group = obj.vertex_groups.new(name=group_name)
        if group is None:
            return 0
        if how == "ADD":
            group.add(meant.tolist(), 1.0, "REPLACE")
        elif how == "REMOVE":
            group.remove(meant.tolist())
        count = 0 if how == "CLEAR" else np.count_nonzero(weights_of(obj, [group_name])[group_name])
        if count == 0:
            obj.vertex_groups.remove(group)
        if active is not None and active in obj.vertex_groups:
            obj.vertex_groups.active_index = obj.vertex_groups.find(active)
        return int(count)


def _on_seams(mesh: bpy.types.Mesh) -> IntArray:
    """Return the vertices of the edges that are marked as seams."""
    seams = np.empty(len(mesh.edges), dtype=bool)
    mesh.edges.foreach_get("use_seam", seams)
    ends = np.empty(2 * len(mesh.edges), dtype=np.int32)
    mesh.edges.foreach_get("vertices", ends)
    return np.unique(ends.reshape(-1, 2)[seams]).astype(np.int64)
