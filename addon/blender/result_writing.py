"""Writes results to a mesh and takes exactly those away again.

What was written is kept in a record on the mesh, each name with a fingerprint of its content. Whatever has been
renamed, replaced or changed since is the user's own and is never touched.
"""

from __future__ import annotations

import hashlib
import json
from typing import Any

import bpy
import numpy as np

from ..core import CanonicalForm
from ..core.surface import IntArray
from .palette import patch_colours, ramp

RECORD = "canonical_form_record"
SHAPE_KEY = "Canonical Form"
FEATURE_GROUP = "Feature Points"
PATCH_GROUP = "Patch {}"
FIELD_COLOURS = "Auto Diffusion Function"
PATCH_COLOURS = "Patches"


def record_of(mesh: bpy.types.Mesh) -> dict[str, Any] | None:
    """Read what the last run wrote to a mesh.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.

    Returns
    -------
    dict or None
        Fingerprints of the key, groups and colours by name, and a report for the panel; None if there is no result.
    """
    text = mesh.get(RECORD)
    try:
        record = json.loads(text) if isinstance(text, str) else None
    except json.JSONDecodeError:
        return None
    return record if isinstance(record, dict) and "report" in record else None


def write_results(
    obj: bpy.types.Object, form: CanonicalForm, faces: IntArray, value: float, report: dict[str, Any]
) -> None:
    """Write a canonical form to a mesh as shape key, vertex groups and colours, in place of an earlier one.

    The shape key of an earlier run is kept and filled anew, so that animation, drivers and other keys that hang on it
    stay. If anything goes wrong, what has been written so far is removed again.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode. Objects that share its mesh show the results too.
    form : CanonicalForm
        The form and what was found on the way.
    faces : (m, 3) ndarray of int
        Triangles that the form was computed on.
    value : float
        Value of the shape key, 0 to 1.
    report : dict
        What the panel shows; kept with the record as JSON.
    """
    mesh = obj.data
    old = record_of(mesh)
    kept_key = _own_key(mesh, old)
    kept_basis = old["basis"] if old is not None and kept_key is not None else None
    if old is not None:
        _remove(obj, old, keep_key=kept_key is not None)
    record: dict[str, Any] = {"report": report, "before": _selection(obj), "basis": kept_basis, "key": {}}
    record["groups"], record["colours"] = {}, {}
    if old is not None and kept_key is not None and record["before"]["shape_key"] == kept_key.name:
        record["before"]["shape_key"] = old["before"]["shape_key"]
    done = False
    try:
        if mesh.shape_keys is None:
            record["basis"] = obj.shape_key_add(name="Basis", from_mix=False).name
        key = kept_key or obj.shape_key_add(name=SHAPE_KEY, from_mix=False)
        record["key"][key.name] = None
        if kept_key is None:
            key.relative_key = mesh.shape_keys.reference_key
        key.data.foreach_set("co", form.vertices.astype(np.float32).ravel())
        key.value = value
        record["key"][key.name] = _key_print(key)
        members = [form.feature_points]
        members += [np.flatnonzero(form.patches == index) for index in range(len(form.feature_points))]
        for number, vertices in enumerate(members):
            group = obj.vertex_groups.new(name=PATCH_GROUP.format(number) if number else FEATURE_GROUP)
            record["groups"][group.name] = None
            group.add(vertices.tolist(), 1.0, "REPLACE")
            record["groups"][group.name] = _fingerprint(np.sort(vertices), np.ones(len(vertices), dtype=np.float32))
        colours = patch_colours(form.patches, faces)[form.patches]
        for name, field in ((FIELD_COLOURS, ramp(np.log(form.adf))), (PATCH_COLOURS, colours)):
            attribute = mesh.color_attributes.new(name=name, type="FLOAT_COLOR", domain="POINT")
            record["colours"][attribute.name] = None
            attribute.data.foreach_set("color", field.astype(np.float32).ravel())
            record["colours"][attribute.name] = _colour_print(attribute)
        done = True
    finally:
        mesh[RECORD] = json.dumps(record)
        if not done:
            clear_results(obj)
    _restore_selection(obj, record["before"])
    if record["before"]["shape_key"] is None:
        obj.active_shape_key_index = mesh.shape_keys.key_blocks.find(key.name)
    if record["before"]["colour"] is None:
        mesh.color_attributes.active_color_name = attribute.name
    mesh.update()


def clear_results(obj: bpy.types.Object) -> list[str]:
    """Remove from a mesh exactly what the last run wrote.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode.

    Returns
    -------
    list of str
        Names of results that were left in place because they have been changed since.
    """
    mesh = obj.data
    record = record_of(mesh)
    if record is None:
        return []
    chosen = _selection(obj)
    left = _remove(obj, record)
    for kind, ours in (
        ("shape_key", [*record["key"], record["basis"]]),
        ("group", record["groups"]),
        ("colour", record["colours"]),
        ("render_colour", record["colours"]),
    ):
        if chosen[kind] in ours and chosen[kind] not in left:
            chosen[kind] = record["before"][kind]
    _restore_selection(obj, chosen)
    mesh.update()
    return left


