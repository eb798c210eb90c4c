"""A result made the mesh's own shape, or a new object of what it shows."""

from __future__ import annotations

import json

import bpy

from ...core import CanonicalFormError
from ..mesh_items.fingerprints import key_fingerprint
from ..mesh_items.key_points import key_points
from ..objects.movers import armature_of
from ..objects.object_states import object_mode
from ..records.form_key import form_key, require_form_key
from ..records.record import read_record, require_record
from ..records.rig_record import read_rig
from ..records.stored_values import named, words
from ..words.wording import told
from .bare_copies import drop_own_properties
from .companions import companions_of
from .in_betweens import animated, has_in_betweens, remove_in_betweens
from .new_basis import make_basis
from .new_objects import drop_results, linked_beside
from .result_clearing import clear_results
from .result_writing import key_name
from .variants import shown_value

POSED = "Posed"  # the key that keeps the shape from before
KEPT_PROPERTY = "canonical_form_kept"  # of a mesh: fingerprints of these keys, by name
_FULL = 0.999  # value of a slider from which a result is shown in full


def keep_refusal(obj: bpy.types.Object | None) -> str | None:
    """Return why the result of an object cannot become its own shape.

    Parameters
    ----------
    obj : bpy.types.Object or None
        The object.

    Returns
    -------
    str or None
        A sentence that names the remedy; None if it can.
    """
    record = read_record(obj.data) if obj is not None and obj.type == "MESH" else None
    if obj is None or record is None or form_key(obj.data) is None or len(record.keys) > 1:
        return told("There is no shape key of a form or a pose to keep.")
    if read_rig(obj.data) is not None:
        return told("Rig has made an armature for it: keep its rest instead, or remove it first.")
    sharing = [each for each in bpy.data.objects if each.data == obj.data]
    moved = [each.name for each in sharing if armature_of(each) is not None]
    if record.report.frame is not None or moved:
        name = next(iter(moved), obj.name)
        return told("A rig or modifiers move {name}, and would move the new shape again. Use New Object.", name=name)
    key = require_form_key(obj.data)
    if key.mute or key.vertex_group or shown_value(obj.data) < _FULL:
        return told("The result is not shown in full: set its slider to 1 first. New Object copies what you see.")
    return animated(obj.data) if not has_in_betweens(obj.data) else None


def keep_form(obj: bpy.types.Object) -> tuple[str, list[str]]:
    """Make the form or the pose of a body its own shape: a new Basis. The shape from before stays as a shape key.

    Parameters
    ----------
    obj : bpy.types.Object
        An object of the body.

    Returns
    -------
    name : str
        The key of `obj` that keeps the shape from before.
    left : list of str
        Names of results that stay because they may contain changes by the user.

    Raises
    ------
    CanonicalFormError
        If it cannot; nothing is changed then.
    """
    body = companions_of(obj)
    for each in body:
        reason = keep_refusal(each)
        if reason is not None:
            raise CanonicalFormError(reason)
    names, left = {}, []
    with object_mode(obj):
        for each in body:
            names[each], more = _keep(each)
            left += more
    return names[obj], left


def _keep(obj: bpy.types.Object) -> tuple[str, list[str]]:
    """Make the key of one object its Basis, in Object Mode."""
    mesh, record = obj.data, require_record(obj.data)
    left = remove_in_betweens(obj)
    key, before = require_form_key(mesh), key_points(mesh.shape_keys.reference_key)
    posed = obj.shape_key_add(name=POSED, from_mix=False)
    posed.relative_key, posed.value = mesh.shape_keys.reference_key, 0.0
    posed.points.foreach_set("co", before.ravel())
    name = posed.name
    kept = _kept_before(mesh)
    make_basis(obj, key, {name, *kept})
    prints = {each: key_fingerprint(mesh.shape_keys.key_blocks[each]) for each in (*kept, name)}
    mesh[KEPT_PROPERTY] = json.dumps(prints)
    record.keys.clear()
    return name, left + clear_results(obj)


def _kept_before(mesh: bpy.types.Mesh) -> list[str]:
    """Return the keys that earlier calls have added, renamed or not: shapes of their own, which stay where they are."""
    text = mesh.get(KEPT_PROPERTY)
    try:
        prints = named(words, json.loads(text)) if isinstance(text, str) else {}
    except (ValueError, TypeError, RecursionError):  # from a stranger's file
        prints = {}
    keys = mesh.shape_keys.key_blocks if prints else ()
    return [key.name for key in keys if key_fingerprint(key) in prints.values() or prints.get(key.name)]


def copy_of_shown(obj: bpy.types.Object) -> list[bpy.types.Object]:
    """Add objects that are shaped as a body is shown, with its materials and groups, without keys and modifiers.

    Parameters
    ----------
    obj : bpy.types.Object
        An object of the body.

    Returns
    -------
    list of bpy.types.Object
        The new objects, the one of `obj` first.
    """
    body = companions_of(obj)
    with object_mode(obj):
        graph = bpy.context.evaluated_depsgraph_get()
        return [_copy_of(each, graph) for each in sorted(body, key=lambda each: each != obj)]


def _copy_of(obj: bpy.types.Object, graph: bpy.types.Depsgraph) -> bpy.types.Object:
    """Add an object with the mesh that another one shows."""
    shown = obj.evaluated_get(graph)
    mesh = bpy.data.meshes.new_from_object(shown, preserve_all_data_layers=True, depsgraph=graph)
    added = linked_beside(obj, mesh, f"{obj.name} {key_name(require_record(obj.data).report)}")
    drop_results(added, read_record(obj.data))
    drop_own_properties(mesh)
    return added
