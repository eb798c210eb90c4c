"""Reads where vertices are with their armature at rest: there nothing touches by chance, and all is one body."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ...core import CanonicalFormError
from ..mesh_items.key_points import key_points
from ..records.rig_record import read_rig, recorded_key
from ..records.transfer_record import read_transfers, rest_key
from .combining import moved
from .mesh_reading import Reading, read_shown
from .placement import placement_of

if TYPE_CHECKING:
    from ...core.numerics.arrays import FloatArray, IntArray

_SIMULATED = ("CLOTH", "SOFT_BODY", "FLUID", "DYNAMIC_PAINT", "PARTICLE_SYSTEM", "MESH_CACHE", "MESH_SEQUENCE_CACHE")


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
    rigs = [rigs_of(obj) for obj in objects]
    rig = next(iter(rigs[0]), None) if rigs else None
    if rig is None or any(each != {rig} for each in rigs):
        return list(readings)
    if rig.data.pose_position == "REST" or not any(each.deformed for each in readings):
        held = any(_constraining(above) for obj in objects for above in chain_of(obj))  # which base meshes do not undo
        if held:
            return list(readings)
        return [each._replace(rest=_base_at_rest(obj, each)) for obj, each in zip(objects, readings, strict=True)]
    if not rig.data.is_editable or any(_is_simulated(obj) for obj in objects):
        return list(readings)
    corners = [_corners_of(obj) for obj in objects]
    with _at_rest(rig.data):
        rests = [_rest_of(*each) for each in zip(objects, readings, corners, strict=True)]
    if any(rest is None for rest in rests):
        return list(readings)
    return [each._replace(rest=rest) for each, rest in zip(readings, rests, strict=True)]


def _base_at_rest(obj: bpy.types.Object, reading: Reading) -> FloatArray:
    """Read a base mesh as its bones rest: by the key that *Rig* or *Transfer* wrote, if one did, else as it is."""
    record = read_rig(obj.data)
    rest = None if record is None else record.rest
    key = rest_key(obj.data) if rest is None else recorded_key(obj.data, *rest)
    return reading.vertices if key is None else key_points(key).astype(np.float64)


def _rest_of(obj: bpy.types.Object, reading: Reading, corners: IntArray) -> FloatArray | None:
    """Read an object whose armature is at rest, in the space of its reading; None if it has other polygons then."""
    try:
        vertices, _ = read_shown(obj)
    except CanonicalFormError:  # nothing is shown at rest; what is shown in the pose has been read
        return None
    axes = reading.placement[:3, :3]
    flat = abs(np.linalg.det(axes)) <= np.finfo(float).tiny  # told elsewhere
    if flat or len(vertices) != len(reading.vertices) or not np.array_equal(_corners_of(obj), corners):
        return None
    back = np.linalg.inv(reading.placement) @ placement_of(obj, True)
    return moved(vertices, back)


def _corners_of(obj: bpy.types.Object) -> IntArray:
    """Read the vertices of all polygons in turn; their triangles depend on the pose, where a quad is a dart."""
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    corners = np.empty(len(mesh.loops), dtype=np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    return corners.astype(np.int64)


def rigs_of(obj: bpy.types.Object) -> set[bpy.types.Object]:
    """Find the armatures that move an object: by a modifier, as a parent, or by a constraint."""
    found = [each.object for each in obj.modifiers if each.type == "ARMATURE" and each.show_viewport]
    for above in chain_of(obj):
        found += [above, *_constraining(above)]
    return {each for each in found if each is not None and each.type == "ARMATURE"}


def moved_by(rig: bpy.types.Object) -> list[bpy.types.Object]:
    """List the meshes that are shown and that an armature alone moves, without those that *Transfer* bound to it."""
    found = [each for each in _shown_meshes() if rigs_of(each) == {rig}]
    return [each for each in found if not _has_taken(each, rig)] or found


def moved_with_others(rig: bpy.types.Object) -> list[bpy.types.Object]:
    """List the meshes that are shown and that an armature moves together with another one."""
    return [each for each in _shown_meshes() if rig in rigs_of(each) and rigs_of(each) != {rig}]


def _shown_meshes() -> list[bpy.types.Object]:
    """List the objects of the view layer that have faces and are shown."""
    objects = bpy.context.view_layer.objects
    return [each for each in objects if each.type == "MESH" and each.data.polygons and each.visible_get()]


def _has_taken(obj: bpy.types.Object, rig: bpy.types.Object) -> bool:
    """Return whether *Transfer* has bound an object to an armature."""
    modifiers = (obj.modifiers.get(name) for name in read_transfers(obj.data)["rigs"])
    return any(getattr(each, "object", None) == rig for each in modifiers)


def chain_of(obj: bpy.types.Object) -> Iterator[bpy.types.Object]:
    """List an object, its parent, and so on."""
    above: bpy.types.Object | None = obj
    while above is not None:
        yield above
        above = above.parent


def _constraining(obj: bpy.types.Object) -> list[bpy.types.Object]:
    """List the armatures that constraints tie an object to."""
    active = [each for each in obj.constraints if not each.mute and each.influence > 0]
    targets = [getattr(each, "target", None) for each in active]
    targets += [each.target for constraint in active for each in getattr(constraint, "targets", ())]
    return [each for each in targets if each is not None and each.type == "ARMATURE"]


def _is_simulated(obj: bpy.types.Object) -> bool:
    """Check whether an object keeps its shape, and its cache loses its frames, when the armature rests."""
    return any(each.show_viewport and each.type in _SIMULATED for each in obj.modifiers)


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
