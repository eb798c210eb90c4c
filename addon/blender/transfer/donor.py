"""What data are transferred from: one mesh, or all meshes of an armature, read as one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import bpy
import numpy as np

from ...core import CanonicalFormError
from ...core.rigging.reference_rig import ReferenceRig
from ..jobs.pose_reading import reference_meshes
from ..objects.bone_reading import with_bones, without_bones
from ..objects.combining import concatenated, moved, outward, require_thick
from ..objects.mesh_reading import read_object
from ..objects.object_states import object_mode
from ..objects.rest_reading import moved_with_others
from ..words.wording import told
from .merged_sources import merged
from .transfer_reading import Source, read_source

if TYPE_CHECKING:
    from ...core import Skeleton
    from ...core.numerics.arrays import FloatArray, IntArray


class Donor(NamedTuple):
    """What data are transferred from.

    Attributes
    ----------
    objects : list of bpy.types.Object
        Its meshes, the largest first.
    vertices : (n', 3) ndarray of float
        Positions of their base meshes, in world space; as their bones rest, if they have some.
    faces : (t, 3) ndarray of int
        Triangles, with normals that point outward.
    data : Source
        What can be transferred; its name is that of the chosen object, and keys lie in world space.
    rig : ReferenceRig or None
        The bones that move them, on the same vertices; None if no armature does, or more than one.
    armature_uid : int
        Blender's identifier of the armature in this session; 0 without one.
    warnings : list of str
        Sentences for the user.
    """

    objects: list[bpy.types.Object]
    vertices: FloatArray
    faces: IntArray
    data: Source
    rig: ReferenceRig | None
    armature_uid: int
    warnings: list[str]

    def armature(self) -> bpy.types.Object | None:
        """Find the armature again, to bind to it what has been computed.

        Returns
        -------
        bpy.types.Object or None
            The armature; None if there is none.

        Raises
        ------
        CanonicalFormError
            If it was deleted since.
        """
        if not self.armature_uid:
            return None
        found = next((each for each in bpy.data.objects if each.session_uid == self.armature_uid), None)
        if found is None:
            raise CanonicalFormError(
                told("The armature of {name} was deleted meanwhile. Nothing was written.", name=self.data.name)
            )
        return found


class _Part(NamedTuple):
    """One mesh of a donor."""

    vertices: FloatArray  # in world space
    faces: IntArray
    data: Source  # keys in world space
    skeleton: Skeleton | None
    weights: FloatArray | None  # (n, b) of the bones


def read_donor(obj: bpy.types.Object | None, targets: Sequence[bpy.types.Object] = ()) -> Donor:
    """Read what data are to be transferred from.

    Parameters
    ----------
    obj : bpy.types.Object or None
        A mesh, or an armature, which stands for all meshes that it moves.
    targets : sequence of bpy.types.Object
        What is to receive the data, and is no part of an armature's meshes.

    Returns
    -------
    Donor
        Its arrays and data.

    Raises
    ------
    CanonicalFormError
        If it has no meshes, or one cannot be read.
    """
    objects = reference_meshes(obj, targets)
    assert obj is not None  # it has meshes
    found = [(each, _read(each)) for each in objects]
    left = [each.name for each in moved_with_others(obj) if each not in targets] if obj.type == "ARMATURE" else []
    if obj.type == "ARMATURE" and any(_is_held(part) for _, part in found):  # widgets and props are no skin
        left += [each.name for each, part in found if not _is_held(part)]
        found = [(each, part) for each, part in found if _is_held(part)]
    found.sort(key=lambda each: -len(each[1].vertices))
    parts = [part for _, part in found]
    vertices, faces, _ = concatenated([each[:2] for each in parts])
    held = [each.weights for each in parts if each.weights is not None]
    rig, skeleton = None, parts[0].skeleton
    if skeleton is not None and len(held) == len(parts):  # of one armature
        rig = ReferenceRig(vertices, faces, skeleton, np.concatenate(held))
    data = merged(obj.name, [(each.data, each.vertices) for each in parts])
    armature = obj if obj.type == "ARMATURE" else bpy.data.objects.get(data.armature)
    data = data._replace(armature="" if armature is None else armature.name)
    uid = 0 if armature is None else armature.session_uid
    return Donor([each for each, _ in found], vertices, faces, data, rig, uid, without_bones(left, obj.name))


def _is_held(part: _Part) -> bool:
    """Return whether bones hold a mesh."""
    return part.weights is not None and bool(part.weights.any())


def _read(obj: bpy.types.Object) -> _Part:
    """Read one mesh, as its bones rest if it has some."""
    with object_mode(obj):
        reading = read_object(obj)
        vertices, faces, place = reading.vertices, reading.faces, reading.placement
        require_thick(obj.name, place, alone=True)
        if reading.mirrors:
            raise CanonicalFormError(told("{name} has a Mirror modifier. Apply it first.", name=obj.name))
        if not np.isfinite(vertices).all():
            raise CanonicalFormError(
                told("{name} has vertices whose positions are not numbers. Choose another one, or delete them.",
                     name=obj.name)
            )  # fmt: skip
        data = read_source(obj)
        bones = with_bones([obj], [reading])[0].bones
    if bones is None or len(bones.rest) != len(vertices):
        keys = [each._replace(shape=moved(each.shape, place)) for each in data.keys]
        return _Part(moved(vertices, place), outward(faces, place), data._replace(keys=keys), None, None)
    off = bones.rest - vertices
    keys = [each._replace(shape=moved(each.shape + off, place)) for each in data.keys]
    bound = {name: own for name, own in zip(bones.skeleton.names, bones.weights.T, strict=True) if own.any()}
    if not any(name in data.groups for name in bound):  # it hangs on a bone
        data = data._replace(groups={**data.groups, **bound})
    points = moved(bones.rest, place)
    return _Part(points, outward(faces, place), data._replace(keys=keys), bones.skeleton, bones.weights)
