"""Shared by all panels of the sidebar: their tab, what they show, sentences over lines, and progress."""

import re
import textwrap
from collections.abc import Collection
from time import perf_counter

import bpy

from ..blender.jobs.meant_objects import meant_object
from ..blender.records.record import Record, read_record
from ..blender.words.wording import told
from .job_operator import OBJECT_OT_canonical_form_cancel
from .reading import OBJECT_OT_canonical_form_read

_USUAL, _SHORTEST = 35, 20  # characters in a line of the sidebar
_CHARACTER, _MARGIN = 6.4, 55  # width of a character, and of everything next to a line, in pixels
_END = re.compile(r"(?<=[.!?]) ")  # of a sentence
_MOST_LINES, _BUTTON = 2, 4  # of a sentence; characters that a button next to it takes
_TOLD, _FIRST = 5.0, 0.05  # seconds left that are worth telling, and share of the work that tells them
_ROUNDED, _STEP, _MINUTES = 10.0, 5.0, 90.0  # seconds: told exactly up to, in steps of, and in minutes from


class Tab:
    """Mixin for panels in the tab Canonical Form."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Canonical Form"


def record_of(context: bpy.types.Context) -> Record | None:
    """Read the record of the object whose result is shown.

    Parameters
    ----------
    context : bpy.types.Context
        Any context.

    Returns
    -------
    Record or None
        The record; None if there is no result.
    """
    obj = meant_object(context)
    return read_record(obj.data) if obj is not None and obj.type == "MESH" else None


def draw_sentence(layout: bpy.types.UILayout, context: bpy.types.Context, sentence: str, icon: str = "NONE") -> None:
    """Draw what is said over two lines at most: its first sentence, and a button that tells the rest.

    Parameters
    ----------
    layout : bpy.types.UILayout
        Where; lines of an aligned column lie closer together.
    context : bpy.types.Context
        Whose region is as wide as it is.
    sentence : str
        One or several sentences, in the user's language.
    icon : str
        The icon of the first line.
    """
    lines = textwrap.wrap(sentence, line_length(context))
    if len(lines) <= _MOST_LINES:
        for number, line in enumerate(lines):
            layout.label(text=line, icon="BLANK1" if number and icon != "NONE" else icon)
        return
    first = _END.split(sentence, maxsplit=1)[0]  # what it is; what to do about it is told by the button
    lines = textwrap.wrap(first, line_length(context) - _BUTTON, max_lines=_MOST_LINES, placeholder=" …")
    for number, line in enumerate(lines):
        row = layout.row(align=True)
        row.label(text=line, icon="BLANK1" if number and icon != "NONE" else icon)
        if number == len(lines) - 1:
            button = row.operator(OBJECT_OT_canonical_form_read.bl_idname, text="", icon="INFO", emboss=False)
            button.sentence = sentence


def line_length(context: bpy.types.Context) -> int:
    """Estimate the number of characters that fit into a line of the region.

    Parameters
    ----------
    context : bpy.types.Context
        Any context.

    Returns
    -------
    int
        That number.
    """
    if context.region is None:  # in background mode
        return _USUAL
    width = context.region.width / context.preferences.system.ui_scale
    return max(_SHORTEST, int((width - _MARGIN) / _CHARACTER))


def draw_progress(layout: bpy.types.UILayout, wishes: Collection[str]) -> bool:
    """Draw the progress of a job in place of the row that started it.

    Parameters
    ----------
    layout : bpy.types.UILayout
        Where the row would be.
    wishes : collection of str
        What the row starts, as operators call it; empty for any other.

    Returns
    -------
    bool
        True if the job is of that row; the row itself must be drawn otherwise.
    """
    cancel = OBJECT_OT_canonical_form_cancel
    if cancel.job is None or cancel.wish not in wishes:
        return False
    row = layout.row(align=True)
    row.progress(factor=cancel.job.fraction, text=progress_text(cancel.job.fraction), type="BAR")
    row.operator(cancel.bl_idname, text="", icon="X")
    return True


def progress_text(fraction: float) -> str:
    """Say how far a job is, and how long it takes still.

    Parameters
    ----------
    fraction : float
        Share of the work that is done.

    Returns
    -------
    str
        In the user's language.
    """
    left = OBJECT_OT_canonical_form_cancel.seconds_left(perf_counter()) if fraction > _FIRST else 0.0
    if left < _TOLD:
        return f"{fraction:.0%}"
    return told("{done:.0%}  {time} left", done=fraction, time=told_time(left))


def told_time(seconds: float) -> str:
    """Say roughly how long something takes, so that the words do not change all the time.

    Parameters
    ----------
    seconds : float
        The time.

    Returns
    -------
    str
        In the user's language.

    Examples
    --------
    >>> told_time(0.4), told_time(7.2), told_time(33.0), told_time(260.0)
    ('1 s', '7 s', '35 s', '4 min')
    """
    if seconds >= _MINUTES:
        return told("{minutes:.0f} min", minutes=seconds / 60)
    if seconds > _ROUNDED:
        seconds = _STEP * -(-seconds // _STEP)
    return told("{seconds:.0f} s", seconds=max(seconds, 1.0))
