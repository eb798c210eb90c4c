"""The record on a mesh of the armature that it was given, and of what binds it."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from typing import Any

import bpy

from ..mesh_items.fingerprints import key_fingerprint
from .stored_values import flag, listed, maybe, named, real, whole, words

RIG_PROPERTY = "canonical_form_rig"
SCAN = "Scan"  # begins the name of the action that holds the pose of the scan
DOUBTFUL = 0.25  # confidence of a bone below which it is coloured, and named


@dataclass
class RigRecord:
    """The armature of a mesh.

    Attributes
    ----------
    token : str
        Mark of everything that was made with the armature.
    armature : str
        Fingerprint of the armature.
    actions : dict of str to str
        Fingerprints of the actions that hold poses, by name.
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
    inverse : list of float or None
        The inverse of its parent's placement before the object was parented to the armature; None if it was not.
    basis : bool
        Whether the Basis was added.
    slider : float or None
        Value of the form's key before it was switched off; None if it was not.
    groups, keys : dict of str to str
        Fingerprints of vertex groups and shape keys that were written, by name.
    """

    token: str
    armature: str
    actions: dict[str, str]
    source: str
    pose: str
    side: int
    sides: list[float]
    confidence: dict[str, float]
    warnings: list[str]
    inverse: list[float] | None = None
    basis: bool = False
    slider: float | None = None
    groups: dict[str, str] = field(default_factory=dict)
    keys: dict[str, str] = field(default_factory=dict)

    @property
    def rest(self) -> tuple[str, str] | None:
        """Name and fingerprint of the key that holds the pose at rest; None if the mesh rests as it is."""
        return None if self.pose == "NONE" else next(iter(self.keys.items()), None)

    @property
    def scan(self) -> str | None:
        """Name of the action that holds the pose of the scan; None if the mesh rests as it was scanned."""
        return next((name for name in self.actions if name.startswith(SCAN)), None)


_TAKE: dict[str, Callable[[Any], Any]] = {
    "token": words,
    "armature": words,
    "actions": lambda each: named(words, each),
    "source": words,
    "pose": words,
    "side": whole,
    "sides": lambda each: listed(real, each),
    "confidence": lambda each: named(real, each),
    "warnings": lambda each: listed(words, each),
    "inverse": lambda each: maybe(lambda own: listed(real, own, 16), each),
    "basis": flag,
    "slider": lambda each: maybe(real, each),
    "groups": lambda each: named(words, each),
    "keys": lambda each: named(words, each),
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


def recorded_key(mesh: bpy.types.Mesh, name: str, known: str) -> bpy.types.ShapeKey | None:
    """Find a shape key of a record, renamed or changed since.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.
    name : str
        The name that it had.
    known : str
        Its fingerprint.

    Returns
    -------
    bpy.types.ShapeKey or None
        The key with that fingerprint, else that of the name; never the Basis.
    """
    if mesh.shape_keys is None:
        return None
    keys = [each for each in mesh.shape_keys.key_blocks if each != mesh.shape_keys.reference_key]
    named_so = [each for each in keys if each.name == name]
    return next((each for each in [*named_so, *keys] if key_fingerprint(each) == known), next(iter(named_so), None))
