"""New objects for results that must not change the original mesh."""

from __future__ import annotations

import bpy
import numpy as np

from ..mesh_items.key_removal import remove_all_keys
from ..objects.mesh_reading import Reading
from ..objects.object_states import muted_results
from ..records.record import Record, read_record, write_record
from .result_clearing import clear_results


def add_result_object(obj: bpy.types.Object, reading: Reading, called: str) -> bpy.types.Object:
    """Add an object with a copy of another object's mesh, as it was read.

    Parameters
    ----------
    obj : bpy.types.Object
        The object, in Object Mode.
    reading : Reading
        The reading, of the base mesh or the evaluated one.
    called : str
        Suffix for the name of the new object.

    Returns
    -------
    bpy.types.Object
        The new object, with the same transform and collections, without modifiers and shape keys.
    """
    if reading.deformed:
        with muted_results([obj.data]):
            graph = bpy.context.evaluated_depsgraph_get()
            mesh = bpy.data.meshes.new_from_object(
                obj.evaluated_get(graph), preserve_all_data_layers=True, depsgraph=graph
            )
    else:
        mesh = obj.data.copy()
    added = linked_beside(obj, mesh, f"{obj.name} {called}")
    drop_results(added, read_record(obj.data))
    mesh.vertices.foreach_set("co", reading.vertices.astype(np.float32).ravel())
    mesh.update()
    return added


def drop_results(added: bpy.types.Object, record: Record | None) -> None:
    """Remove from a copy the results of the original, changed or not, and all shape keys.

    Parameters
    ----------
    added : bpy.types.Object
        An object with a copy of a mesh.
    record : Record or None
        The record of the original; None if it has no results.
    """
    mesh = added.data
    if record is not None:
        record.keys, record.groups, record.colours = map(dict.fromkeys, (record.keys, record.groups, record.colours))
        record.in_betweens = None
        write_record(mesh, record)
        clear_results(added, unconfirmed=True)
    if mesh.shape_keys is not None:
        remove_all_keys(added)


def linked_beside(obj: bpy.types.Object, mesh: bpy.types.Mesh, name: str) -> bpy.types.Object:
    """Add an object for a copy of another object's mesh.

    Parameters
    ----------
    obj : bpy.types.Object
        The other object.
    mesh : bpy.types.Mesh
        The copy.
    name : str
        Name of the new object and its mesh, if that is free.

    Returns
    -------
    bpy.types.Object
        The new object, with the same transform, materials and collections.
    """
    mesh.name = name
    added = bpy.data.objects.new(name, mesh)
    editable = [each for each in obj.users_collection if each.library is None and each.override_library is None]
    editable = [each for each in editable if each not in _of_rigid_bodies()]
    for collection in editable or [bpy.context.scene.collection]:
        collection.objects.link(added)
    for own, slot in zip(added.material_slots, obj.material_slots, strict=False):
        if slot.link == "OBJECT":
            own.link, own.material = "OBJECT", slot.material
    added.matrix_world = obj.matrix_world
    if obj.parent is not None and not np.allclose(added.matrix_basis, obj.matrix_world, atol=1e-6):  # sheared
        added.parent = obj.parent
        added.matrix_parent_inverse = obj.parent.matrix_world.inverted_safe() @ obj.matrix_world
        added.matrix_basis.identity()
    return added


def _of_rigid_bodies() -> list[bpy.types.Collection]:
    """Return the collections that make objects take part in the simulation of rigid bodies."""
    worlds = [scene.rigidbody_world for scene in bpy.data.scenes if scene.rigidbody_world is not None]
    return [each for world in worlds for each in (world.collection, world.constraints) if each is not None]


def make_active(added: list[bpy.types.Object]) -> None:
    """Select only the new objects, and make the first of them active.

    Parameters
    ----------
    added : list of bpy.types.Object
        The objects, in the view layer.
    """
    layer = bpy.context.view_layer
    visible = [obj for obj in added if obj.name in layer.objects and obj.visible_get()]
    if not visible:
        return
    for obj in layer.objects:
        obj.select_set(obj in visible)
    layer.objects.active = visible[0]
