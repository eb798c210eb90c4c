"""Temporary states of an object: its mode, and the keys of an earlier run."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager

import bpy

from ...core import CanonicalFormError
from ..records.record import read_record
from ..words.wording import told


@contextmanager
def object_mode(obj: bpy.types.Object) -> Iterator[None]:
    """Switch to Object Mode and restore the mode afterwards, even after an error.

    Parameters
    ----------
    obj : bpy.types.Object
        The object; if it is in another mode, it must be the active object.

    Yields
    ------
    None
        Control, with the object in Object Mode.

    Raises
    ------
    CanonicalFormError
        If Blender cannot leave the object's mode.
    """
    mode = obj.mode
    if mode == "OBJECT":
        yield
        return
    if not obj.visible_get():
        raise CanonicalFormError(
            told("{name} is hidden and in another mode. Show it, or leave its mode, and run again.", name=obj.name)
        )
    layer = bpy.context.view_layer
    in_mode = [other for other in layer.objects if other.mode == mode]  # Blender can edit several objects at once
    selected = [other for other in layer.objects if other.select_get()]
    try:
        bpy.ops.object.mode_set(mode="OBJECT")
    except RuntimeError as error:
        raise CanonicalFormError(
            told("{name} cannot leave its mode. Switch to Object Mode and run again.", name=obj.name)
        ) from error
    try:
        yield
    finally:
        if mode == "EDIT":  # Blender enters Edit Mode with the selected objects
            for other in layer.objects:
                other.select_set(other in in_mode)
        bpy.ops.object.mode_set(mode=mode)
        if mode == "EDIT":
            for other in layer.objects:
                other.select_set(other in selected)


@contextmanager
def muted_results(meshes: Iterable[bpy.types.Mesh]) -> Iterator[None]:
    """Mute the shape keys of earlier runs, so that the form is computed from the pose and not from an earlier form.

    Parameters
    ----------
    meshes : iterable of bpy.types.Mesh
        The meshes.

    Yields
    ------
    None
        Control, while the keys are muted.
    """
    keys = []
    for mesh in meshes:
        record, blocks = read_record(mesh), mesh.shape_keys.key_blocks if mesh.shape_keys else {}
        names = [] if record is None else [*record.keys, *record.in_between_keys]
        keys += [blocks[name] for name in names if name in blocks]
    muted = [key.mute for key in keys]
    try:
        for key in keys:
            key.mute = True
        bpy.context.view_layer.update()
        yield
    finally:
        for key, mute in zip(keys, muted, strict=True):
            key.mute = mute
        bpy.context.view_layer.update()
