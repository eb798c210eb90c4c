"""Copies of linked, overridden and instanced meshes, which can be computed where nothing is written into their file."""

from __future__ import annotations

import bpy
from mathutils import Matrix


def copy_foreign_meshes() -> None:
    """Put a copy in the place of each mesh object of the scene that is linked, overridden or an instance.

    The copies have the names, modifiers and places of what they copy. Instances are those of collections, and of
    points, as .usd files have them; what only they show is no longer in the scene itself.
    """
    foreign = [obj for obj in bpy.data.objects if obj.type == "MESH" and obj.users_scene and _is_foreign(obj)]
    graph = bpy.context.evaluated_depsgraph_get()
    instanced = [
        (each.object.original, each.matrix_world.copy())
        for each in graph.object_instances
        if each.is_instance and each.object.type == "MESH" and _places_objects(each.parent.original)
    ]
    shown = {each.object.original for each in graph.object_instances if not each.is_instance}
    names = {obj: obj.name for obj, _ in instanced}
    for obj in foreign:
        if obj.library is None:  # an override has its name in this file
            name, obj.name = obj.name, "Original"
        else:
            name = obj.name
        _copied(obj, name, obj.matrix_world.copy())
        _leave_scene(obj)
    for obj in names:
        if obj.library is None and obj not in shown:
            obj.name = "Original"
            _leave_scene(obj)
    for obj, place in instanced:
        _copied(obj, names[obj], place)
    bpy.context.view_layer.update()


def _places_objects(obj: bpy.types.Object) -> bool:
    """Return whether the instances of an object are meant as objects, not as hair or grass on it."""
    return obj.instance_type == "COLLECTION" or obj.type == "POINTCLOUD"


def _leave_scene(obj: bpy.types.Object) -> None:
    """Take an object out of all collections of this file."""
    for collection in obj.users_collection:
        if collection.library is None:
            collection.objects.unlink(obj)


def _is_foreign(obj: bpy.types.Object) -> bool:
    """Return whether an object or its mesh belongs to another file."""
    return any(each.library is not None or each.override_library is not None for each in (obj, obj.data))


def _copied(obj: bpy.types.Object, name: str, place: Matrix) -> None:
    """Add a copy of an object to the scene."""
    copy = obj.copy()
    copy.data = obj.data.copy()
    copy.name, copy.data.name = name, obj.data.name
    bpy.context.scene.collection.objects.link(copy)
    copy.constraints.clear()  # the place has them
    if copy.parent is None or copy.parent_type == "OBJECT":
        copy.parent = None
        copy.matrix_world = place
