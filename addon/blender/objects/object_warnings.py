"""Warnings about objects: which of them a warning concerns, and what the form ignores."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import bpy
import numpy as np

from ...core.measures.alignment import rigid_fit
from ...core.numerics.arrays import FloatArray
from ...core.run.messages import Message
from ..mesh_items.key_points import key_points
from ..words.advice import advised
from ..words.wording import listed, told
from .mesh_reading import Reading
from .mirrors import is_followed
from .movers import bending_keys, bending_modifiers, users_keys

_OF_A_MESH = ("repeated_corners", "coincident_borders", "duplicate_faces", "inconsistent_faces", "loose_vertices")
NOTES = {*_OF_A_MESH, "flat_triangles", "small_pieces_ride", "stray_vertices", "pieces_without_area"}  # no doubts
_PUSHED = 0.1  # of the farthest push of a key: where it pushes
_TURNED = np.radians(25)  # of its part of the surface, above which it pushes the wrong way
_ADDING = (
    "ARRAY",
    "BOOLEAN",
    "BUILD",
    "MASK",
    "MIRROR",
    "NODES",
    "REMESH",
    "SCREW",
    "SKIN",
    "SOLIDIFY",
    "VOLUME_TO_MESH",
)


def object_warnings(objects: Sequence[bpy.types.Object], deformed: bool, *, scaled: bool = False) -> list[str]:
    """Return warnings about scale, shape keys and modifiers that the form of some objects ignores.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        The objects of one form.
    deformed : bool
        Whether the form is computed from the evaluated meshes instead of the base meshes.
    scaled : bool
        Whether the form includes the objects' scales, as for several objects as one body.

    Returns
    -------
    list of str
        Sentences that name the objects and the remedy.
    """
    warnings = []
    for obj in objects if not scaled else ():
        scale = np.abs(np.array(obj.matrix_world.to_scale()))
        if scale.max() > 1.001 * scale.min():
            warnings.append(
                told(
                    "The scale of {name} is not uniform: apply it (Ctrl+A > Scale). The form was computed without it; "
                    "run again for the form of what you see.",
                    name=obj.name,
                )
            )
    if deformed:
        return warnings
    names, keys = _those_with(objects, bending_keys)
    if keys:
        warnings.append(
            told(
                "Other shape keys bend the form as they bend the mesh. Set their values to 0, or set Mesh to As Shown "
                "to take out the pose that you see: {keys} of {name}.",
                name=names,
                keys=keys,
            )
        )
    names, bending = _those_with(objects, bending_modifiers)
    if bending:
        warnings.append(
            told(
                "Some modifiers bend the form as they bend the mesh. Set Mesh to As Shown to take out the pose that "
                "you see: {bending} of {name}.",
                name=names,
                bending=bending,
            )
        )
    names, adding = _those_with(objects, _adding_modifiers)
    if adding:
        warnings.append(
            told(
                "Some modifiers add to the mesh or hide parts of it. The form is of it without them. Apply them, or "
                "set Mesh to As Shown: {adding} of {name}.",
                name=names,
                adding=adding,
            )
        )
    return warnings


def warnings_by_object(warnings: Sequence[Message], readings: Sequence[Reading]) -> list[str]:
    """Advise on the warnings of a body, with the names of the objects whose own mesh causes them.

    Parameters
    ----------
    warnings : sequence of Message
        The warnings about the body.
    readings : sequence of Reading
        Its objects.

    Returns
    -------
    list of str
        Translated sentences with advice. If there are several objects, those about the repair of a mesh and about
        loose vertices end with the names of the objects.
    """
    from ...core.mesh.repair import repaired

    names: dict[str, list[str]] = {}
    if len(readings) > 1 and any(warning.kind in _OF_A_MESH for warning in warnings):
        for reading in readings:
            loose = len(reading.vertices) - len(np.unique(reading.faces))
            found = {**repaired(reading.vertices, reading.faces).changes, "loose_vertices": loose}
            for kind in (kind for kind, count in found.items() if count):
                names.setdefault(kind, []).append(reading.name)
    about = [listed(names.get(warning.kind, [])) for warning in warnings]
    return [f"{advised(each)} ({of})" if of else advised(each) for of, each in zip(about, warnings, strict=True)]


def turned_key_warnings(objects: Sequence[bpy.types.Object], forms: Sequence[FloatArray]) -> list[str]:
    """Return a warning about shape keys of the user that push in the axes of the pose where a form turns the surface.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        The objects.
    forms : sequence of (n, 3) ndarray of float
        Positions of the form of each.

    Returns
    -------
    list of str
        A sentence that names the keys; empty if there are none.
    """
    form_of = dict(zip((obj.name for obj in objects), forms, strict=True))
    names, keys = _those_with(objects, lambda obj: _turned_keys(obj, form_of[obj.name]))
    if not keys:
        return []
    return [
        told(
            "Shape keys of {name} push as they did in its pose, not as the form is turned: {keys}. With the form, they "
            "move the surface the wrong way.",
            name=names,
            keys=keys,
        )
    ]


def _turned_keys(obj: bpy.types.Object, form: FloatArray) -> list[str]:
    """Return the names of the user's keys whose part of the surface is turned from the Basis to a form."""
    keys = obj.data.shape_keys
    if keys is None:
        return []
    basis = key_points(keys.reference_key).astype(np.float64)
    found = []
    for key in users_keys(obj.data):
        moved = np.linalg.norm(key_points(key) - key_points(key.relative_key), axis=1)
        part = np.flatnonzero(moved > _PUSHED * moved.max(initial=0.0))
        if len(part) < 3 or np.linalg.matrix_rank(basis[part] - basis[part].mean(axis=0), tol=1e-9) < 2:
            continue
        rotation = rigid_fit(basis[part], form[part])[0]
        if (np.trace(rotation) - 1) / 2 < np.cos(_TURNED):
            found.append(key.name)
    return found


def _those_with(objects: Sequence[bpy.types.Object], what: Callable[[bpy.types.Object], list[str]]) -> tuple[str, str]:
    """Return the names of the objects that have something, and the names of what they have, each once."""
    having = {obj.name: found for obj in objects if (found := what(obj))}
    return listed(having), listed(dict.fromkeys(each for found in having.values() for each in found))


def _adding_modifiers(obj: bpy.types.Object) -> list[str]:
    """Return the names of the enabled modifiers that add geometry."""
    return [
        each.name for each in obj.modifiers if each.show_viewport and each.type in _ADDING and not is_followed(each)
    ]
