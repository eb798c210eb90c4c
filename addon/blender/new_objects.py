"""New objects for results that are not to touch the mesh they come from."""

from __future__ import annotations

import bpy
import numpy as np

from .mesh_reading import Reading, without_result
from .records import clear_keys, keep_record, record_of
from .result_writing import clear_results


def add_result_object(obj: bpy.types.Object, reading: Reading) -> bpy.types.Object:
    """Add an object with a copy of a mesh, as it was read, beside the one that it was read from.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode.
    reading : Reading
        What was read: the mesh itself, or what modifiers show.

    Returns
    -------
    bpy.types.Object
        The new object, in the same place and collections, without modifiers and shape keys.
    """
    if reading.deformed:
        with without_result(obj.data):
            graph = bpy.context.evaluated_depsgraph_get()
            mesh = bpy.data.meshes.new_from_object(
                obj.evaluated_get(graph), preserve_all_data_layers=True, depsgraph=graph
            )
    else:
        mesh = obj.data.copy()
    name = f"{obj.name} Canonical Form"
    mesh.name = name
    added = bpy.data.objects.new(name, mesh)
    open_ones = [each for each in obj.users_collection if each.library is None and each.override_library is None]
    for collection in open_ones or [bpy.context.scene.collection]:
        collection.objects.link(added)
    for own, slot in zip(added.material_slots, obj.material_slots, strict=False):
        if slot.link == "OBJECT":
            own.link, own.material = "OBJECT", slot.material
    added.matrix_world = obj.matrix_world
    record = record_of(obj.data)
    if record is not None:  # an earlier result came along
        for kind in ("key", "groups", "colours"):
            record[kind] = dict.fromkeys(record[kind])
        record.pop("between", None)
        keep_record(mesh, record)
        clear_results(added)
    if mesh.shape_keys is not None:
        clear_keys(added)
    mesh.vertices.foreach_set("co", reading.vertices.astype(np.float32).ravel())
    mesh.update()
    return added
