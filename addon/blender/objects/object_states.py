"""Temporary states of an object: its mode, the keys of an earlier run, and modifiers that only refine it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from itertools import takewhile

import bpy

from ...core import CanonicalFormError
from ..records.record import read_record
from ..words.wording import told

_REFINING = ("BEVEL", "EDGE_SPLIT", "MULTIRES", "SOLIDIFY", "SUBSURF", "TRIANGULATE", "WELD")


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


@contextmanager
def unrefined(objects: Iterable[bpy.types.Object]) -> Iterator[None]:
    """Switch off the last modifiers, if they only refine a surface, so that a shape key can hold what the others show.

    Parameters
    ----------
    objects : iterable of bpy.types.Object
        The objects, in Object Mode. One whose vertices are still not those of its mesh keeps its modifiers.

    Yields
    ------
    None
        Control, while the modifiers are off.
    """
    layer, switched = bpy.context.view_layer, []
    try:
        for obj in objects:
            shown = [each for each in obj.modifiers if each.show_viewport]
            found = list(takewhile(lambda each: each.type in _REFINING, reversed(shown)))  # others may be bound to them
            for each in found:
                each.show_viewport = False
            switched += found
            if found and _changes_size(obj):
                for each in found:
                    each.show_viewport = True
                    switched.remove(each)
        if switched:
            layer.update()
        yield
    finally:
        for each in switched:
            each.show_viewport = True
        if switched:
            layer.update()


def _changes_size(obj: bpy.types.Object) -> bool:
    """Return whether an object shows another number of vertices than its mesh has."""
    bpy.context.view_layer.update()
    shown = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return len(shown.data.vertices) != len(obj.data.vertices)