def _remove(obj: bpy.types.Object, record: dict[str, Any], keep_key: bool = False) -> list[str]:
    """Remove what still is as the record says and list what is not; a print of None is that of a run cut short."""
    mesh, left = obj.data, []
    keys = mesh.shape_keys
    for name, fingerprint in record["key"].items():
        key = keys.key_blocks.get(name) if keys is not None else None
        if key is None or key == keys.reference_key or keep_key:
            continue
        if fingerprint in (None, _key_print(key)):
            obj.shape_key_remove(key)
        else:
            left.append(name)
    if keys is not None and not keep_key and record["basis"] is not None and len(keys.key_blocks) == 1:
        obj.shape_key_clear()  # the Basis was ours too
    prints = _group_prints(obj, record["groups"])
    for name, fingerprint in record["groups"].items():
        if name in prints and fingerprint in (None, prints[name]):
            obj.vertex_groups.remove(obj.vertex_groups[name])
        elif name in prints:
            left.append(name)
    for name, fingerprint in record["colours"].items():
        attribute = mesh.color_attributes.get(name)
        if attribute is not None and fingerprint in (None, _colour_print(attribute)):
            mesh.color_attributes.remove(attribute)
        elif attribute is not None:
            left.append(name)
    del mesh[RECORD]
    return left


def _own_key(mesh: bpy.types.Mesh, record: dict[str, Any] | None) -> bpy.types.ShapeKey | None:
    """Find the shape key of the last run, unless it has been changed since."""
    if record is None or mesh.shape_keys is None:
        return None
    for name, fingerprint in record["key"].items():
        key = mesh.shape_keys.key_blocks.get(name)
        if key is not None and key != mesh.shape_keys.reference_key and fingerprint == _key_print(key):
            return key
    return None


def _fingerprint(*arrays: np.ndarray) -> str:
    digest = hashlib.sha256()
    for array in arrays:
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


def _key_print(key: bpy.types.ShapeKey) -> str:
    points = np.empty(3 * len(key.data), dtype=np.float32)
    key.data.foreach_get("co", points)
    return _fingerprint(points)


def _colour_print(attribute: bpy.types.Attribute) -> str:
    colours = np.empty(4 * len(attribute.data), dtype=np.float32)
    attribute.data.foreach_get("color", colours)
    return _fingerprint(colours)


def _group_prints(obj: bpy.types.Object, names: dict[str, Any]) -> dict[str, str]:
    """Fingerprint several vertex groups in one pass over the vertices."""
    found = {obj.vertex_groups[name].index: name for name in names if name in obj.vertex_groups}
    members: dict[int, list[int]] = {index: [] for index in found}
    weights: dict[int, list[float]] = {index: [] for index in found}
    for vertex in obj.data.vertices:
        for part in vertex.groups:
            if part.group in found:
                members[part.group].append(vertex.index)
                weights[part.group].append(part.weight)
    return {
        name: _fingerprint(np.array(members[index], dtype=np.int64), np.array(weights[index], dtype=np.float32))
        for index, name in found.items()
    }


def _selection(obj: bpy.types.Object) -> dict[str, str | None]:
    """Note which key, group and colours are active, by name, since removing shifts the numbers."""
    mesh = obj.data
    colours = mesh.color_attributes
    render = colours.render_color_index
    return {
        "shape_key": obj.active_shape_key.name if obj.active_shape_key else None,
        "group": obj.vertex_groups.active.name if obj.vertex_groups.active else None,
        "colour": colours.active_color.name if colours.active_color else None,
        "render_colour": colours[render].name if 0 <= render < len(colours) else None,
    }


def _restore_selection(obj: bpy.types.Object, chosen: dict[str, str | None]) -> None:
    mesh = obj.data
    if mesh.shape_keys is not None and chosen["shape_key"] is not None:
        obj.active_shape_key_index = max(mesh.shape_keys.key_blocks.find(chosen["shape_key"]), 0)
    if chosen["group"] is not None:
        obj.vertex_groups.active_index = max(obj.vertex_groups.find(chosen["group"]), 0)
    if chosen["colour"] is not None and chosen["colour"] in mesh.color_attributes:
        mesh.color_attributes.active_color_name = chosen["colour"]
    if chosen["render_colour"] is not None and chosen["render_colour"] in mesh.color_attributes:
        mesh.color_attributes.render_color_index = mesh.color_attributes.find(chosen["render_colour"])
