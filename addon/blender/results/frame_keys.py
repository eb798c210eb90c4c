"""Forms of several frames on one object: one shape key per frame, keyframed to show at its frame."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from ..mesh_items.fingerprints import key_fingerprint
from ..records.form_key import form_key
from ..records.record import require_record, write_record
from .in_betweens import remove_keyframes


def keep_for_frame(obj: bpy.types.Object, frame: int, frames: Sequence[int]) -> None:
    """Name the form's shape key after its frame, and keyframe its value there, and 0 at the previous and next frame.

    A renamed key stays when the next form is written. After the last frame the record contains all of them, so that
    they can be cleared.

    Parameters
    ----------
    obj : bpy.types.Object
        The object with the form.
    frame : int
        The frame of the form.
    frames : sequence of int
        All frames, ascending.
    """
    key = form_key(obj.data)
    if key is None:
        return
    base = key.name
    key.name = f"{base} {frame}"
    number, value = list(frames).index(frame), key.value
    key.keyframe_insert("value", frame=frame)  # may find the action of an earlier run, on other frames
    remove_keyframes(key)
    for other in frames[max(number - 1, 0) : number + 2]:
        key.value = value if other == frame else 0.0
        key.keyframe_insert("value", frame=other)
    key.value = value
    if frame == frames[-1]:
        blocks, record = obj.data.shape_keys.key_blocks, require_record(obj.data)
        names = [name for each in frames if (name := f"{base} {each}") in blocks]
        record.keys = {name: key_fingerprint(blocks[name]) for name in names}
        record.keyframed = True
        write_record(obj.data, record)
