"""Companions: objects with results of the same body, which share one slider."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import bpy

from ..mesh_items.slider import FOLLOWING, is_following, release
from ..records.record import Part, read_record, write_record
from ..words.wording import told
from .in_betweens import PROPERTY, animated_slider, slider_path, value_path


class _Member(NamedTuple):
    """The data that assigns a part to its body; read once, as panels ask at every redraw."""

    obj: bpy.types.Object
    part: Part
    objects: list[str]
    free: bool
    follows: bool
    driven_by: bpy.types.Mesh | None


def companions_of(obj: bpy.types.Object) -> list[bpy.types.Object]:
    """Return the objects whose results belong to the same body as that of an object.

    Parameters
    ----------
    obj : bpy.types.Object
        A mesh object.

    Returns
    -------
    list of bpy.types.Object
        The object with the slider first, then the others, in the order of the run. Only the object itself if its result
        is of this object alone, if the user has detached it by deleting the driver of its key, or if it is a copy of
        another part.
    """
    member = _member(obj)
    return [obj] if member is None else _body_of(member, _members())


def with_companions(objects: Sequence[bpy.types.Object]) -> list[bpy.types.Object]:
    """Add the companions of objects.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        Mesh objects.

    Returns
    -------
    list of bpy.types.Object
        The objects, then their companions; each once.
    """
    found = dict.fromkeys(objects)
    parts = [member for member in map(_member, objects) if member is not None]
    members = _members() if parts else []
    for member in parts:
        found |= dict.fromkeys(_body_of(member, members))
    return list(found)


def own_sliders(objects: Sequence[bpy.types.Object]) -> list[str]:
    """Report which forms keep their own slider because it is animated.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        Objects of one body.

    Returns
    -------
    list of str
        One message per form, except that of the first object.
    """
    animations = [obj.name for obj in objects[1:] if animated_slider(obj.data)]
    return [
        told("The shape key of {name} keeps its animation, and does not follow the slider.", name=name)
        for name in animations
    ]


def set_free(obj: bpy.types.Object) -> None:
    """Remove an object from its body; its result is kept.

    Parameters
    ----------
    obj : bpy.types.Object
        A mesh object with a result.
    """
    release(obj.data.shape_keys)
    record = read_record(obj.data)
    if record is not None:
        record.part = None
        write_record(obj.data, record)


def lead(objects: Sequence[bpy.types.Object]) -> None:
    """Link the forms of all objects to the slider of the first, except animated ones.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        Objects with forms.
    """
    for obj in objects[1:]:
        if not animated_slider(obj.data):
            _follow(obj.data, objects[0].data)


def slider_is_gone(obj: bpy.types.Object) -> bool:
    """Return whether the form of an object follows the slider of an object that no longer exists.

    Parameters
    ----------
    obj : bpy.types.Object
        A mesh object.

    Returns
    -------
    bool
        True if a driver links its slider to an object that is not in the scene.
    """
    member = _member(obj)
    if member is None or not member.follows:
        return False
    return not any(each.data == member.driven_by for each in bpy.context.scene.objects)


def _members() -> list[_Member]:
    """Return the parts of bodies in the scene, one per mesh."""
    found: dict[bpy.types.Mesh, _Member | None] = {}
    for obj in bpy.context.scene.objects:
        if obj.type == "MESH" and obj.data not in found:
            found[obj.data] = _member(obj)
    return [member for member in found.values() if member is not None]


def _member(obj: bpy.types.Object) -> _Member | None:
    """Read an object as a part of a body; None if it is not."""
    record = read_record(obj.data, containing='"part"')
    if record is None or record.part is None:
        return None
    keys = obj.data.shape_keys
    name = next((each for each in record.keys if keys is not None and each in keys.key_blocks), None)
    curve = None
    if keys is not None and keys.animation_data is not None:
        between = record.in_betweens is not None and PROPERTY in keys
        forms = [keys.key_blocks[each] for each in record.keys if each in keys.key_blocks]  # one, or one a frame
        paths = [f'["{PROPERTY}"]'] if between or name is None else [value_path(each) for each in forms]
        curves = [curve for path in paths if (curve := keys.animation_data.drivers.find(path)) is not None]
        curve = next((each for each in curves if is_following(each)), None)
    follows = curve is not None
    leading = None if curve is None else curve.driver.variables[0].targets[0].id
    free = record.part.number > 0 and name is not None and not follows
    driven_by = None if leading is None else leading.user
    return _Member(obj, record.part, record.report.objects, free, follows, driven_by)


def _body_of(member: _Member, members: Iterable[_Member]) -> list[bpy.types.Object]:
    """Return the objects of the body of a part."""
    if member.free:  # the user has deleted the driver of its key
        return [member.obj]
    same = [each for each in members if each.part.body == member.part.body and not each.free]
    same = [member if each.obj.data == member.obj.data else each for each in same]
    leaders = [each for each in same if each.part.number == 0]
    leading = _leader(member, leaders)
    parts: dict[int, bpy.types.Object] = {}
    for each in sorted(same, key=lambda each: (each.obj.name not in member.objects, each.obj.name)):
        if _leader(each, leaders) == leading:
            parts.setdefault(each.part.number, each.obj)
    if member.obj not in parts.values():  # a copy
        return [member.obj]
    return [parts[number] for number in sorted(parts)]


def _leader(member: _Member, leaders: Sequence[_Member]) -> bpy.types.Mesh | None:
    """Return the mesh whose slider moves the form of a part, or would do so; None if it no longer exists."""
    if member.part.number == 0:
        return member.obj.data
    if member.follows:
        return next((each.obj.data for each in leaders if each.obj.data == member.driven_by), None)
    listed = [each.obj.data for each in leaders if each.obj.name in member.objects]
    return next(iter(listed or [each.obj.data for each in leaders]), None)


def _follow(mesh: bpy.types.Mesh, leading: bpy.types.Mesh) -> None:
    """Drive the slider of a mesh by the slider of another."""
    release(mesh.shape_keys)
    driver = mesh.shape_keys.driver_add(slider_path(mesh)).driver
    driver.type = "SUM"
    variable = driver.variables.new()
    variable.name = FOLLOWING
    variable.targets[0].id_type = "KEY"
    variable.targets[0].id = leading.shape_keys
    variable.targets[0].data_path = slider_path(leading)
    mesh.shape_keys.update_tag()
