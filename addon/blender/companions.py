"""Objects whose results are of one body: who they are, and the one slider that moves them all."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import bpy

from .form_key import form_key
from .in_betweens import animated_slider, slider_path
from .record import Record, read_record, write_record
from .slider import FOLLOWING, is_following, release

_Member = tuple[bpy.types.Object, Record]


def companions_of(obj: bpy.types.Object) -> list[bpy.types.Object]:
    """List the objects whose results are of one body with that of an object.

    Parameters
    ----------
    obj : bpy.types.Object
        A mesh object.

    Returns
    -------
    list of bpy.types.Object
        The one that has the slider first, then the others, in the order of the run. The object alone where its result
        is of itself, where the user has set it free by deleting the driver of its key, and where it is a copy of
        another.
    """
    record = read_record(obj.data)
    if record is None or record.part is None:
        return [obj]
    return _body_of((obj, record), _members())


def with_companions(objects: Sequence[bpy.types.Object]) -> list[bpy.types.Object]:
    """Add to some objects those whose results are of one body with theirs.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        Mesh objects.

    Returns
    -------
    list of bpy.types.Object
        The objects, then the others; each once.
    """
    found = dict.fromkeys(objects)
    records = {obj: read_record(obj.data) for obj in objects}
    members, bodies = None, set()
    for obj, record in records.items():
        if record is None or record.part is None:
            continue
        members = _members() if members is None else members
        key = record.part.body, _leader((obj, record), members)
        if key not in bodies:
            bodies.add(key)
            found |= dict.fromkeys(_body_of((obj, record), members))
    return list(found)


def own_sliders(objects: Sequence[bpy.types.Object]) -> list[str]:
    """Tell which forms will keep a slider of their own, because it is animated.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        Objects of one body.

    Returns
    -------
    list of str
        A sentence for each, the first object left out.
    """
    animations = [obj.name for obj in objects[1:] if animated_slider(obj.data)]
    return [f"The shape key of {name} keeps its animation, and does not follow the slider." for name in animations]


def set_free(obj: bpy.types.Object) -> None:
    """Take an object out of its body; its result stays.

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
    """Let the slider of the first object move the forms of all that are not animated.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        Objects with forms.
    """
    for obj in objects[1:]:
        if not animated_slider(obj.data):
            _follow(obj.data, objects[0].data)


def slider_is_gone(obj: bpy.types.Object) -> bool:
    """Return whether the form of an object follows the slider of one that is not there any more.

    Parameters
    ----------
    obj : bpy.types.Object
        A mesh object.

    Returns
    -------
    bool
        True if the slider of the object is driven, and by no object of the scene.
    """
    leading = _driven_by(obj.data)
    return _follows(obj.data) and not any(each.data == leading for each in bpy.context.scene.objects)


def _members() -> list[_Member]:
    """List the objects of the scene that are parts of bodies, with their records; each mesh once."""
    found = {}
    for obj in bpy.context.scene.objects:
        if obj.type == "MESH" and obj.data not in found:
            record = read_record(obj.data, containing='"part"')
            if record is not None and record.part is not None:
                found[obj.data] = (obj, record)
    return list(found.values())


def _body_of(member: _Member, members: Iterable[_Member]) -> list[bpy.types.Object]:
    """List the objects of the body of one of them."""
    obj, record = member
    assert record.part is not None
    members = [each for each in members if each[1].part is not None and each[1].part.body == record.part.body]
    members = [member if each[0].data == obj.data else each for each in members]
    leading = _leader(member, members)
    if _is_free(member):
        return [obj]
    body = [each for each in members if _leader(each, members) == leading and not _is_free(each)]
    parts: dict[int, bpy.types.Object] = {}
    for other, about in sorted(body, key=lambda each: (each[0].name not in record.report.objects, each[0].name)):
        parts.setdefault(about.part.number, other)  # type: ignore[union-attr]
    if obj not in parts.values():  # a copy
        return [obj]
    return [parts[number] for number in sorted(parts)]


def _leader(member: _Member, members: Iterable[_Member]) -> bpy.types.Mesh | None:
    """Find the mesh whose slider moves the form of an object, or would; None where it is gone."""
    obj, record = member
    assert record.part is not None
    if record.part.number == 0:
        return obj.data
    body = record.part.body
    leaders = [each for each in members if each[1].part is not None and each[1].part[::2] == (0, body)]
    driven_by = _driven_by(obj.data)
    for each, _ in leaders:
        if each.data == driven_by:
            return each.data
    if driven_by is not None:
        return None
    listed = [each.data for each, _ in leaders if each.name in record.report.objects]
    return next(iter(listed or [each.data for each, _ in leaders]), None)


def _is_free(member: _Member) -> bool:
    """Return whether the user has set the form of a part free: it has a key, and nothing of ours drives it."""
    obj, record = member
    assert record.part is not None
    keys = obj.data.shape_keys
    if record.part.number == 0 or keys is None or form_key(obj.data) is None:
        return False
    return not _follows(obj.data)


def _follows(mesh: bpy.types.Mesh) -> bool:
    """Return whether a driver of ours moves the form of a mesh, even if what it follows is gone."""
    return _follow_curve(mesh) is not None


def _driven_by(mesh: bpy.types.Mesh) -> bpy.types.Mesh | None:
    """Find the mesh whose slider moves the form of a mesh."""
    curve = _follow_curve(mesh)
    leading = None if curve is None else curve.driver.variables[0].targets[0].id
    return None if leading is None else leading.user


def _follow_curve(mesh: bpy.types.Mesh) -> bpy.types.FCurve | None:
    """Find the driver by which a form follows another slider."""
    keys = mesh.shape_keys
    if keys is None or keys.animation_data is None:
        return None
    curve = keys.animation_data.drivers.find(slider_path(mesh))
    return curve if curve is not None and is_following(curve) else None


def _follow(mesh: bpy.types.Mesh, leading: bpy.types.Mesh) -> None:
    """Drive the slider of a mesh by that of another."""
    release(mesh.shape_keys)
    driver = mesh.shape_keys.driver_add(slider_path(mesh)).driver
    driver.type = "SUM"
    variable = driver.variables.new()
    variable.name = FOLLOWING
    variable.targets[0].id_type = "KEY"
    variable.targets[0].id = leading.shape_keys
    variable.targets[0].data_path = slider_path(leading)
    mesh.shape_keys.update_tag()
