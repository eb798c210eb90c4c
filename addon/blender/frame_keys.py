"""Forms of several frames side by side: a shape key each, keyed to show at its frame."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from .form_key import form_key


def keep_for_frame(obj: bpy.types.Object, frame: int, frames: Sequence[int]) -> None:
    """Name the shape key of a form after its frame, and key its value there, and 0 at the frames before and after.

    A key of another name stays when the next form is written.

    Parameters
    ----------
    obj : bpy.types.Object
        The object with the form.
    frame : int
        The frame that it is of.
    frames : sequence of int
        All frames, rising.
    """
    key = form_key(obj.data)
    if key is None:
        return
    key.name = f"{key.name} {frame}"
    number, value = list(frames).index(frame), key.value
    for other in frames[max(number - 1, 0) : number + 2]:
        key.value = value if other == frame else 0.0
        key.keyframe_insert("value", frame=other)
    key.value = value
