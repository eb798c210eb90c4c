"""A rigged character stands in a T-pose by its own bones: shown or as modelled, of one object or more."""

import json

import bpy
import numpy as np
import pytest

from addon.blender.records.form_report import FormReport
from addon.blender.records.record import require_record
from addon.core import Skeleton, mannequin
from addon.interface import research_panel
from tests.blender.characters import activate
from tests.blender.conftest import QUICK, add_object, drawn
from tests.blender.test_rest_reading import a_rig
from tests.core.rigging.conftest import hand_drawn


def armature(skeleton: Skeleton) -> bpy.types.Object:
    """Make an armature of a skeleton."""
    rig = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for name, above, head, tail in zip(*skeleton[:2], skeleton.heads, skeleton.tails, strict=True):
        bone = rig.data.edit_bones.new(name)
        bone.head, bone.tail = head, tail
        bone.parent = rig.data.edit_bones[skeleton.names[above]] if above >= 0 else None
    bpy.ops.object.mode_set(mode="OBJECT")
    return rig


def beads(skeleton: Skeleton, chosen: list[int]):
    """A tetrahedron around the middle of each bone, with the bone that it is on."""
    corners = 0.04 * np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1.0]])
    faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
    middles = (skeleton.heads + skeleton.tails)[chosen] / 2
    vertices = (middles[:, None] + corners).reshape(-1, 3)
    return vertices, np.concatenate([faces + 4 * number for number in range(len(chosen))]), np.repeat(chosen, 4)


def skin(name: str, rig: bpy.types.Object, skeleton: Skeleton, chosen: list[int]) -> bpy.types.Object:
    vertices, faces, bones = beads(skeleton, chosen)
    obj = add_object(name, vertices, faces)
    for bone in chosen:
        obj.vertex_groups.new(name=skeleton.names[bone]).add(np.flatnonzero(bones == bone).tolist(), 1.0, "REPLACE")
    obj.modifiers.new("Armature", "ARMATURE").object = rig
    obj.parent = rig
    return obj


def bend(rig: bpy.types.Object) -> None:
    for name, angles in (("upper_arm.L", (0.5, 0, 0.4)), ("forearm.R", (1.2, 0, 0)), ("thigh.L", (-0.8, 0, 0.2))):
        bone = rig.pose.bones[name]
        bone.rotation_mode, bone.rotation_euler = "XYZ", angles
    bpy.context.view_layer.update()


def pose_of(rig: bpy.types.Object):
    return [[list(row) for row in bone.matrix] for bone in rig.pose.bones], rig.data.pose_position


def shown(obj: bpy.types.Object) -> np.ndarray:
    bpy.context.view_layer.update()
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    return np.array([list(obj.matrix_world @ each.co) for each in mesh.vertices])


def directions(skeleton: Skeleton, points: np.ndarray, bones: np.ndarray, upper: str, end: str):
    """Ways from the upper segment to the end, left and right."""
    at = skeleton.names.index
    found = []
    for side in "LR":
        ends = [points[bones == at(f"{name}.{side}")].mean(axis=0) for name in (upper, end)]
        found.append((ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0]))
    return np.array(found)


def stand(*objects: bpy.types.Object, **options) -> None:
    activate(*objects)
    bpy.ops.object.canonical_form_pose_like(**{**QUICK, "pose": "T", **options})


@pytest.fixture
def character_rig(blender):
    skeleton = hand_drawn(arms=50, knee=30)
    rig = armature(skeleton)
    bend(rig)
    return rig, skeleton


@pytest.mark.parametrize("mesh", ["SHOWN", "BASE"])
def test_arms_are_level_and_legs_straight_and_the_rig_stays(character_rig, mesh):
    rig, skeleton = character_rig
    everything = list(range(len(skeleton.names)))
    obj = skin("Body", rig, skeleton, everything)
    before = pose_of(rig)
    stand(obj, mesh=mesh)
    assert pose_of(rig) == before
    key = obj.data.shape_keys.key_blocks["T-Pose"]
    points = shown(obj) if mesh == "SHOWN" else np.array([list(each.co) for each in key.data])
    bones = np.repeat(everything, 4)
    assert np.allclose(directions(skeleton, points, bones, "upper_arm", "hand"), [[1, 0, 0], [-1, 0, 0]], atol=1e-3)
    legs = directions(skeleton, points, bones, "thigh", "shin")
    assert np.allclose(np.abs(legs[:, 1:]), [0, 1], atol=0.02)
    report = require_record(obj.data).report
    assert report.like is not None
    assert report.like.source == "bones"
    assert [group.name for group in obj.vertex_groups] == skeleton.names
    assert not obj.data.color_attributes
    assert any("bones of its rig" in text for text in drawn(research_panel.VIEW3D_PT_canonical_form_research))


