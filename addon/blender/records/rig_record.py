"""The record on a mesh of the armature that it was given, and of what binds it."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from typing import Any

import bpy

from .stored_values import flag, listed, named, real, whole, words

RIG_PROPERTY = "canonical_form_rig"


@dataclass
class RigRecord:
    """The armature of a mesh.

    Attributes
    ----------
    armature : str
        Name of the armature object.
    bones : str
        Fingerprint of its bones at rest.
    source : str
        Name of the object that has lent the bones; empty for the mannequin.
    pose : str
        The pose at rest, as `RigTask` takes it.
    side : int
        Which way the body faces: index into `sides`.
    sides : list of float
        Costs of the ways to face.
    confidence : dict of str to float
        How well each bone fits, 0 to 1.
    warnings : list of str
        Sentences for the user.
    modifier : str
        Name of the Armature modifier.
    parented : bool
        Whether the object was parented to the armature.
    basis : bool
        Whether the Basis was added.
    groups, keys : dict of str to str
        Fingerprints of vertex groups and shape keys that were written, by name.
    actions : list of str
        Names of the actions that hold poses.
    """

    armature: str
    bones: str
    source: str
    pose: str
    side: int
    sides: list[float]
    confidence: dict[str, float]
    warnings: list[str]
    modifier: str = ""
    parented: bool = False
    basis: bool = False
    groups: dict[str, str] = field(default_factory=dict)
    keys: dict[str, str] = field(default_factory=dict)
    actions: list[str] = field(default_factory=list)


_TAKE: dict[str, Callable[[Any], Any]] = {
    "armature": words,
    "bones": words,
    "source": words,
    "pose": words,
    "side": whole,
    "sides": lambda each: listed(real, each),
    "confidence": lambda each: named(real, each),
    "warnings": lambda each: listed(words, each),
    "modifier": words,
    "parented": flag,
    "basis": flag,
    "groups": lambda each: named(words, each),
    "keys": lambda each: named(words, each),
    "actions": lambda each: listed(words, each),
}


def read_rig(mesh: bpy.types.Mesh) -> RigRecord | None:
    """Read the record of a mesh.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.

    Returns
    -------
    RigRecord or None
        The record; None if the mesh has none.
    """
    text = mesh.get(RIG_PROPERTY)
    try:
        stored = json.loads(text) if isinstance(text, str) else {}
        return RigRecord(**{name: take(stored[name]) for name, take in _TAKE.items()})
    except (ValueError, KeyError, TypeError, RecursionError):  # none, or one from an untrusted file
        return None


def write_rig(mesh: bpy.types.Mesh, record: RigRecord) -> None:
    """Write the record of a mesh.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.
    record : RigRecord
        The record.
    """
    mesh[RIG_PROPERTY] = json.dumps(asdict(record))


def remove_rig_record(mesh: bpy.types.Mesh) -> None:
    """Remove the record of a mesh, if it has one.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.
    """
    if RIG_PROPERTY in mesh:
        del mesh[RIG_PROPERTY]
