"""Reads a rigged character whose bones other bodies are to get."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import bpy
import numpy as np

from ...core import CanonicalFormError
from ...core.rigging.fitted_rig import rest_bends
from ...core.rigging.reference_rig import ReferenceRig
from ..objects.bone_reading import with_bones, without_bones
from ..objects.combining import concatenated, moved, outward
from ..objects.mesh_reading import read_object
from ..objects.object_states import object_mode
from ..objects.rest_reading import moved_by, moved_with_others, rigs_of
from ..words.wording import told

if TYPE_CHECKING:
    from ...core.numerics.arrays import FloatArray


class RigSource(NamedTuple):
    """A rigged character.

    Attributes
    ----------
    name : str
        Name of the object that was chosen.
    rig : ReferenceRig
        Its skin and bones, in world space.
    rolls : dict of str to float
        By bone, the angle about it, in radians, from the axis about which the core lets it bend to its own X axis.
    warnings : list of str
        Sentences for the user.
    """

    name: str
    rig: ReferenceRig
    rolls: dict[str, float]
    warnings: list[str]


def read_rig_source(obj: bpy.types.Object | None) -> RigSource:
    """Read a rigged character at rest.

    Parameters
    ----------
    obj : bpy.types.Object or None
        One of its meshes, or its armature.

    Returns
    -------
    RigSource
        All its meshes that are shown, and its bones.

    Raises
    ------
    CanonicalFormError
        If no armature moves it, or its weights cannot be read.
    """
    armature = _armature_of(obj)
    if obj is None or armature is None:
        name = "" if obj is None else obj.name
        raise CanonicalFormError(
            told("{name} has no rig. Choose an armature with its mesh, or a mesh that one armature moves.", name=name)
        )
    parts, left = [], [each.name for each in moved_with_others(armature)]
    for each in moved_by(armature):
        with object_mode(each):
            (reading,) = with_bones([each], [read_object(each)])
        if reading.bones is not None:
            parts.append(reading)
        else:
            left.append(each.name)
    bones = [each.bones for each in parts if each.bones is not None]
    if not bones:
        raise CanonicalFormError(
            told(
                "The weights of {name} cannot be read. Choose a rig with vertex groups for its bones, and without a "
                "negative scale.",
                name=obj.name,
            )
        )
    vertices, faces, _ = concatenated(
        [
            (moved(own.rest, each.placement), outward(each.faces, each.placement))
            for own, each in zip(bones, parts, strict=True)
        ]
    )
    rig = ReferenceRig(vertices, faces, bones[0].skeleton, np.concatenate([each.weights for each in bones]))
    return RigSource(obj.name, rig, _rolls(armature, rig), without_bones(left, obj.name))


def _armature_of(obj: bpy.types.Object | None) -> bpy.types.Object | None:
    """Find the one armature that a chosen object is, or that moves it."""
    if obj is None or obj.type == "ARMATURE":
        return obj
    rigs = rigs_of(obj) if obj.type == "MESH" else set()
    return next(iter(rigs)) if len(rigs) == 1 else None


def _rolls(armature: bpy.types.Object, rig: ReferenceRig) -> dict[str, float]:
    """Measure how the X axis of each bone lies about it."""
    place = np.array(armature.matrix_world)[:3, :3]
    own = np.array([place @ np.array(armature.data.bones[name].matrix_local)[:3, 0] for name in rig.skeleton.names])
    axes, bends = rig.axes, rest_bends(rig)
    across = np.cross(axes, bends)
    angles = np.arctan2(np.einsum("bi,bi->b", own, across), np.einsum("bi,bi->b", own, bends))
    return dict(zip(rig.skeleton.names, angles.tolist(), strict=True))


def rolled(axes: FloatArray, bends: FloatArray, angles: FloatArray) -> FloatArray:
    """Turn axes across bones about them.

    Parameters
    ----------
    axes : (b, 3) ndarray of float
        Directions of the bones.
    bends : (b, 3) ndarray of float
        Axes across them.
    angles : (b,) ndarray of float
        Radians.

    Returns
    -------
    (b, 3) ndarray of float
        The axes across, turned.
    """
    sines, cosines = np.sin(angles)[:, None], np.cos(angles)[:, None]
    return np.asarray(cosines * bends + sines * np.cross(axes, bends))
