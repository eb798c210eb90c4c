"""The limbs whose pose a form removes, and whether this selection can be changed."""

from __future__ import annotations

import bpy

from ..records.form_key import form_key
from ..records.record import read_record
from ..words.wording import told


def limbs_of(mesh: bpy.types.Mesh) -> list[bool]:
    """Return for each patch whether the shape key removes its pose.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.

    Returns
    -------
    list of bool
        One flag for each patch; empty without a form.
    """
    record = read_record(mesh)
    return [] if record is None else record.straightened


def limbs_by_point(mesh: bpy.types.Mesh) -> dict[int | str, bool]:
    """Return which limbs the user has left in their pose, to find them again after another run.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.

    Returns
    -------
    dict of int or str to bool
        Whether the shape key removes the pose of a limb, by the vertex where it ends and by its name; empty if no limb
        is left in its pose.
    """
    record = read_record(mesh)
    flags = limbs_of(mesh)
    if record is None or all(flags):
        return {}
    found: dict[int | str, bool] = dict(zip(record.report.feature_names, flags, strict=False))
    found.pop("", None)
    points = zip(record.report.feature_points, flags, strict=True)
    return found | {point: flag for point, flag in points if point >= 0}  # -1: on another object of the body


def variant_refusal(obj: bpy.types.Object | None) -> str | None:
    """Return why the limbs and in-betweens of an object's form cannot be changed.

    Parameters
    ----------
    obj : bpy.types.Object or None
        The object.

    Returns
    -------
    str or None
        A sentence that names the remedy; None if they can be changed.
    """
    if obj is None or obj.type != "MESH" or not limbs_of(obj.data):
        return told("The active object has no canonical form. Compute it first.")
    record = read_record(obj.data)
    if record is not None and len(record.keys) > 1:
        return told("{name} has a form for each frame. Compute one form first.", name=obj.name)
    if form_key(obj.data) is None:
        return told("The shape key of the form was changed, renamed or removed. Compute the form again first.")
    return None
