"""Scenes with bodies that *Rig* gives an armature, and how they look."""

from typing import Any

import bpy
import numpy as np

from addon.blender.records.rig_record import read_rig
from addon.blender.rigging.rig_clearing import armature_given_to
from tests.blender.conftest import QUICK, snapshot

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
