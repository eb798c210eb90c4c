"""Advice for messages of the core: which menu or operator of Blender solves the problem."""

from __future__ import annotations

from collections.abc import Iterable

import bpy

from ...core import CanonicalFormError
from ...core.run.messages import Message
from .file_errors import sentence
from .wording import told, told_message

_DISSOLVE = "Mesh > Clean Up > Degenerate Dissolve"
_MERGE = "Mesh > Merge > By Distance"
_DECIMATE = "Apply a Decimate modifier to reduce the mesh."
_PART = "Part Here parts it."
_ANYWAY = "Make Anyway keeps it."
_OTHER_SIDE = "Flip Front/Back, or Other Side, takes the next."
_IN_TERMINAL = {  # where there are no buttons
    _PART: "--part-here parts it.",
    _ANYWAY: "--anyway keeps it.",
    _OTHER_SIDE: "--side takes the next.",
}
ADVICE = {  # by message kind
    "repeated_corners": f"{_DISSOLVE} removes such faces.",
    "coincident_borders": f"{_MERGE} does this permanently.",
    "duplicate_faces": f"{_MERGE} removes such faces.",
    "inconsistent_faces": "Mesh > Normals > Recalculate Outside does this permanently.",
    "rounded_positions": "Object > Set Origin > Geometry to Origin moves the origin to the mesh.",
    "too_many_pieces": "In Edit Mode, M > By Distance merges and P > By Loose Parts separates.",
    "loose_vertices": "Mesh > Clean Up > Delete Loose removes such vertices.",
    "flat_triangles": f"{_DISSOLVE} removes such triangles.",
    "singular": f"{_MERGE} and {_DISSOLVE} may repair it.",
    "inaccurate_spectrum": f"{_MERGE} and {_DISSOLVE} may repair it.",
    "spectrum_diverged": f"{_MERGE} and {_DISSOLVE} may repair it.",
    "handles": _PART,
    "contacts_left": _PART,
    "contacts_left_beside": _PART,
    "contacts_unknown": _PART,
    "stance_parts": _ANYWAY,
    "stance_unlike": _ANYWAY,
    "stance_unlikely": _ANYWAY,
    "stance_limb": _ANYWAY,
    "rig_unlike": _ANYWAY,
    "transfer_unlike": _ANYWAY,
    "stance_strained": _ANYWAY,
    "stance_limbs": "Let it rest As the Reference, or As It Stands.",
    "match_sides": _OTHER_SIDE,
    "no_axes": f"{_MERGE} may repair it.",
    "mesh_memory": _DECIMATE,
    "pair_memory": _DECIMATE,
    "distance_memory": _DECIMATE,
}
MENDS = {  # by message kind: which buttons of the panel mend it
    **dict.fromkeys(("handles", "contacts_left", "contacts_left_beside", "contacts_unknown"), "PART"),
    **dict.fromkeys(("no_pairs", "one_pair", "no_head", "unpaired_ends", "twisted"), "LIMBS"),
    **{kind: "ANYWAY" for kind, advice in ADVICE.items() if advice == _ANYWAY},
}
CUT = "CUT"  # mends skin that is stretched over what was parted: a new object is cut there
_NO_MEMORY = "Not enough memory. Close other files, or decimate the mesh."


def advised(sentence: str) -> str:
    """Append advice to a message of the core if Blender offers a remedy.

    Parameters
    ----------
    sentence : str
        A warning or the text of an error; text that is not a message of the core is returned unchanged.

    Returns
    -------
    str
        The translated message, with advice if there is any.

    Examples
    --------
    >>> from addon.core.run.messages import message
    >>> advised(message("loose_vertices", count=1))
    '1 vertex that belongs to no face stays where it is. Mesh > Clean Up > Delete Loose removes such vertices.'
    """
    advice = ADVICE.get(sentence.kind, "") if isinstance(sentence, Message) else ""
    if bpy.app.background:
        advice = _IN_TERMINAL.get(advice, advice)
    said = told_message(sentence)
    return f"{said} {told(advice)}" if advice else said


def all_advised(sentences: Iterable[str]) -> list[str]:
    """Append advice to each message of the core for which Blender offers a remedy.

    Parameters
    ----------
    sentences : iterable of str
        Warnings.

    Returns
    -------
    list of str
        The messages with their advice.
    """
    return [advised(each) for each in sentences]


def explained(error: Exception) -> str:
    """Explain why there is no result and what to do about it in Blender.

    Parameters
    ----------
    error : Exception
        The exception that was raised.

    Returns
    -------
    str
        One or two sentences.
    """
    if isinstance(error, MemoryError):
        return told(_NO_MEMORY)
    if isinstance(error, CanonicalFormError) and error.args:
        return advised(error.args[0])
    return sentence(error) if isinstance(error, OSError) else str(error)
