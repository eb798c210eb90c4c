"""What Rig makes in a file, marked as its own: renamed, it is found again, and nothing else is taken for it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import bpy
import numpy as np

from ..mesh_items.action_curves import curves_of
from ..mesh_items.fingerprints import fingerprint

MARK, PART = "canonical_form_made", " part"  # the armature itself is no part
_KINDS = ("actions", "objects", "collections", "armatures", "meshes", "texts")  # users come before what they use


def new_token(name: str) -> str:
    """Find a mark that nothing in the file has.

    Parameters
    ----------
    name : str
        How it begins.

    Returns
    -------
    str
        The mark.
    """
    known = {str(each.get(MARK)).removesuffix(PART) for kind in _KINDS for each in getattr(bpy.data, kind)}
    number = next(number for number in range(len(known) + 1) if f"{name} {number}" not in known)
    return f"{name} {number}"


@contextmanager
def all_or_nothing() -> Iterator[Callable[[str], None]]:
    """Remove after an error what was made meanwhile.

    Yields
    ------
    callable
        Marks what was made so far with a token.
    """
    before = {each.session_uid for kind in _KINDS for each in getattr(bpy.data, kind)}

    def mark(token: str) -> None:
        for each in _since(before):
            each[MARK] = token + PART

    try:
        yield mark
    except BaseException:
        bpy.data.batch_remove(_since(before))
        raise


def _since(before: set[int]) -> list[bpy.types.ID]:
    return [each for kind in _KINDS for each in getattr(bpy.data, kind) if each.session_uid not in before]


def made_by(token: str) -> list[bpy.types.ID]:
    """List what has a mark.

    Parameters
    ----------
    token : str
        The mark.

    Returns
    -------
    list of bpy.types.ID
        The data of this file, not of libraries.
    """
    return [
        each
        for kind in _KINDS
        for each in getattr(bpy.data, kind)
        if each.get(MARK) in (token, token + PART) and each.library is None
    ]


def unnumbered(token: str) -> None:
    """Take the numbers off the names of objects and armatures that were made while those names were taken.

    Parameters
    ----------
    token : str
        Their mark.
    """
    for each in made_by(token):
        name, _, number = each.name.rpartition(".")
        kind = bpy.data.objects if isinstance(each, bpy.types.Object) else bpy.data.armatures
        if isinstance(each, (bpy.types.Object, bpy.types.Armature)) and number.isdecimal() and name not in kind:
            each.name = name


def armature_fingerprint(armature: bpy.types.Object) -> str:
    """Hash what of an armature a user may have changed: bones, constraints, properties, animation; not its pose.

    Parameters
    ----------
    armature : bpy.types.Object
        The armature, not in Edit Mode.

    Returns
    -------
    str
        The fingerprint.
    """
    words, places = [], []
    owners = [armature, *(() if armature.pose is None else armature.pose.bones)]
    for owner in owners:
        words += [owner.name if owner != armature else "", *(f"{each.type} {each.name}" for each in owner.constraints)]
        words += sorted(name for name in owner.keys() if name != MARK)  # noqa: SIM118 (properties, not a dict)
    for bone in armature.data.bones:
        words += [bone.name, bone.parent.name if bone.parent else "", str(bone.use_deform)]
        places.append([*bone.tail_local, *np.ravel(bone.matrix_local)])
    for data in (armature.animation_data, armature.data.animation_data):
        if data is not None:
            words += [curve.data_path for curve in data.drivers]
            words += [track.name for track in data.nla_tracks]
    return fingerprint(np.frombuffer("\0".join(words).encode(), dtype=np.uint8), np.array(places, dtype=np.float32))


def action_fingerprint(action: bpy.types.Action) -> str:
    """Hash the keyframes of an action.

    Parameters
    ----------
    action : bpy.types.Action
        The action.

    Returns
    -------
    str
        The fingerprint.
    """
    curves = curves_of(action)
    words = "\0".join(f"{curve.data_path} {curve.array_index}" for curve in curves)
    points = [list(point.co) for curve in curves for point in curve.keyframe_points]
    return fingerprint(np.frombuffer(words.encode(), dtype=np.uint8), np.array(points, dtype=np.float32))
