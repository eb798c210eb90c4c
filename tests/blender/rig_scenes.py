"""Scenes with bodies that *Rig* gives an armature, and how they look."""

from typing import Any

import bpy
import numpy as np

from addon.blender.records.rig_record import read_rig
from addon.blender.rigging.rig_clearing import armature_given_to
from tests.blender.conftest import QUICK, add_object, snapshot

RIG: dict[str, Any] = {**QUICK, "anyway": True}


def shown(obj):
    """Positions in the scene, with modifiers."""
    bpy.context.view_layer.update()
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    points = np.empty((len(mesh.vertices), 3), dtype=np.float32)
    mesh.vertices.foreach_get("co", points.ravel())
    place = np.array(obj.matrix_world)
    return points @ place[:3, :3].T + place[:3, 3]


def record_of(obj):
    record = read_rig(obj.data)
    assert record is not None
    return record


def armature_of(obj):
    armature = armature_given_to(obj)
    assert armature is not None
    return armature


def act(armature, name):
    """Put an armature into a pose of the asset browser."""
    armature.animation_data_create().action = bpy.data.actions[name]
    if hasattr(armature.animation_data, "action_slot") and armature.animation_data.action_slot is None:
        armature.animation_data.action_slot = bpy.data.actions[name].slots[0]
    bpy.context.scene.frame_set(1)


def scene():
    """Name everything in the file, with what may change of it."""
    bpy.context.view_layer.update()
    return {
        "objects": {o.name: (o.parent and o.parent.name, [*map(tuple, o.matrix_world)], o.select_get(),
                             o.modifiers.keys()) for o in bpy.data.objects},
        "meshes": {o.name: snapshot(o) for o in bpy.data.objects if o.type == "MESH"},
        "active": bpy.context.view_layer.objects.active.name,
        "data": [sorted(kind.keys()) for kind in (bpy.data.meshes, bpy.data.armatures, bpy.data.actions)],
    }  # fmt: skip


def rigged_halves(lender):
    """A posed character of two objects, above and below the belt, both moved by the armature "Rig"."""
    armature = add_armature(lender.skeleton)
    upper = lender.vertices[:, 2] > 0.95
    halves = [(name, mine[lender.faces].all(axis=1)) for name, mine in (("Upper", upper), ("Lower", ~upper))]
    halves[1] = ("Lower", ~halves[0][1])
    objects = [_bound_part(name, lender, lender.faces[mine], armature) for name, mine in halves]
    for name, angle in (("upper_arm.L", 0.5), ("forearm.L", 0.6), ("thigh.R", -0.5), ("shin.R", 0.6)):
        bone = armature.pose.bones[name]
        bone.rotation_mode = "XYZ"
        bone.rotation_euler.x = angle
    bpy.context.view_layer.update()
    return objects, armature


def add_armature(skeleton):
    """An armature called "Rig" with the bones of a skeleton."""
    armature = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    bpy.context.scene.collection.objects.link(armature)
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    bones = [armature.data.edit_bones.new(name) for name in skeleton.names]
    for bone, parent, head, tail in zip(bones, skeleton.parents, skeleton.heads, skeleton.tails, strict=True):
        bone.head, bone.tail = head.tolist(), tail.tolist()
        bone.parent = None if parent < 0 else bones[parent]
    bpy.ops.object.mode_set(mode="OBJECT")
    return armature


def _bound_part(name, lender, faces, armature):
    """An object of some faces of a rigged body."""
    used, corners = np.unique(faces, return_inverse=True)
    obj = add_object(name, lender.vertices[used], corners.reshape(-1, 3))
    for bone, weights in zip(lender.skeleton.names, lender.weights[used].T, strict=True):
        group = obj.vertex_groups.new(name=bone)
        for vertex in np.flatnonzero(weights > 1e-3).tolist():
            group.add([vertex], float(weights[vertex]), "REPLACE")
    obj.modifiers.new("Armature", "ARMATURE").object = armature
    obj.parent = armature
    return obj
