"""Writes results to a mesh and takes exactly those away again."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import bpy
import numpy as np

from .in_betweens import remove_in_betweens
from .records import (
    RECORD,
    clear_keys,
    colour_print,
    drop_drivers,
    fingerprint,
    free_name,
    group_prints,
    keep_record,
    key_print,
    members_print,
    own_key,
    record_of,
    required_key,
    required_record,
    restore_selection,
    restore_twins,
    selection_of,
    twins_of,
)

if TYPE_CHECKING:
    from ..core import CanonicalForm, FeaturePatches
    from ..core.numerics.arrays import FloatArray, IntArray
    from .palette import Colours

SHAPE_KEY = "Canonical Form"
FEATURE_GROUP = "Feature Points"
PATCH_GROUP = "Patch {}"
FIELD_COLOURS = "Auto Diffusion Function"
PATCH_COLOURS = "Patches"
HIDDEN_FORM = ".canonical_form"  # the whole form, while the shape key may hold that of some limbs only
HIDDEN_PATCHES = ".canonical_form_patch"


def write_results(
    obj: bpy.types.Object,
    found: CanonicalForm | FeaturePatches,
    colours: Colours,
    value: float,
    report: dict[str, Any],
    patches: bool = True,
) -> None:
    """Write what was found to a mesh as shape key, vertex groups and colours, in place of an earlier result.

    The shape key of an earlier run is kept and filled anew, so that animation, drivers and other keys that hang on it
    stay. If anything goes wrong, what has been written so far is removed again.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode. Objects that share its mesh show the results too.
    found : CanonicalForm or FeaturePatches
        The form and what was found on the way, or the latter only.
    colours : Colours
        What is shown of it.
    value : float
        Value of the shape key, 0 to 1.
    report : dict
        What the panel shows; kept with the record as JSON.
    patches : bool
        Whether the patches are written, or the feature points only.
    """
    from ..core import CanonicalForm

    mesh = obj.data
    form = found.vertices if isinstance(found, CanonicalForm) else None
    old, now, twins = record_of(mesh), selection_of(obj), twins_of(obj)
    kept_key = own_key(mesh) if form is not None else None
    record: dict[str, Any] = {"report": report, "before": dict(now), "basis": None, "key": {}}
    record |= {"groups": {}, "colours": {}, "hidden": {}, "palette": []}
    if old is not None:
        if kept_key is not None:
            record["basis"], record["basis_print"] = old["basis"], old.get("basis_print")
        for kind, ours in _ours(old).items():
            if now[kind] in ours:
                record["before"][kind] = old["before"][kind]
        _remove(obj, old, keep_key=kept_key is not None)
    done = False
    try:
        if form is not None:
            if mesh.shape_keys is None:
                basis = obj.shape_key_add(name="Basis", from_mix=False)
                record["basis"], record["basis_print"] = basis.name, key_print(basis)
            key = kept_key or obj.shape_key_add(name=SHAPE_KEY, from_mix=False)
            record["key"][key.name] = None
            if kept_key is None:
                key.relative_key = mesh.shape_keys.reference_key
            key.data.foreach_set("co", form.astype(np.float32).ravel())
            key.value = value
            record["key"][key.name] = key_print(key)
        fields = [(FIELD_COLOURS, colours.field)]
        members = [found.feature_points]
        if patches:
            members += [np.flatnonzero(found.patches == index) for index in range(len(found.feature_points))]
            record["palette"] = colours.palette
            fields.append((PATCH_COLOURS, colours.patches))
        for number, vertices in enumerate(members):
            group = obj.vertex_groups.new(name=PATCH_GROUP.format(number) if number else FEATURE_GROUP)
            record["groups"][group.name] = None
            group.add(vertices.tolist(), 1.0, "REPLACE")
            record["groups"][group.name] = members_print(np.sort(vertices), np.ones(len(vertices)))
        for name, field in fields:
            attribute = mesh.color_attributes.new(name=free_name(obj, name), type="FLOAT_COLOR", domain="POINT")
            record["colours"][attribute.name] = None
            attribute.data.foreach_set("color", field.ravel())
            record["colours"][attribute.name] = colour_print(attribute)
        shown = attribute.name
        if patches:
            _write_hidden(mesh, record, HIDDEN_PATCHES, "INT", "value", found.patches.astype(np.int32))
        if form is not None and patches:
            _write_hidden(mesh, record, HIDDEN_FORM, "FLOAT_VECTOR", "vector", form.astype(np.float32))
        done = True
    finally:
        keep_record(mesh, record)
        if not done:
            clear_results(obj)
    there = {
        "shape_key": mesh.shape_keys.key_blocks.keys() if mesh.shape_keys is not None else [],
        "group": obj.vertex_groups.keys(),
        "colour": mesh.color_attributes.keys(),
        "render_colour": mesh.color_attributes.keys(),
    }
    restore_selection(
        obj, {kind: now[kind] if now[kind] in names else record["before"][kind] for kind, names in there.items()}
    )
    if form is not None and now["shape_key"] is None:
        obj.active_shape_key_index = mesh.shape_keys.key_blocks.find(key.name)
    if now["colour"] is None or record["before"]["colour"] is None:
        mesh.color_attributes.active_color_name = shown
    restore_twins(twins)
    mesh.update()


def refill_key(obj: bpy.types.Object, positions: FloatArray) -> None:
    """Fill the shape key of the last run with other positions.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode, with a key of ours that is unchanged.
    positions : (n, 3) ndarray of float
        The positions.
    """
    mesh = obj.data
    key, record = required_key(mesh), required_record(mesh)
    key.data.foreach_set("co", positions.astype(np.float32).ravel())
    record["key"][key.name] = key_print(key)
    keep_record(mesh, record)
    mesh.update()


def recolour_patch(mesh: bpy.types.Mesh, number: int, colour: tuple[float, float, float]) -> None:
    """Give a patch another colour, where the colours are still those of the last run.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh, with its objects not in Edit Mode; nothing is done in Edit Mode.
    number : int
        Number of the patch, from 0.
    colour : tuple of float
        Linear red, green and blue.
    """
    record, patches = record_of(mesh), patches_of(mesh)
    if record is None or patches is None or number >= len(record["palette"]):
        return
    if np.allclose(record["palette"][number], colour, atol=1e-5):
        return
    for name, known in record["colours"].items():
        attribute = mesh.color_attributes.get(name)
        if attribute is None or known != colour_print(attribute) or attribute.name.startswith(FIELD_COLOURS):
            continue
        values = np.empty(4 * len(attribute.data), dtype=np.float32)
        attribute.data.foreach_get("color", values)
        values.reshape(-1, 4)[patches == number, :3] = colour
        attribute.data.foreach_set("color", values)
        record["colours"][name] = colour_print(attribute)
    record["palette"][number] = list(colour)
    keep_record(mesh, record)
    mesh.update()


def patches_of(mesh: bpy.types.Mesh) -> IntArray | None:
    """Read the patch of every vertex, as the last run wrote it.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh, with its objects in Object Mode.

    Returns
    -------
    (n,) ndarray of int or None
        Numbers of the patches from 0; None where they are not known.
    """
    values = _hidden(mesh, HIDDEN_PATCHES, "INT", "value", np.int32)
    return None if values is None else values.astype(np.int64)


def whole_form_of(mesh: bpy.types.Mesh) -> FloatArray | None:
    """Read the form of the last run, whichever limbs the shape key shows it on.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh, with its objects in Object Mode.

    Returns
    -------
    (n, 3) ndarray of float or None
        Positions in the mesh's own space; None where they are not known.
    """
    values = _hidden(mesh, HIDDEN_FORM, "FLOAT_VECTOR", "vector", np.float32)
    return None if values is None else values.reshape(-1, 3).astype(np.float64)


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
    chosen, ours, twins = selection_of(obj), _ours(record), twins_of(obj)
    left = _remove(obj, record)
    for kind, names in ours.items():
        if chosen[kind] in names and chosen[kind] not in left:
            chosen[kind] = record["before"][kind]
    restore_selection(obj, chosen)
    restore_twins(twins)
    mesh.update()
    return left


def _remove(obj: bpy.types.Object, record: dict[str, Any], keep_key: bool = False) -> list[str]:
    """Remove what still is as the record says and list what is not; a print of None is that of a run cut short."""
    mesh = obj.data
    left = remove_in_betweens(obj)
    keys = mesh.shape_keys
    for name, known in record["key"].items():
        key = keys.key_blocks.get(name) if keys is not None else None
        if key is None or keep_key:
            continue
        if key != keys.reference_key and known in (None, key_print(key)):
            drop_drivers(key)
            obj.shape_key_remove(key)
        else:
            left.append(name)
    if keys is not None and not keep_key and len(keys.key_blocks) == 1 and _is_own_basis(mesh, record):
        clear_keys(obj)
    prints = group_prints(obj, record["groups"])
    for name, known in record["groups"].items():
        if name in prints and known in (None, prints[name]):
            obj.vertex_groups.remove(obj.vertex_groups[name])
        elif name in prints:
            left.append(name)
    for name, known in record["colours"].items():
        attribute = mesh.color_attributes.get(name)
        if attribute is not None and known in (None, colour_print(attribute)):
            mesh.color_attributes.remove(attribute)
        elif attribute is not None:
            left.append(name)
    for name in record.get("hidden", {}):
        if name in mesh.attributes:
            mesh.attributes.remove(mesh.attributes[name])
    del mesh[RECORD]
    return left


def _ours(record: dict[str, Any]) -> dict[str, list[str | None]]:
    """List what was written, by the kinds of `selection_of`."""
    return {
        "shape_key": [*record["key"], *record.get("between", {}), record["basis"]],
        "group": [*record["groups"]],
        "colour": [*record["colours"]],
        "render_colour": [*record["colours"]],
    }


def _is_own_basis(mesh: bpy.types.Mesh, record: dict[str, Any]) -> bool:
    """Tell whether the Basis is the one that we added, unchanged, so that nothing is lost with it."""
    basis = mesh.shape_keys.reference_key
    points = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    mesh.vertices.foreach_get("co", points)
    known = record.get("basis_print")
    return (
        basis.name == record["basis"] and key_print(basis) == fingerprint(points) and known in (None, key_print(basis))
    )


def _write_hidden(
    mesh: bpy.types.Mesh, record: dict[str, Any], name: str, kind: str, field: str, values: np.ndarray
) -> None:
    """Keep values with the mesh under a name that Blender does not list; only ours begin so."""
    if name in mesh.attributes:
        mesh.attributes.remove(mesh.attributes[name])
    attribute = mesh.attributes.new(name=name, type=kind, domain="POINT")
    record["hidden"][attribute.name] = None
    attribute.data.foreach_set(field, values.ravel())
    record["hidden"][attribute.name] = fingerprint(values)


def _hidden(mesh: bpy.types.Mesh, name: str, kind: str, field: str, dtype: type) -> np.ndarray | None:
    attribute = mesh.attributes.get(name)
    if attribute is None or attribute.data_type != kind or len(attribute.data) != len(mesh.vertices):
        return None
    values: np.ndarray = np.empty(len(attribute.data) * (3 if kind == "FLOAT_VECTOR" else 1), dtype=dtype)
    attribute.data.foreach_get(field, values)
    return values
