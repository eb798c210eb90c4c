"""Objects whose forms are of one body: who they are, and the one slider that moves them all."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from .form_key import form_key
from .in_betweens import PROPERTY, animated, has_in_betweens
from .record import read_record
from .slider import FOLLOWING, is_following, release


def companions_of(obj: bpy.types.Object) -> list[bpy.types.Object]:
    """List the objects whose forms are of one body with that of an object.

    Parameters
    ----------
    obj : bpy.types.Object
        A mesh object.

    Returns
    -------
    list of bpy.types.Object
        The one that has the slider first, then those that follow it, in the order of the run. The object alone where
        its form is of itself, or where its slider is gone. Of copies of one object, one is listed.
    """
    record = read_record(obj.data)
    if record is None or record.part is None:
        return [obj]
    leading = _leader(obj.data) or obj.data
    meshes = [leading, *(each.user for each in bpy.data.shape_keys if _leader(each.user) == leading)]
    found: dict[int, bpy.types.Object] = {}
    there = [each for each in bpy.context.scene.objects if each.type == "MESH" and each.data in meshes]
    for other in sorted(there, key=lambda each: (each != obj, each.name not in record.report.objects)):
        about = read_record(other.data)
        if about is not None and about.part is not None:
            found.setdefault(about.part.number, other)
    return [found[number] for number in sorted(found)] if len(found) > 1 else [obj]


def with_companions(objects: Sequence[bpy.types.Object]) -> list[bpy.types.Object]:
    """Add to some objects those whose forms are of one body with theirs.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        Mesh objects.

    Returns
    -------
    list of bpy.types.Object
        The objects, then the others; each once.
    """
    return list(dict.fromkeys([*objects, *(other for obj in objects for other in companions_of(obj))]))


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
    animations = [obj.name for obj in objects[1:] if animated(obj.data) is not None]
    return [f"The shape key of {name} keeps its animation, and does not follow the slider." for name in animations]


def lead(objects: Sequence[bpy.types.Object]) -> None:
    """Let the slider of the first object move the forms of all that are not animated.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        Objects with forms.
    """
    for obj in objects[1:]:
        if animated(obj.data) is None:
            _follow(obj.data, objects[0].data)


def _follow(mesh: bpy.types.Mesh, leading: bpy.types.Mesh) -> None:
    """Drive the slider of a mesh by that of another."""
    release(mesh.shape_keys)
    driver = mesh.shape_keys.driver_add(_slider_path(mesh)).driver
    driver.type = "SUM"
    variable = driver.variables.new()
    variable.name = FOLLOWING
    variable.targets[0].id_type = "KEY"
    variable.targets[0].id = leading.shape_keys
    variable.targets[0].data_path = _slider_path(leading)
    mesh.shape_keys.update_tag()


def _slider_path(mesh: bpy.types.Mesh) -> str:
    """Find the property of the shape keys that moves the form."""
    form = form_key(mesh)
    if has_in_betweens(mesh) or form is None:
        return f'["{PROPERTY}"]'
    return f'key_blocks["{bpy.utils.escape_identifier(form.name)}"].value'


def _leader(mesh: bpy.types.ID | None) -> bpy.types.Mesh | None:
    """Find the mesh whose slider moves the form of a mesh."""
    keys = mesh.shape_keys if isinstance(mesh, bpy.types.Mesh) else None
    if keys is None or keys.animation_data is None or form_key(mesh) is None:
        return None
    curve = keys.animation_data.drivers.find(_slider_path(mesh))
    if curve is None or not is_following(curve):
        return None
    leading = curve.driver.variables[0].targets[0].id
    return None if leading is None else leading.user
