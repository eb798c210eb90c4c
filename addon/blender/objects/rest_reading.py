"""Reads where vertices are with their armature at rest: there nothing touches by chance, and all is one body."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

import bpy
import numpy as np

from .mesh_reading import Reading, read_evaluated
from .placement import placement_of

if TYPE_CHECKING:
    from ...core.numerics.arrays import FloatArray


def with_rests(objects: Sequence[bpy.types.Object], readings: Sequence[Reading]) -> list[Reading]:
    """Add the positions at rest to readings.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        The objects, in Object Mode, keys of earlier runs muted.
    readings : sequence of Reading
        Their arrays.

    Returns
    -------
    list of Reading
        The same with `rest` if one armature moves them all. Several are several characters, whose rests may be at one
        place, and what no armature moves, such as a floor, touches them by chance.
    """
    rigs = [_rigs_of(obj) for obj in objects]
    rig = next(iter(rigs[0]), None) if rigs else None
    if rig is None or any(each != {rig} for each in rigs):
        return list(readings)
    if rig.data.pose_position == "REST" or not any(each.deformed for each in readings):
        return [each._replace(rest=each.vertices) for each in readings]
    if not rig.data.is_editable:
        return list(readings)
    with _at_rest(rig.data):
        rests = [_rest_of(obj, each) for obj, each in zip(objects, readings, strict=True)]
    if any(rest is None for rest in rests):
        return list(readings)
    return [each._replace(rest=rest) for each, rest in zip(readings, rests, strict=True)]


def _rest_of(obj: bpy.types.Object, reading: Reading) -> FloatArray | None:
    """Read an object whose armatures are at rest, in the space of its reading; None if it has other vertices then."""
    vertices, _ = read_evaluated(obj)
    if len(vertices) != len(reading.vertices):
        return None
    axes = reading.placement[:3, :3]
    if abs(np.linalg.det(axes)) <= np.finfo(float).tiny:  # told elsewhere
        return None
    back = np.linalg.inv(reading.placement) @ placement_of(obj, True)
    return vertices @ back[:3, :3].T + back[:3, 3]


def _rigs_of(obj: bpy.types.Object) -> set[bpy.types.Object]:
    """Find the armatures that move an object: by a modifier, as a parent, or by a constraint."""
    found = [each.object for each in obj.modifiers if each.type == "ARMATURE" and each.show_viewport]
    above: bpy.types.Object | None = obj
    while above is not None:
        found += [above, *(getattr(each, "target", None) for each in above.constraints)]
        above = above.parent
    return {each for each in found if each is not None and each.type == "ARMATURE"}


@contextmanager
def _at_rest(rig: bpy.types.Armature) -> Iterator[None]:
    """Put an armature into its rest position, and back, even after an error."""
    try:
        rig.pose_position = "REST"
        bpy.context.view_layer.update()
        yield
    finally:
        rig.pose_position = "POSE"
        bpy.context.view_layer.update()
