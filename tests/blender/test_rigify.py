"""Rigify's rig on the bones of a body."""

import bpy
import numpy as np
import pytest

from addon.blender.rigging.made_data import MARK
from addon.interface.rig_panel import VIEW3D_PT_canonical_form_rig
from tests.blender.conftest import add_object, drawn
from tests.blender.rig_scenes import RIG, act, armature_of, scene, shown


@pytest.fixture
def rigify(blender):
    """Rigify, switched on; switched off, it leaves a handler that fails on every file, in Blender 5.0."""
    handlers = bpy.app.handlers.load_post
    before = list(handlers)
    bpy.ops.preferences.addon_enable(module="rigify")
    yield
    bpy.ops.preferences.addon_disable(module="rigify")
    for each in [handler for handler in handlers if handler not in before]:
        handlers.remove(each)


def made():
    """Name everything that carries our mark."""
    kinds = (bpy.data.objects, bpy.data.armatures, bpy.data.meshes, bpy.data.collections, bpy.data.texts)
    return [each.name for kind in kinds for each in kind if MARK in each]


@pytest.mark.parametrize("rest", ["NONE", "T"])
def test_its_rig_moves_nothing_at_rest_and_is_removed_whole(rigify, body, rest):
    before = scene()
    bpy.ops.object.canonical_form_rig(**RIG, rest="NONE")
    plain = shown(body)
    bpy.ops.object.canonical_form_rig(**RIG, rest=rest)
    there = shown(body) if rest == "T" else plain
    bpy.ops.object.canonical_form_rig(**RIG, rest=rest, rigify=True)
    assert np.abs(shown(body) - there).max() < 1e-5
    armature = armature_of(body)
    assert {"torso", "hand_ik.L", "foot_ik.R", "DEF-forearm.L"} <= set(armature.data.bones.keys())
    assert {group.name for group in body.vertex_groups if group.name != "Mine"} <= set(armature.data.bones.keys())
    assert sorted(each.name for each in bpy.data.actions) == (["Scan", "T-Pose"] if rest == "T" else [])
    assert made()
    bpy.ops.object.canonical_form_rig_clear()
    assert made() == []
    assert scene() == before


def test_it_stands_where_the_body_stands(rigify, body):
    body.location = (5.0, 3.0, -1.0)
    bpy.context.view_layer.update()
    bpy.ops.object.canonical_form_rig(**RIG, rest="NONE")
    plain = armature_of(body)
    places = {bone.name: plain.matrix_world @ bone.head_local for bone in plain.data.bones}
    bpy.ops.object.canonical_form_rig(**RIG, rest="NONE", rigify=True)
    armature = armature_of(body)
    for name, place in places.items():
        assert (armature.matrix_world @ armature.data.bones[f"DEF-{name}"].head_local - place).length < 1e-4, name


def test_its_controls_reach_the_scan(rigify, body, scan):
    bpy.ops.object.canonical_form_rig(**RIG, rest="T", rigify=True)
    armature, there = armature_of(body), shown(body)
    drivers = len(armature.animation_data.drivers)
    assert drivers > 10
    act(armature, "Scan")
    assert armature.pose.bones["upper_arm_parent.L"]["IK_FK"] == 1.0
    assert np.abs(shown(body) - scan).max() < 5e-3
    act(armature, "T-Pose")
    assert np.abs(shown(body) - there).max() < 1e-4
    assert len(armature.animation_data.drivers) == drivers
    armature.animation_data.action = None
    for posed, wanted in ((True, scan), (False, there)):
        bpy.ops.object.canonical_form_rig_pose(scan=posed)
        bpy.context.view_layer.update()
        assert np.abs(shown(body) - wanted).max() < (5e-3 if posed else 1e-4)


