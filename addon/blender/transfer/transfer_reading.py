"""Reads the data of an object that can be transferred: weights, UV maps, colours, shape keys, materials, its rig."""

from __future__ import annotations

from typing import NamedTuple

import bpy
import numpy as np

from ...core.numerics.arrays import FloatArray, IntArray
from ..mesh_items.active_items import ItemNames
from ..mesh_items.key_points import key_points
from ..mesh_items.weight_reading import weights_of
from ..records.record import read_record
from ..records.rig_record import read_rig
from ..records.transfer_record import rest_key
from ..results.match_colours import source_colours


class SourceColours(NamedTuple):
    """A colour attribute.

    Attributes
    ----------
    name : str
        Its name.
    on_corners : bool
        Whether it has one colour per corner, instead of one per vertex.
    data_type : str
        Blender's data type of the attribute.
    values : (k, 4) ndarray of float
        The colours.
    """

    name: str
    on_corners: bool
    data_type: str
    values: FloatArray


class SourceKey(NamedTuple):
    """A shape key.

    Attributes
    ----------
    name : str
        Its name.
    shape : (n', 3) ndarray of float
        Positions at value 1, without the other keys.
    limits : (float, float)
        Minimum and maximum of its slider.
    mask : str
        Name of the vertex group that limits it, as those for the left and the right side; empty for none.
    relative : str
        Name of the key that it changes; empty for the Basis.
    """

    name: str
    shape: FloatArray
    limits: tuple[float, float] = (0.0, 1.0)
    mask: str = ""
    relative: str = ""


class Source(NamedTuple):
    """An object's base mesh and the data that can be transferred from it.

    Attributes
    ----------
    name : str
        Name of the object.
    triangle_corners : (t, 3) ndarray of int
        Corner indices of its triangles.
    vertex_of : (l',) ndarray of int
        The vertex of each corner.
    groups : dict of str to (n',) ndarray of float
        Weights of the vertex groups.
    uvs : dict of str to (l', 2) ndarray of float
        UV maps.
    colours : list of SourceColours
        Colour attributes.
    keys : list of SourceKey
        Shape keys, without the Basis and those that this extension wrote.
    materials : list of str
        Names of the materials by slot; empty for a slot without one.
    material_of : (t,) ndarray of int
        Slot of each triangle.
    armature : str
        Name of the armature that deforms it; empty without one.
    damaged : list of str
        Names of UV maps, colour attributes and keys that hold values which are not numbers, and are left out.
    """

    name: str
    triangle_corners: IntArray
    vertex_of: IntArray
    groups: dict[str, FloatArray]
    uvs: dict[str, FloatArray]
    colours: list[SourceColours]
    keys: list[SourceKey]
    materials: list[str]
    material_of: IntArray
    armature: str
    damaged: list[str]


def read_source(obj: bpy.types.Object) -> Source:
    """Read the data of an object that can be transferred to others.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode.

    Returns
    -------
    Source
        Its base mesh and the transferable data.
    """
    mesh = obj.data
    record = read_record(mesh)
    own = ItemNames() if record is None else record.written_items()
    shown = source_colours(mesh)
    mesh.calc_loop_triangles()
    corners = np.empty(3 * len(mesh.loop_triangles), dtype=np.int32)
    mesh.loop_triangles.foreach_get("loops", corners)
    slot = np.empty(len(mesh.loop_triangles), dtype=np.int32)
    mesh.loop_triangles.foreach_get("material_index", slot)
    vertex_of = np.empty(len(mesh.loops), dtype=np.int32)
    mesh.loops.foreach_get("vertex_index", vertex_of)
    uvs = {layer.name: _values(layer.uv, "vector", 2) for layer in mesh.uv_layers}
    colours = [
        SourceColours(each.name, each.domain == "CORNER", each.data_type, _values(each.data, "color", 4))
        for each in mesh.color_attributes
        if each.domain in ("POINT", "CORNER") and each.name not in own.colours and each.name != shown
    ]
    keys = _keys(mesh, own)
    bad_uvs = [name for name, each in uvs.items() if not np.isfinite(each).all()]
    bad_colours = [each.name for each in colours if not np.isfinite(each.values).all()]
    bad_keys = [each.name for each in keys if not np.isfinite(each.shape).all()]
    return Source(
        obj.name,
        corners.reshape(-1, 3).astype(np.int64),
        vertex_of.astype(np.int64),
        weights_of(obj, [group.name for group in obj.vertex_groups if group.name not in own.groups]),
        {name: each for name, each in uvs.items() if name not in bad_uvs},
        [each for each in colours if each.name not in bad_colours],
        [each for each in keys if each.name not in bad_keys],
        ["" if each.material is None else each.material.name for each in obj.material_slots],
        slot.astype(np.int64),
        next((each.object.name for each in obj.modifiers if each.type == "ARMATURE" and each.object is not None), ""),
        [*bad_uvs, *bad_colours, *bad_keys],
    )


def _keys(mesh: bpy.types.Mesh, own: ItemNames) -> list[SourceKey]:
    """Read the shape keys, each without the effect of the others."""
    keys = mesh.shape_keys
    if keys is None:
        return []
    basis = key_points(keys.reference_key).astype(np.float64)
    rig, rest = read_rig(mesh), rest_key(mesh)
    internal = {*own.shape_keys, *(() if rig is None else rig.keys), *(() if rest is None else (rest.name,))}
    return [
        SourceKey(
            key.name,
            basis + key_points(key) - key_points(key.relative_key),
            (key.slider_min, key.slider_max),
            key.vertex_group,
            "" if key.relative_key in (keys.reference_key, key) else key.relative_key.name,
        )
        for key in keys.key_blocks
        if key != keys.reference_key and key.name not in internal
    ]


def _values(data: bpy.types.bpy_prop_collection, name: str, width: int) -> FloatArray:
    """Read one value of each element."""
    values = np.empty(width * len(data), dtype=np.float32)
    data.foreach_get(name, values)
    return values.reshape(-1, width).astype(np.float64)
