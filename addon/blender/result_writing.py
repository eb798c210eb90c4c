"""Writes results to a mesh and takes exactly those away again.

What was written is kept in a record on the mesh, so that nothing of the user's is ever mistaken for a result, even
where it has the same name.
"""

from __future__ import annotations

import json
from typing import Any

import bpy
import numpy as np

from ..core import CanonicalForm
from ..core.surface import FloatArray, IntArray
from .palette import patch_colours, ramp

RECORD = "canonical_form"
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
        Names of the key, groups and colours, and a report for the panel; None if there is no result.
    """
    text = mesh.get(RECORD)
    return json.loads(text) if isinstance(text, str) else None


def write_results(
    obj: bpy.types.Object, form: CanonicalForm, faces: IntArray, value: float, report: dict[str, Any]
) -> None:
    """Write a canonical form to a mesh as shape key, vertex groups and colours, in place of an earlier one.

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
    clear_results(obj)
    mesh = obj.data
    record: dict[str, Any] = {"report": report, "before": _selection(obj)}
    record["basis"] = None
    if mesh.shape_keys is None:
        record["basis"] = obj.shape_key_add(name="Basis", from_mix=False).name
    record["shape_key"] = _write_shape_key(obj, form.vertices, value)
    record["groups"] = [_write_group(obj, FEATURE_GROUP, form.feature_points)]
    for index in range(len(form.feature_points)):
        members = np.flatnonzero(form.patches == index)
        record["groups"].append(_write_group(obj, PATCH_GROUP.format(index + 1), members))
    colours = patch_colours(form.patches, faces)
    record["colours"] = [
        _write_colours(mesh, FIELD_COLOURS, ramp(np.log(form.adf))),
        _write_colours(mesh, PATCH_COLOURS, colours[form.patches]),
    ]
    mesh[RECORD] = json.dumps(record)
    _restore_selection(obj, record["before"])
    if record["before"]["shape_key"] is None:
        obj.active_shape_key_index = mesh.shape_keys.key_blocks.find(record["shape_key"])
    if record["before"]["colour"] is None:
        mesh.color_attributes.active_color_name = record["colours"][1]
    mesh.update()


def clear_results(obj: bpy.types.Object) -> bool:
    """Remove from a mesh exactly what the last run wrote.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode.

    Returns
    -------
    bool
        Whether there was anything to remove.
    """
    mesh = obj.data
    record = record_of(mesh)
    if record is None:
        return False
    chosen = _selection(obj)
    keys = mesh.shape_keys
    if keys is not None:
        key = keys.key_blocks.get(record["shape_key"])
        if key is not None and key != keys.reference_key:
            obj.shape_key_remove(key)
        if record["basis"] is not None and len(keys.key_blocks) == 1:
            obj.shape_key_clear()  # the Basis was ours too
    for name in record["groups"]:
        group = obj.vertex_groups.get(name)
        if group is not None:
            obj.vertex_groups.remove(group)
    for name in record["colours"]:
        attribute = mesh.color_attributes.get(name)
        if attribute is not None:
            mesh.color_attributes.remove(attribute)
    del mesh[RECORD]
    for kind, ours in (("shape_key", [record["shape_key"], record["basis"]]), ("group", record["groups"])):
        if chosen[kind] in ours:
            chosen[kind] = record["before"][kind]
    for kind in ("colour", "render_colour"):
        if chosen[kind] in record["colours"]:
            chosen[kind] = record["before"][kind]
    _restore_selection(obj, chosen)
    mesh.update()
    return True


def _write_shape_key(obj: bpy.types.Object, vertices: FloatArray, value: float) -> str:
    key = obj.shape_key_add(name=SHAPE_KEY, from_mix=False)
    key.relative_key = obj.data.shape_keys.reference_key
    key.data.foreach_set("co", vertices.astype(np.float32).ravel())
    key.value = value
    return key.name


def _write_group(obj: bpy.types.Object, name: str, members: IntArray) -> str:
    group = obj.vertex_groups.new(name=name)
    group.add(members.tolist(), 1.0, "REPLACE")
    return group.name


def _write_colours(mesh: bpy.types.Mesh, name: str, colours: FloatArray) -> str:
    attribute = mesh.color_attributes.new(name=name, type="FLOAT_COLOR", domain="POINT")
    attribute.data.foreach_set("color", colours.astype(np.float32).ravel())
    return attribute.name


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