def test_the_rig_lies_in_the_collections_of_the_body(rigify, body):
    """Rigify puts its rig into the active collection, which is hardly ever that of the scene."""
    own, other = (bpy.data.collections.new(name) for name in ("Bodies", "Props"))
    for collection in (own, other):
        bpy.context.scene.collection.children.link(collection)
    own.objects.link(body)
    bpy.context.scene.collection.objects.unlink(body)
    for active in (own, other):
        layer = bpy.context.view_layer
        layer.active_layer_collection = layer.layer_collection.children[active.name]
        before = scene()
        assert bpy.ops.object.canonical_form_rig(**RIG, rest="NONE", rigify=True) == {"FINISHED"}
        assert armature_of(body).users_collection == (own,)
        assert bpy.ops.object.canonical_form_rig_clear() == {"FINISHED"}
        assert scene() == before


def widgets(armature):
    """The shapes of the controls."""
    return [bone.custom_shape for bone in armature.pose.bones if bone.custom_shape is not None]


def test_rigs_share_no_widgets(rigify, body, scan, lender):
    """Neither with another body's rig nor with one that the user has generated."""
    other = add_object("Two", scan, lender.faces)
    for obj in (body, other):
        bpy.context.view_layer.objects.active = obj
        for each in (body, other):
            each.select_set(each == obj)
        assert bpy.ops.object.canonical_form_rig(**RIG, rest="NONE", rigify=True) == {"FINISHED"}
    bpy.ops.object.armature_basic_human_metarig_add()
    metarig = bpy.context.view_layer.objects.active
    bpy.ops.pose.rigify_generate()
    own = metarig.data.rigify_target_rig
    before = len(widgets(armature_of(other))), len(widgets(own))
    assert min(before) > 60
    assert not {*widgets(armature_of(other))} & {*widgets(own)}
    bpy.context.view_layer.objects.active = body
    assert bpy.ops.object.canonical_form_rig_clear() == {"FINISHED"}
    assert (len(widgets(armature_of(other))), len(widgets(own))) == before


@pytest.mark.parametrize("state", ["hide_viewport", "hide_select"])
def test_collections_that_are_off_or_locked_are_no_hindrance(rigify, body, state):
    own = bpy.data.collections.new("Bodies")
    bpy.context.scene.collection.children.link(own)
    layer = bpy.context.view_layer
    if state == "hide_viewport":  # the body's; else that which is active
        own.objects.link(body)
        bpy.context.scene.collection.objects.unlink(body)
    layer.active_layer_collection = layer.layer_collection.children["Bodies"]
    setattr(own, state, True)
    active = layer.active_layer_collection
    layer.objects.active = body
    assert bpy.ops.object.canonical_form_rig(**RIG, rest="T", rigify=True) == {"FINISHED"}
    assert {"Scan", "T-Pose"} <= set(bpy.data.actions.keys())
    assert layer.active_layer_collection == active
    assert armature_of(body).users_collection == body.users_collection


def test_knees_bend_forward_and_feet_stay(rigify, body):
    bpy.ops.object.canonical_form_rig(**RIG, rest="T", rigify=True)
    armature = armature_of(body)
    knee, foot = armature.pose.bones["DEF-shin.L"], armature.pose.bones["DEF-foot.L"]
    bpy.context.view_layer.update()
    before = knee.head.copy(), foot.head.copy()
    armature.pose.bones["torso"].location.z = -0.15
    bpy.context.view_layer.update()
    assert knee.head.y < before[0].y - 0.1
    assert abs(knee.head.x - before[0].x) < 0.06
    assert (foot.head - before[1]).length < 0.01


def test_it_must_be_switched_on(body):
    if "rigify" in bpy.context.preferences.addons:
        bpy.ops.preferences.addon_disable(module="rigify")
    before = scene()
    with pytest.raises(RuntimeError, match="Rigify is switched off"):
        bpy.ops.object.canonical_form_rig(**RIG, rigify=True)
    assert scene() == before
    assert "rig_rigify" in drawn(VIEW3D_PT_canonical_form_rig)