def test_objects_on_bones_and_in_groups_stand_as_one(character_rig):
    rig, skeleton = character_rig
    at = skeleton.names.index
    rest = [bone for bone in range(len(skeleton.names)) if bone != at("hand.L")]
    body = skin("Body", rig, skeleton, rest)
    vertices, faces, _ = beads(skeleton, [at("hand.L")])
    hand = add_object("Hand", vertices, faces)
    rig.data.pose_position = "REST"
    bpy.context.view_layer.update()
    hand.parent, hand.parent_type, hand.parent_bone = rig, "BONE", "hand.L"
    bpy.context.view_layer.update()
    hand.matrix_world = np.eye(4).tolist()
    rig.data.pose_position = "POSE"
    stand(body, hand, mesh="SHOWN", objects="TOGETHER")
    points = np.vstack([shown(body), shown(hand)])
    bones = np.concatenate([np.repeat(rest, 4), np.repeat(at("hand.L"), 4)])
    assert np.allclose(directions(skeleton, points, bones, "upper_arm", "hand"), [[1, 0, 0], [-1, 0, 0]], atol=1e-3)


def test_vertices_that_modifiers_make_stand_too(character_rig):
    rig, skeleton = character_rig
    everything = list(range(len(skeleton.names)))
    obj = skin("Body", rig, skeleton, everything)
    obj.modifiers.new("Subdivision", "SUBSURF").subdivision_type = "SIMPLE"
    obj.modifiers.move(1, 0)
    stand(obj, mesh="SHOWN", result="OBJECT")
    (made,) = (each for each in bpy.data.objects if each.name.startswith("Body T-Pose"))
    points = shown(made)
    hands = points[np.argsort(points[:, 0])[[0, -1]]]
    assert len(points) > 4 * len(everything)
    assert hands[1, 0] - hands[0, 0] > 1.6
    assert abs(hands[1, 2] - hands[0, 2]) < 0.1


def test_bones_that_tell_nothing_are_told_and_a_match_takes_over(blender):
    rig = a_rig("Bone")
    obj = add_object("Figure", *mannequin(40.0))
    obj.vertex_groups.new(name="Bone").add(list(range(len(obj.data.vertices))), 1.0, "REPLACE")
    obj.modifiers.new("Armature", "ARMATURE").object = rig
    stand(obj, anyway=True)
    report = require_record(obj.data).report
    assert report.like is not None
    assert report.like.source == "match"
    assert any("bones of Rig could not give the pose" in each for each in report.warnings)
    assert {"hand.L", "spine.006", "toe.R"} <= set(report.like.bones)
    assert all(0 <= sure <= 1 for sure in report.like.bones.values())
    assert FormReport.from_json(json.loads(json.dumps(report.as_json()))) == report


def test_a_way_to_match_that_is_asked_for_is_matched(character_rig):
    rig, skeleton = character_rig
    obj = skin("Body", rig, skeleton, list(range(len(skeleton.names))))
    with pytest.raises(RuntimeError, match="only 6% of the mesh"):  # beads are no body
        stand(obj, side=0)
    assert obj.data.shape_keys is None


def two_characters(character_rig):
    rig, skeleton = character_rig
    everything = list(range(len(skeleton.names)))
    one = skin("Body", rig, skeleton, everything)
    second = armature(skeleton)
    second.name = "Second"
    second.location = (4, 0, 0)
    bend(second)
    return one, skin("Other Body", second, skeleton, everything)


@pytest.mark.parametrize("mesh", ["SHOWN", "BASE"])
def test_each_of_several_characters_stands_by_its_own_bones(character_rig, mesh):
    one, other = two_characters(character_rig)
    stand(one, other, mesh=mesh, objects="TOUCHING", pieces="apart")
    for obj in (one, other):
        like = require_record(obj.data).report.like
        assert like is not None
        assert like.source == "bones"


def test_what_shows_a_rigged_body_with_something_else_is_told(character_rig):
    one, other = two_characters(character_rig)
    stand(one, other, mesh="SHOWN", objects="TOGETHER", anyway=True)
    report = require_record(one.data).report
    assert any("bones of Rig, Second could not give the pose" in each for each in report.warnings)


def test_a_stance_as_shown_stays_where_the_character_is(character_rig):
    rig, skeleton = character_rig
    obj = skin("Body", rig, skeleton, list(range(len(skeleton.names))))
    rig.pose.bones["hips"].location = (0, 3, 0)
    before = shown(obj).mean(axis=0)
    stand(obj, mesh="SHOWN")
    assert np.allclose(shown(obj).mean(axis=0), before, atol=1e-3)


def test_a_scale_of_zero_is_told(character_rig):
    rig, skeleton = character_rig
    obj = skin("Body", rig, skeleton, list(range(len(skeleton.names))))
    obj.scale.x = 0
    with pytest.raises(RuntimeError, match="scale of 0"):
        stand(obj)


def test_a_mirrored_rig_does_not_tell_left_from_right(character_rig):
    rig, skeleton = character_rig
    rig.scale.x = -1
    obj = skin("Body", rig, skeleton, list(range(len(skeleton.names))))
    stand(obj, mesh="SHOWN", anyway=True)
    like = require_record(obj.data).report.like
    assert like is not None
    assert like.source == "match"


def test_a_turned_rig_faces_the_front(character_rig):
    rig, skeleton = character_rig
    rig.rotation_euler.z = np.radians(25)
    everything = list(range(len(skeleton.names)))
    obj = skin("Body", rig, skeleton, everything)
    stand(obj, mesh="SHOWN")
    points, bones = shown(obj), np.repeat(everything, 4)
    shoulders = [points[bones == skeleton.names.index(f"shoulder.{side}")].mean(axis=0) for side in "LR"]
    way = shoulders[0] - shoulders[1]
    assert abs(way[1]) < 1e-3 * abs(way[0])
