"""Objects as they are exported with their rig: the form as a shape key, and nothing else of ours."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import bpy

from ..records.record import read_record
from .bare_copies import drop_own_properties
from .result_clearing import remove_results


@contextmanager
def with_rigs(objects: Sequence[bpy.types.Object], value: float, *, posed: bool) -> Iterator[list[bpy.types.Object]]:
    """Make objects ready for export with what moves them, for a while; their groups and colours of ours are gone.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        The objects, in Object Mode, with their results.
    value : float
        Value of the key with the form.
    posed : bool
        Whether armatures keep their pose: the form was computed in it. Otherwise they are at rest, as the form is.

    Yields
    ------
    list of bpy.types.Object
        The objects, and the armatures and parents that belong to them, all of them selectable.
    """
    for obj in objects:
        _keep_form_only(obj, value)
    together = list(dict.fromkeys([*objects, *(each for obj in objects for each in movers_of(obj))]))
    for each in together:
        _reveal(each)
    armatures = {each.data for each in together if each.type == "ARMATURE"}
    before = {each: each.pose_position for each in armatures}
    try:
        for armature in armatures if not posed else ():
            armature.pose_position = "REST"
        bpy.context.view_layer.update()
        yield together
    finally:
        for armature, position in before.items():
            armature.pose_position = position


def movers_of(obj: bpy.types.Object) -> Iterator[bpy.types.Object]:
    """Yield the armatures of an object's modifiers, and all parents of them and of the object.

    Parameters
    ----------
    obj : bpy.types.Object
        The object.

    Yields
    ------
    bpy.types.Object
        What moves it; some of them more than once.
    """
    heads = [modifier.object for modifier in obj.modifiers if modifier.type == "ARMATURE"]
    for head in [obj.parent, *heads]:
        while head is not None:
            yield head
            head = head.parent


def _keep_form_only(obj: bpy.types.Object, value: float) -> None:
    """Remove all results from an object but the key with the form."""
    record = read_record(obj.data)
    if record is not None:
        remove_results(obj, record, keep_key=True, unconfirmed=True)
        keys = obj.data.shape_keys
        for name in record.keys if keys is not None else ():
            if name in keys.key_blocks and keys.key_blocks[name] != keys.reference_key:
                keys.key_blocks[name].value = value
        obj.show_only_shape_key = False
    for owner in (obj.data, obj.data.shape_keys):
        if owner is not None:
            drop_own_properties(owner)


def _reveal(obj: bpy.types.Object) -> None:
    """Make an object selectable, whatever its collections are."""
    there = bpy.context.scene.collection.objects
    if not any(each == obj for each in there):  # one of its name may be
        there.link(obj)
    obj.hide_viewport = obj.hide_select = False
    obj.hide_set(False)
