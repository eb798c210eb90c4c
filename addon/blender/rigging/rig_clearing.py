"""Takes an armature that was given to bodies away again, with what binds them to it, and nothing else."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np
from mathutils import Matrix

from ..mesh_items.active_items import active_items, existing_items, restore_active_items
from ..mesh_items.fingerprints import group_fingerprints, key_fingerprint
from ..mesh_items.key_points import key_points
from ..mesh_items.key_removal import remove_all_keys, remove_drivers
from ..objects.object_states import object_mode
from ..records.form_key import form_key
from ..records.record import read_record, write_record
from ..records.rig_record import RigRecord, read_rig, recorded_key, remove_rig_record
from .made_data import MARK, PART, action_fingerprint, armature_fingerprint, made_by

_SHOWING = (  # what holds or shows data, such as the Outliner, and is none of the user's work with it
    bpy.types.Scene,
    bpy.types.Collection,
    bpy.types.Screen,
    bpy.types.WorkSpace,
    bpy.types.WindowManager,
)
_BASIS = "Basis"  # as Blender calls it


def armature_given_to(obj: bpy.types.Object) -> bpy.types.Object | None:
    """Find the armature that an object was given.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, of type MESH.

    Returns
    -------
    bpy.types.Object or None
        The armature of its modifier; None if there is none any more.
    """
    record = read_rig(obj.data)
    held = [each.object for each in obj.modifiers if each.type == "ARMATURE" and each.object is not None]
    return next((each for each in held if record is not None and each.get(MARK) == record.token), None)


def bound_to(armature: bpy.types.Object) -> list[bpy.types.Object]:
    """List the objects that were given an armature.

    Parameters
    ----------
    armature : bpy.types.Object
        The armature.

    Returns
    -------
    list of bpy.types.Object
        The objects of this file.
    """
    meshes = [each for each in bpy.data.objects if each.type == "MESH" and each.library is None]
    return [each for each in meshes if each.data.library is None and armature_given_to(each) == armature]


def release(objects: Sequence[bpy.types.Object]) -> list[str]:
    """Take the armature away from objects; if nothing else uses it and nobody has changed it, it is removed.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        The objects, each with a record.

    Returns
    -------
    list of str
        Names of what stays because it may contain changes by the user.

    Raises
    ------
    CanonicalFormError
        If Blender cannot leave the mode of an object.
    """
    given = [(obj, record, armature_given_to(obj)) for obj in objects if (record := read_rig(obj.data)) is not None]
    left: list[str] = []
    for obj, record, armature in given:
        with object_mode(obj):
            left += unbind(obj, record, armature, unconfirmed=False)
    rigs = {armature.name: (armature, record) for _, record, armature in given if armature is not None}
    for name, (armature, record) in rigs.items():
        if not bound_to(armature):
            if armature.mode == "EDIT":  # the bones are not up to date
                bpy.ops.object.mode_set(mode="OBJECT")
            if armature_fingerprint(armature) == record.armature and _is_unused(armature):
                left += _remove(armature, record)
            else:
                left.append(name)
    for record in {record.token: record for _, record, armature in given if armature is None}.values():
        left += _remove(None, record)
    return list(dict.fromkeys(left))


def _is_unused(armature: bpy.types.Object) -> bool:
    """Return whether nothing of the user's refers to an armature: children, constraints, drivers, actions."""
    users, token = bpy.data.user_map(subset={armature, armature.data}), armature[MARK]
    data = armature.animation_data
    own = data is None or data.action is None or data.action.get(MARK) == token + PART
    others = [each for each in users[armature] if not isinstance(each, _SHOWING)]
    return own and all(each.get(MARK) in (token, token + PART) for each in [*others, *users[armature.data]])


def _remove(armature: bpy.types.Object | None, record: RigRecord) -> list[str]:
    """Remove what was made with an armature; actions that the user has changed or uses stay."""
    made, left = made_by(record.token), []
    if any(each[MARK] == record.token and each != armature for each in made):
        made = [] if armature is None else [armature]  # a copy of it lives, with poses and all
    keep = []
    for action in [each for each in made if isinstance(each, bpy.types.Action)]:
        users = bpy.data.user_map(subset={action})[action] - {armature}
        users = {each for each in users if not isinstance(each, _SHOWING)}
        if users or action_fingerprint(action) not in record.actions.values():
            keep.append(action)
            left += [] if users else [action.name]
    bpy.data.batch_remove([each for each in made if each not in keep])
    return left


def unbind(
    obj: bpy.types.Object, record: RigRecord, armature: bpy.types.Object | None, *, unconfirmed: bool
) -> list[str]:
    """Remove from an object what binds it.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode.
    record : RigRecord
        Its record.
    armature : bpy.types.Object or None
        The armature; None if it was deleted.
    unconfirmed : bool
        Whether to remove what has changed since, too: after a failed run.

    Returns
    -------
    list of str
        Names of what stays because it may contain changes by the user.
    """
    active, left = active_items(obj), []
    for modifier in [each for each in obj.modifiers if each.type == "ARMATURE"]:
        if modifier.object == armature:  # or None, where that was deleted
            obj.modifiers.remove(modifier)
    if record.inverse is not None and obj.parent == armature:  # or None, the same
        obj.parent = None
        obj.matrix_parent_inverse = Matrix(np.reshape(record.inverse, (4, 4)).tolist())
    prints = group_fingerprints(obj, record.groups)
    for name, known in record.groups.items():
        if name in prints and (unconfirmed or prints[name] == known):
            obj.vertex_groups.remove(obj.vertex_groups[name])
        elif name in prints:
            left.append(name)
    found = [(name, known, recorded_key(obj.data, name, known)) for name, known in record.keys.items()]
    ours = [
        key
        for name, known, key in found
        if key is not None and key.name == name and (unconfirmed or key_fingerprint(key) == known)
    ]
    for _, _, key in reversed(found):
        if key is None:
            continue
        others = [each for each in key.id_data.key_blocks if each.relative_key == key and each not in (key, *ours)]
        if key in ours and not others:
            remove_drivers(key)
            ours.remove(key)
            obj.shape_key_remove(key)
        else:  # renamed or changed, it is the user's
            left.append(key.name)
            key.value = 0.0  # the bones are gone for which it was on
    if record.basis and _has_bare_basis(obj.data):
        remove_all_keys(obj)
    elif record.basis:
        _hand_over_basis(obj.data)
    form = form_key(obj.data)
    if record.slider is not None and form is not None and form.value == 0.0:
        form.value = record.slider
    remove_rig_record(obj.data)
    restore_active_items(obj, active.kept(existing_items(obj), otherwise=active_items(obj)))
    obj.data.update()
    return left


def _hand_over_basis(mesh: bpy.types.Mesh) -> None:
    """Let the form remove the Basis that the rig has added, as its key still needs it."""
    form = read_record(mesh)
    basis = None if mesh.shape_keys is None else mesh.shape_keys.reference_key
    if form is not None and form.basis is None and basis is not None and basis.name == _BASIS:
        form.basis, form.basis_fingerprint = basis.name, key_fingerprint(basis)
        write_record(mesh, form)


def _has_bare_basis(mesh: bpy.types.Mesh) -> bool:
    """Return whether the only shape key is a Basis that says nothing that the mesh does not."""
    keys = mesh.shape_keys
    if keys is None or len(keys.key_blocks) != 1 or keys.reference_key.name != _BASIS:
        return False
    points = np.empty((len(mesh.vertices), 3), dtype=np.float32)
    mesh.vertices.foreach_get("co", points.ravel())
    return bool(np.array_equal(points, key_points(keys.reference_key)))
