"""The record of what was written to a mesh: names with fingerprints, so that exactly that can be taken away again.

Whatever has been renamed, replaced or changed since is the user's own and is never touched.
"""

from __future__ import annotations

import hashlib
import json
from typing import Any

import bpy
import numpy as np

from ..core import CanonicalFormError

RECORD = "canonical_form_record"
DISTANCES = "canonical_form_distances"  # of the distance tools: names and fingerprints of what they wrote
_FIELDS = {"report", "before", "basis", "key", "groups", "colours"}


def record_of(mesh: bpy.types.Mesh) -> dict[str, Any] | None:
    """Read what the last run wrote to a mesh.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.

    Returns
    -------
    dict or None
        Fingerprints of the keys, groups, colours and hidden attributes by name, and a report for the panel; None if
        there is no result.
    """
    text = mesh.get(RECORD)
    try:
        record = json.loads(text) if isinstance(text, str) else None
    except json.JSONDecodeError:
        return None
    if not isinstance(record, dict) or not record.keys() >= _FIELDS:
        return None
    return {"palette": [], "hidden": {}, **record}


def keep_record(mesh: bpy.types.Mesh, record: dict[str, Any]) -> None:
    """Write the record to a mesh.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.
    record : dict
        As `record_of` gives it.
    """
    mesh[RECORD] = json.dumps(record)


def own_key(mesh: bpy.types.Mesh) -> bpy.types.ShapeKey | None:
    """Find the shape key of the last run, unless it has been removed or changed since.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.

    Returns
    -------
    bpy.types.ShapeKey or None
        The key.
    """
    key, record = named_key(mesh), record_of(mesh)
    if key is None or record is None or record["key"][key.name] != key_print(key):
        return None
    return key


def named_key(mesh: bpy.types.Mesh) -> bpy.types.ShapeKey | None:
    """Find the shape key that has the name of ours, without a look at its content: quick enough for a panel.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.

    Returns
    -------
    bpy.types.ShapeKey or None
        The key.
    """
    record = record_of(mesh)
    if record is None or mesh.shape_keys is None:
        return None
    for name in record["key"]:
        key = mesh.shape_keys.key_blocks.get(name)
        if key is not None and key != mesh.shape_keys.reference_key:
            return key
    return None


def required_record(mesh: bpy.types.Mesh) -> dict[str, Any]:
    """Read the record where there has to be one.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.

    Returns
    -------
    dict
        As `record_of` gives it.

    Raises
    ------
    CanonicalFormError
        If there is none.
    """
    record = record_of(mesh)
    if record is None:
        raise CanonicalFormError(f"{mesh.name} has no canonical form. Compute it first.")
    return record


def required_key(mesh: bpy.types.Mesh) -> bpy.types.ShapeKey:
    """Find the shape key of the last run where there has to be one.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.

    Returns
    -------
    bpy.types.ShapeKey
        The key.

    Raises
    ------
    CanonicalFormError
        If it has been removed or changed.
    """
    key = own_key(mesh)
    if key is None:
        raise CanonicalFormError(
            "The shape key of the form was changed, renamed or removed. Compute the form again first."
        )
    return key


def fingerprint(*arrays: np.ndarray) -> str:
    """Hash arrays, bit for bit.

    Parameters
    ----------
    *arrays : ndarray
        The arrays.

    Returns
    -------
    str
        SHA-256 in hexadecimal.
    """
    digest = hashlib.sha256()
    for array in arrays:
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


def key_print(key: bpy.types.ShapeKey) -> str:
    """Hash the positions of a shape key.

    Parameters
    ----------
    key : bpy.types.ShapeKey
        The key.

    Returns
    -------
    str
        The fingerprint.
    """
    points = np.empty(3 * len(key.data), dtype=np.float32)
    key.data.foreach_get("co", points)
    return fingerprint(points)


def drop_drivers(key: bpy.types.ShapeKey) -> None:
    """Remove the drivers of a shape key that is to be removed: Blender would go on to write where it was.

    Parameters
    ----------
    key : bpy.types.ShapeKey
        The key.
    """
    data = key.id_data.animation_data
    path = f'key_blocks["{bpy.utils.escape_identifier(key.name)}"].'
    for curve in [each for each in data.drivers if each.data_path.startswith(path)] if data is not None else ():
        data.drivers.remove(curve)


def clear_keys(obj: bpy.types.Object) -> None:
    """Remove all shape keys of an object, and nothing is left of them.

    Blender before 5.2 counts one user too many for the keys of a copied mesh, and would keep their data for ever.

    Parameters
    ----------
    obj : bpy.types.Object
        The object; its mesh has shape keys.
    """
    name = obj.data.shape_keys.name
    obj.shape_key_clear()
    left = [keys for keys in bpy.data.shape_keys if keys.name == name and keys.library is None]
    if left:
        bpy.data.batch_remove(left)


