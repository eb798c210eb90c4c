"""What data are transferred from: one mesh, or all meshes of an armature, read as one."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, NamedTuple

import bpy
import numpy as np

from ...core.rigging.reference_rig import ReferenceRig
from ..jobs.pose_reading import reference_meshes
from ..objects.bone_reading import with_bones
from ..objects.combining import moved, outward, require_thick
from ..objects.mesh_reading import read_mesh, read_object
from ..objects.object_states import object_mode
from ..objects.placement import placement_of
from ..objects.rest_reading import rigs_of
from .transfer_reading import Source, SourceColours, SourceKey, read_source

if TYPE_CHECKING:
    from ...core.numerics.arrays import FloatArray, IntArray

_NEUTRAL = 1.0  # white, opaque: the colour of what has none


class Donor(NamedTuple):
    """What data are transferred from.

    Attributes
    ----------
    objects : list of bpy.types.Object
        Its meshes, the largest first.
    vertices : (n', 3) ndarray of float
        Positions of their base meshes, in world space.
    faces : (t, 3) ndarray of int
        Triangles, with normals that point outward.
    data : Source
        What can be transferred; its name is that of the chosen object.
    rig : ReferenceRig or None
        The bones that move them, on the same vertices; None if no armature does, or more than one.
    """

    objects: list[bpy.types.Object]
    vertices: FloatArray
    faces: IntArray
    data: Source
    rig: ReferenceRig | None


class _Part(NamedTuple):
    """One mesh of a donor."""

    vertices: FloatArray  # in world space
    faces: IntArray
    data: Source  # keys in world space
    rig: ReferenceRig | None


def read_donor(obj: bpy.types.Object | None) -> Donor:
    """Read what data are to be transferred from.

    Parameters
    ----------
    obj : bpy.types.Object or None
        A mesh, or an armature, which stands for all meshes that it moves.

    Returns
    -------
    Donor
        Its arrays and data.

    Raises
    ------
    CanonicalFormError
        If it has no meshes, or one cannot be read.
    """
    objects = sorted(reference_meshes(obj), key=lambda each: -len(each.data.vertices))
    assert obj is not None  # it has meshes
    parts = [_read(each, alone=len(objects) == 1) for each in objects]
    starts = np.cumsum([0, *(len(each.vertices) for each in parts)])
    rigs = [each.rig for each in parts if each.rig is not None]
    faces = np.concatenate([own.faces + start for own, start in zip(parts, starts, strict=False)])
    vertices = np.concatenate([each.vertices for each in parts])
    rig = None
    if len(rigs) == len(parts):  # of one armature, if there are several
        rig = ReferenceRig(vertices, faces, rigs[0].skeleton, np.concatenate([each.weights for each in rigs]))
        vertices = rig.vertices
    return Donor(objects, vertices, faces, _merged(obj.name, [(each.data, each.vertices) for each in parts]), rig)


def _read(obj: bpy.types.Object, *, alone: bool) -> _Part:
    """Read one mesh."""
    with object_mode(obj):
        vertices, faces = read_mesh(obj.data)
        data = read_source(obj)
        (reading,) = with_bones([obj], [read_object(obj)]) if len(rigs_of(obj)) == 1 else (None,)
    place = placement_of(obj, False)
    require_thick(obj.name, place, alone=alone)
    data = data._replace(keys=[each._replace(shape=moved(each.shape, place)) for each in data.keys])
    points, faces = moved(vertices, place), outward(faces, place)
    rig = None
    if reading is not None and reading.bones is not None and len(reading.bones.weights) == len(points):
        rig = ReferenceRig(points, faces, reading.bones.skeleton, reading.bones.weights)
    return _Part(points, faces, data, rig)


def _merged(name: str, parts: Sequence[tuple[Source, FloatArray]]) -> Source:
    """Put the data of several meshes together, by name, as Blender joins objects."""
    first = parts[0][0]
    if len(parts) == 1:
        return first._replace(name=name)
    corners = np.cumsum([0, *(len(data.vertex_of) for data, _ in parts)])
    vertices = np.cumsum([0, *(len(points) for _, points in parts)])
    slots = np.cumsum([0, *(len(data.materials) for data, _ in parts)])
    own = list(zip(parts, corners, vertices, slots, strict=False))
    return Source(
        name,
        np.concatenate([data.triangle_corners + start for (data, _), start, _, _ in own]),
        np.concatenate([data.vertex_of + start for (data, _), _, start, _ in own]),
        {group: _groups(group, parts) for group in _names(data.groups for data, _ in parts)},
        {layer: _uvs(layer, parts) for layer in first.uvs},
        [_colours(each, parts) for each in first.colours],
        [_key(each, parts) for each in _keys(parts)],
        [material for data, _ in parts for material in data.materials],
        np.concatenate([data.material_of + start for (data, _), _, _, start in own]),
        first.armature,
        list(dict.fromkeys(damaged for data, _ in parts for damaged in data.damaged)),
    )


def _names(parts: Iterable[Iterable[str]]) -> list[str]:
    """List names in the order in which they come."""
    return list(dict.fromkeys(name for part in parts for name in part))


def _groups(name: str, parts: Sequence[tuple[Source, FloatArray]]) -> FloatArray:
    """Put the weights of one group together; what is not in it has none."""
    return np.concatenate([data.groups.get(name, np.zeros(len(points))) for data, points in parts])


def _uvs(name: str, parts: Sequence[tuple[Source, FloatArray]]) -> FloatArray:
    """Put one UV map together; a mesh without one of that name lends its first."""
    maps = [data.uvs.get(name, next(iter(data.uvs.values()), None)) for data, _ in parts]
    return np.concatenate(
        [
            np.zeros((len(data.vertex_of), 2)) if layer is None else layer
            for layer, (data, _) in zip(maps, parts, strict=True)
        ]
    )


def _colours(like: SourceColours, parts: Sequence[tuple[Source, FloatArray]]) -> SourceColours:
    """Put one colour attribute together; what has none of that name and domain is white."""
    found = []
    for data, points in parts:
        own = next((x for x in data.colours if (x.name, x.on_corners) == (like.name, like.on_corners)), None)
        count = len(data.vertex_of) if like.on_corners else len(points)
        found.append(np.full((count, 4), _NEUTRAL) if own is None else own.values)
    return like._replace(values=np.concatenate(found))


def _keys(parts: Sequence[tuple[Source, FloatArray]]) -> list[SourceKey]:
    """List the shape keys of all meshes, one of each name."""
    return list({key.name: key for data, _ in reversed(parts) for key in data.keys}.values())


def _key(like: SourceKey, parts: Sequence[tuple[Source, FloatArray]]) -> SourceKey:
    """Put one shape key together; it does not move what does not have it."""
    shapes = [{key.name: key.shape for key in data.keys}.get(like.name, points) for data, points in parts]
    return like._replace(shape=np.concatenate(shapes))
