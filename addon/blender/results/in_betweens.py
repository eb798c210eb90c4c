"""Shape keys between the pose and the form, driven by one property: limbs unbend as if at joints."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ...core import CanonicalFormError
from ..mesh_items.action_curves import curve_lists, curves_of
from ..mesh_items.fingerprints import key_fingerprint
from ..mesh_items.slider import is_following, is_unused
from ..records.form_key import form_key, require_form_key
from ..records.record import InBetweens, read_record, require_record, write_record
from ..words.wording import told

if TYPE_CHECKING:
    from ...core.numerics.arrays import FloatArray

PROPERTY = "Pose to Form"  # on the shape keys' data-block, which is copied and linked along with the keys
IN_BETWEEN = "{} {:.0%}"  # name of the form's key, and the fraction of the way from pose to form
_EXPRESSION = "max(0, 1 - abs(s * {} - {}))"  # a simple expression: Blender evaluates it without Python


def fractions_between(count: int) -> list[float]:
    """Return the fractions of the way from pose to form at which the in-between keys are.

    Parameters
    ----------
    count : int
        Number of keys.

    Returns
    -------
    list of float
        Equal steps, without the ends 0 and 1.
    """
    return [number / (count + 1) for number in range(1, count + 1)]


def write_in_betweens(obj: bpy.types.Object, shapes: list[FloatArray]) -> None:
    """Write keys between pose and form, replacing earlier ones, and drive all keys by one property.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode; the form's key is unchanged and not animated.
    shapes : list of (n, 3) ndarray of float
        Positions at equal steps between pose and form, without the ends.

    Raises
    ------
    CanonicalFormError
        If the user has animated the form's key or given it a driver.
    """
    mesh = obj.data
    remove_in_betweens(obj)
    refusal = animated(mesh)
    if refusal is not None:
        raise CanonicalFormError(refusal)
    keys, form = mesh.shape_keys, require_form_key(mesh)
    record = require_record(mesh)
    record.in_betweens = InBetweens(keys={}, animated_before=keys.animation_data is not None, value=form.value)
    steps = len(shapes) + 1
    active = obj.active_shape_key_index
    keys[PROPERTY] = form.value
    keys.id_properties_ui(PROPERTY).update(
        min=0.0, max=1.0, soft_min=0.0, soft_max=1.0, subtype="FACTOR", description="0 is the pose, 1 the form"
    )
    for number, positions in enumerate([*shapes, None], start=1):
        key = form
        if positions is not None:
            key = obj.shape_key_add(name=IN_BETWEEN.format(form.name, number / steps), from_mix=False)
            key.relative_key = form.relative_key
            key.points.foreach_set("co", positions.astype(np.float32).ravel())
            record.in_betweens.keys[key.name] = key_fingerprint(key)
        _drive(key, keys, _EXPRESSION.format(steps, number))
    obj.active_shape_key_index = active
    write_record(mesh, record)
    keys.update_tag()
    mesh.update()


def remove_in_betweens(obj: bpy.types.Object) -> list[str]:
    """Remove the keys between pose and form, their drivers and the property.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode.

    Returns
    -------
    list of str
        Names of keys that stay because they have been changed since they were written.
    """
    mesh = obj.data
    record, keys = read_record(mesh), mesh.shape_keys
    if record is None or record.in_betweens is None:
        return []
    left = []
    if keys is not None:
        active = obj.active_shape_key
        active_name = active.name if active else None
        value = keys.get(PROPERTY, record.in_betweens.value)
        _remove_own_drivers(keys, value, steps=len(record.in_betweens.keys) + 1)
        for name, known in record.in_betweens.keys.items():
            key = keys.key_blocks.get(name)
            if key is None:
                continue
            if known == key_fingerprint(key):
                obj.shape_key_remove(key)
            else:
                left.append(name)
        form = form_key(mesh)
        if form is not None:
            form.value = value
        if PROPERTY in keys:
            del keys[PROPERTY]
        data = keys.animation_data
        if data is not None and is_unused(data) and not record.in_betweens.animated_before:
            keys.animation_data_clear()
        if active_name in keys.key_blocks:
            obj.active_shape_key_index = keys.key_blocks.find(active_name)
    record.in_betweens = None
    write_record(mesh, record)
    mesh.update()
    return left


def renamed_keys(mesh: bpy.types.Mesh) -> bool:
    """Return whether the form's key or an in-between key has been renamed or removed while one property drives them.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.

    Returns
    -------
    bool
        True if so; only names are compared, so a panel can call this.
    """
    record = read_record(mesh)
    if record is None or not has_in_betweens(mesh):
        return False
    return any(name not in mesh.shape_keys.key_blocks for name in (*record.keys, *record.in_between_keys))


def changed_in_betweens(mesh: bpy.types.Mesh) -> list[str]:
    """Return the keys between pose and form that have been changed since they were written.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.

    Returns
    -------
    list of str
        Their names.
    """
    record, keys = read_record(mesh), mesh.shape_keys
    if record is None or keys is None:
        return []
    blocks = keys.key_blocks
    return [
        name
        for name, known in record.in_between_keys.items()
        if name in blocks and known != key_fingerprint(blocks[name])
    ]


def has_in_betweens(mesh: bpy.types.Mesh) -> bool:
    """Return whether there are keys between pose and form.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.

    Returns
    -------
    bool
        True if the property drives them.
    """
    record = read_record(mesh)
    recorded = record is not None and record.in_betweens is not None
    return recorded and mesh.shape_keys is not None and PROPERTY in mesh.shape_keys


def animated(mesh: bpy.types.Mesh) -> str | None:
    """Return why no driver can be added to the form's key: the user has animated it or given it a driver.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.

    Returns
    -------
    str or None
        A sentence that names the remedy; None if a driver can be added.
    """
    keys, form = mesh.shape_keys, form_key(mesh)
    if keys is not None and PROPERTY in keys and not has_in_betweens(mesh):
        return told(
            "The shape keys of {name} have a property {property} of your own. Rename it, then add in-betweens.",
            name=mesh.name,
            property=PROPERTY,
        )
    if form is not None and is_animated(keys, value_path(form)):
        return told(
            "The shape key {name} of {mesh} is animated or driven. Remove its animation first, then add in-betweens.",
            name=form.name,
            mesh=mesh.name,
        )
    return None


def slider_path(mesh: bpy.types.Mesh) -> str:
    """Return the path of the property of the shape keys that moves the form.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.

    Returns
    -------
    str
        Path of the value of the form's key, or of the property that drives it.
    """
    form = form_key(mesh)
    return f'["{PROPERTY}"]' if has_in_betweens(mesh) or form is None else value_path(form)


def animated_slider(mesh: bpy.types.Mesh) -> bool:
    """Return whether the user has animated the slider of a form or given it a driver.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.

    Returns
    -------
    bool
        True if so; drivers of this extension do not count.
    """
    return form_key(mesh) is not None and is_animated(mesh.shape_keys, slider_path(mesh))


def value_path(key: bpy.types.ShapeKey) -> str:
    """Return the path of the value of a shape key.

    Parameters
    ----------
    key : bpy.types.ShapeKey
        The key.

    Returns
    -------
    str
        The path, from the shape keys' data-block.
    """
    return f'key_blocks["{bpy.utils.escape_identifier(key.name)}"].value'


def remove_keyframes(key: bpy.types.ShapeKey) -> None:
    """Remove the keyframes of the value of a shape key.

    Parameters
    ----------
    key : bpy.types.ShapeKey
        The key.
    """
    for curves in _own_curves(key.id_data):
        for curve in curves:
            if curve.data_path == value_path(key):
                curve.keyframe_points.clear()


def remove_curves(key: bpy.types.ShapeKey) -> None:
    """Remove the F-curves of the value of a shape key.

    Parameters
    ----------
    key : bpy.types.ShapeKey
        The key.
    """
    for curves in _own_curves(key.id_data):
        for curve in [each for each in curves if each.data_path == value_path(key)]:
            curves.remove(curve)


def is_animated(keys: bpy.types.Key, path: str) -> bool:
    """Return whether the user has animated a property of shape keys or given it a driver.

    Parameters
    ----------
    keys : bpy.types.Key
        The shape keys.
    path : str
        Path of the property.

    Returns
    -------
    bool
        True if so; drivers of this extension do not count.
    """
    if keys.animation_data is None:
        return False
    drivers = keys.animation_data.drivers
    curves = [curve for curve in drivers if not (is_following(curve) or _is_own_driver(curve, keys))]
    actions = [keys.animation_data.action]
    actions += [strip.action for track in keys.animation_data.nla_tracks for strip in track.strips]
    for action in actions:
        curves += [] if action is None else curves_of(action)
    return any(curve.data_path == path for curve in curves)


def _drive(key: bpy.types.ShapeKey, keys: bpy.types.Key, expression: str) -> None:
    """Add a driver to the value of a key, with an expression in which `s` is the property."""
    driver = key.driver_add("value").driver
    driver.type = "SCRIPTED"
    variable = driver.variables.new()
    variable.name = "s"
    variable.targets[0].id_type = "KEY"
    variable.targets[0].id = keys
    variable.targets[0].data_path = f'["{PROPERTY}"]'
    driver.expression = expression


def _remove_own_drivers(keys: bpy.types.Key, value: float, steps: int) -> None:
    """Remove the drivers that `_drive` added; the form's key, even if renamed, gets `value`, the others 0."""
    own = [curve for curve in keys.animation_data.drivers if _is_own_driver(curve, keys)] if keys.animation_data else []
    last = _EXPRESSION.format(steps, steps)  # that of the form's key, which the user may have removed
    for curve in own:
        with suppress(ValueError):  # the key was removed
            key = keys.path_resolve(curve.data_path.rpartition(".")[0])
            key.value = value if curve.driver.expression == last else 0.0
        keys.animation_data.drivers.remove(curve)


def _is_own_driver(curve: bpy.types.FCurve, keys: bpy.types.Key) -> bool:
    """Return whether a driver is one that `_drive` added."""
    reads_property = any(
        each.targets[0].id == keys and each.targets[0].data_path == f'["{PROPERTY}"]' for each in curve.driver.variables
    )
    return reads_property and curve.driver.expression.startswith(_EXPRESSION.split("{")[0])


def _own_curves(keys: bpy.types.Key) -> list[bpy.types.ActionFCurves]:
    """Return the F-curves of the action of shape keys, without those of other data-blocks that use the action."""
    data = keys.animation_data
    slot = getattr(data, "action_slot_handle", None)
    return [] if data is None or data.action is None else curve_lists(data.action, slot)