def colour_print(attribute: bpy.types.Attribute) -> str:
    """Hash the colours of a colour attribute.

    Parameters
    ----------
    attribute : bpy.types.Attribute
        The attribute, of type FLOAT_COLOR or BYTE_COLOR.

    Returns
    -------
    str
        The fingerprint.
    """
    colours = np.empty(4 * len(attribute.data), dtype=np.float32)
    attribute.data.foreach_get("color", colours)
    return fingerprint(colours)


def members_print(vertices: np.ndarray, weights: np.ndarray) -> str:
    """Hash the members of a vertex group.

    Parameters
    ----------
    vertices : (k,) ndarray of int
        Members, in rising order.
    weights : (k,) ndarray of float
        Their weights.

    Returns
    -------
    str
        The fingerprint.
    """
    return fingerprint(vertices.astype(np.int64), weights.astype(np.float32))


def group_prints(obj: bpy.types.Object, names: dict[str, Any]) -> dict[str, str]:
    """Hash several vertex groups in one pass over the vertices.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode.
    names : dict
        Names of groups, as keys.

    Returns
    -------
    dict of str to str
        Fingerprints of those that exist.
    """
    found = {obj.vertex_groups[name].index: name for name in names if name in obj.vertex_groups}
    members: dict[int, list[int]] = {index: [] for index in found}
    weights: dict[int, list[float]] = {index: [] for index in found}
    for vertex in obj.data.vertices if found else ():
        for part in vertex.groups:
            if part.group in found:
                members[part.group].append(vertex.index)
                weights[part.group].append(part.weight)
    return {name: members_print(np.array(members[index]), np.array(weights[index])) for index, name in found.items()}


def free_name(obj: bpy.types.Object, name: str) -> str:
    """Give colours a name that no vertex group has: the group would hide them from the view.

    Parameters
    ----------
    obj : bpy.types.Object
        The object.
    name : str
        Name wanted for a colour attribute.

    Returns
    -------
    str
        That name, or a longer one.
    """
    while name in obj.vertex_groups:
        name += " Colours"
    return name


def selection_of(obj: bpy.types.Object) -> dict[str, str | None]:
    """Note which key, group and colours are active, by name, since removing shifts the numbers.

    Parameters
    ----------
    obj : bpy.types.Object
        The object.

    Returns
    -------
    dict of str to str or None
        Names by kind.
    """
    mesh = obj.data
    colours = mesh.color_attributes
    render = colours.render_color_index
    return {
        "shape_key": obj.active_shape_key.name if obj.active_shape_key else None,
        "group": obj.vertex_groups.active.name if obj.vertex_groups.active else None,
        "colour": colours.active_color.name if colours.active_color else None,
        "render_colour": colours[render].name if 0 <= render < len(colours) else None,
    }


def twins_of(obj: bpy.types.Object) -> dict[bpy.types.Object, str | None]:
    """Note the active shape keys of the other objects that share a mesh, by name.

    Parameters
    ----------
    obj : bpy.types.Object
        The object.

    Returns
    -------
    dict of bpy.types.Object to str or None
        Names of their active keys.
    """
    others = [other for other in bpy.data.objects if other.data == obj.data and other != obj]
    return {other: other.active_shape_key and other.active_shape_key.name for other in others}


def restore_twins(twins: dict[bpy.types.Object, str | None]) -> None:
    """Make the same shape keys active again, as far as they are still there.

    Parameters
    ----------
    twins : dict
        As `twins_of` gives it.
    """
    for other, name in twins.items():
        keys = other.data.shape_keys
        if keys is not None and name is not None and name in keys.key_blocks:
            other.active_shape_key_index = keys.key_blocks.find(name)


def restore_selection(obj: bpy.types.Object, chosen: dict[str, str | None]) -> None:
    """Make the same key, group and colours active again.

    Parameters
    ----------
    obj : bpy.types.Object
        The object.
    chosen : dict
        As `selection_of` gives it.
    """
    mesh = obj.data
    if mesh.shape_keys is not None and chosen["shape_key"] is not None:
        obj.active_shape_key_index = max(mesh.shape_keys.key_blocks.find(chosen["shape_key"]), 0)
    if chosen["group"] is not None:
        obj.vertex_groups.active_index = max(obj.vertex_groups.find(chosen["group"]), 0)
    if chosen["colour"] is not None and chosen["colour"] in mesh.color_attributes:
        mesh.color_attributes.active_color_name = chosen["colour"]
    if chosen["render_colour"] is not None and chosen["render_colour"] in mesh.color_attributes:
        mesh.color_attributes.render_color_index = mesh.color_attributes.find(chosen["render_colour"])
