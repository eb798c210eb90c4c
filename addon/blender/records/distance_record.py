"""The record on a mesh of the distance fields that were written to it."""

from __future__ import annotations

import json
from typing import NamedTuple

import bpy

from .stored_values import listed, named, words

DISTANCES_PROPERTY = "canonical_form_distances"
_COLOURS, _WEIGHTS = " colours", " weights"


class WrittenField(NamedTuple):
    """The colours and the vertex group of one distance field; empty strings if there are none.

    Attributes
    ----------
    colours, colours_fingerprint : str
        Name and fingerprint of the colour attribute.
    weights, weights_fingerprint : str
        Name and fingerprint of the vertex group.
    """

    colours: str = ""
    colours_fingerprint: str = ""
    weights: str = ""
    weights_fingerprint: str = ""


def read_distances(mesh: bpy.types.Mesh) -> dict[str, WrittenField]:
    """Read the record of the distance fields on a mesh.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.

    Returns
    -------
    dict of str to WrittenField
        The fields by name; empty if there are none.
    """
    text = mesh.get(DISTANCES_PROPERTY)
    try:
        entries = named(lambda pair: listed(words, pair, 2), json.loads(text) if isinstance(text, str) else {})
        names = [entry.removesuffix(_COLOURS) for entry in entries if entry.endswith(_COLOURS)]
        return {name: WrittenField(*entries[name + _COLOURS], *entries[name + _WEIGHTS]) for name in names}
    except (KeyError, ValueError, RecursionError):  # a property of that name from the user, or from an untrusted file
        return {}


def write_distances(mesh: bpy.types.Mesh, fields: dict[str, WrittenField]) -> None:
    """Write the record of the distance fields on a mesh.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.
    fields : dict of str to WrittenField
        The fields by name.
    """
    entries: dict[str, list[str]] = {}
    for name, field in fields.items():
        entries[name + _COLOURS] = [field.colours, field.colours_fingerprint]
        entries[name + _WEIGHTS] = [field.weights, field.weights_fingerprint]
    mesh[DISTANCES_PROPERTY] = json.dumps(entries)
