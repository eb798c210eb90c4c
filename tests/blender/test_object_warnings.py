"""What bends or turns a form after the fact is told, and nothing else."""

import bpy
import numpy as np
import pytest

from addon.blender.records.record import require_record

from .conftest import QUICK


def two_bones(obj):
    """An armature whose upper bone has the upper half of an object, at rest."""
    rig = bpy.data.objects.new("Skeleton", bpy.data.armatures.new("Skeleton"))
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for name, start in (("Lower", -1), ("Upper", 0)):
        bone = rig.data.edit_bones.new(name)
        bone.head, bone.tail = (0, 0, start), (0, 0, start + 1)
    bpy.ops.object.mode_set(mode="OBJECT")
    above = [vertex.index for vertex in obj.data.vertices if vertex.co.z > 0]
    obj.vertex_groups.new(name="Upper").add(above, 1.0, "REPLACE")
    bpy.context.view_layer.objects.active = obj
    return rig


def constrained(obj, bend, folder):
    rig = two_bones(obj)
    obj.modifiers.new("Armature", "ARMATURE").object = rig
    aim = bpy.data.objects.new("Aim", None)
    bpy.context.scene.collection.objects.link(aim)
    aim.rotation_euler.x = 1.2
    constraint = rig.pose.bones["Upper"].constraints.new("COPY_ROTATION")
    constraint.target, constraint.mute = aim, not bend
    return "Armature"


def parented(obj, bend, folder):
    rig = two_bones(obj)
    obj.parent, obj.parent_type = rig, "ARMATURE"
    rig.pose.bones["Upper"].rotation_mode = "XYZ"
    rig.pose.bones["Upper"].rotation_euler.x = 1.2 if bend else 0.0
    return "Skeleton"


def cached(obj, bend, folder):
    points = np.array([vertex.co[:] for vertex in obj.data.vertices], dtype="<f4")
    head = b"POINTCACHE2\0" + np.array([1, len(points)], "<i4").tobytes()
    path = folder / "cache.pc2"
    path.write_bytes(head + np.array([0, 1], "<f4").tobytes() + np.array([1], "<i4").tobytes() + points.tobytes())
    modifier = obj.modifiers.new("Cache", "MESH_CACHE")
    modifier.cache_format, modifier.filepath, modifier.show_viewport = "PC2", str(path), bend
    return "Cache"


def smoothed(obj, bend, folder):
    modifier = obj.modifiers.new("Iron", "LAPLACIANSMOOTH")
    modifier.iterations, modifier.show_viewport = 5, bend
    return "Iron"


@pytest.mark.parametrize("bend", [True, False])
@pytest.mark.parametrize("state", [constrained, parented, cached, smoothed])
def test_what_bends_a_form_after_the_fact_is_told_and_nothing_else(state, bend, figure_object, tmp_path):
    name = state(figure_object, bend, tmp_path)
    bpy.context.view_layer.update()
    bpy.ops.object.canonical_form(**QUICK)
    warnings = require_record(figure_object.data).report.warnings
    assert any(f"pose that you see: {name} of" in each for each in warnings) == bend


@pytest.mark.parametrize("turned", [True, False])
def test_keys_that_push_the_wrong_way_on_a_turned_form_are_told(turned, figure_object):
    figure_object.shape_key_add(name="Basis")
    key = figure_object.shape_key_add(name="Bulge", from_mix=False)
    for place in key.data:
        if place.co.z > 0.5:
            place.co.x += 0.1
    figure_object.rotation_euler.y = 2.0 if turned else 0.0
    bpy.context.view_layer.update()
    bpy.ops.object.canonical_form(**QUICK, orientation="upright" if turned else "posed")
    told = [each for each in require_record(figure_object.data).report.warnings if "push as they did" in each]
    assert bool(told) == turned
    assert not turned or "Bulge" in told[0]
