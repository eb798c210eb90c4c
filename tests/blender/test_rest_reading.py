"""A rig at rest tells what belongs together; afterwards it is posed as before."""

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from addon.blender.objects import rest_reading
from addon.blender.objects.combining import combined, touching
from addon.blender.objects.mesh_reading import read_object
from addon.blender.objects.rest_reading import with_rests
from addon.blender.records.record import require_record
from tests.blender.characters import activate, run


def a_rig(*names):
    """An armature with a bone of each name."""
    rig = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for name in names:
        bone = rig.data.edit_bones.new(name)
        bone.head, bone.tail = (0, 0, 1), (0, 0.5, 1.5)
    bpy.ops.object.mode_set(mode="OBJECT")
    rig.location = (0.5, 0, 0.25)
    return rig


def on_bone(obj, rig, name):
    """Parent an object to a bone, and keep its place."""
    place = obj.matrix_world.copy()
    obj.parent, obj.parent_type, obj.parent_bone = rig, "BONE", name
    bpy.context.view_layer.update()
    obj.matrix_world = place
    bpy.context.view_layer.update()


def readings(*objects):
    return with_rests(objects, [read_object(obj, True) for obj in objects])


@pytest.fixture
def pulled_off(character):
    """A character whose head is on a bone, which has moved it away from the trunk."""
    rig = a_rig("Neck", "Hips")
    for name, obj in character.items():
        on_bone(obj, rig, "Neck" if name == "head" else "Hips")
    rig.pose.bones["Neck"].location = (0, 6, 0)
    bpy.context.view_layer.update()
    return rig


def test_objects_belong_together_as_at_rest(pulled_off, character):
    shown = readings(character["trunk"], character["head"])
    assert len(touching(shown, together=True)) == 1
    assert len(touching([each._replace(rest=None) for each in shown], together=True)) == 2
    pose = pulled_off.pose.bones["Neck"].matrix.copy()
    activate(*character.values())
    assert run(mesh="SHOWN", objects="TOUCHING") == {"FINISHED"}
    report = require_record(character["trunk"].data).report
    assert sorted(report.objects) == sorted(character)
    assert not [each for each in report.warnings if "bodies" in each]
    assert pulled_off.data.pose_position == "POSE"
    assert pulled_off.pose.bones["Neck"].matrix == pose


def test_limbs_are_chosen_on_the_body_of_the_run(pulled_off, character):
    activate(*character.values())
    run(mesh="SHOWN", objects="TOUCHING")
    activate(character["trunk"])
    assert bpy.ops.object.canonical_form_limb(patch=1) == {"FINISHED"}
    assert bpy.ops.object.canonical_form_in_betweens(count=1) == {"FINISHED"}
    assert pulled_off.data.pose_position == "POSE"


def test_the_rest_of_an_object_on_a_bone_is_where_it_was(pulled_off, character):
    parts = [character["trunk"], character["head"]]
    whole = combined(readings(*parts))
    pulled_off.pose.bones["Neck"].location = (0, 0, 0)
    bpy.context.view_layer.update()
    assert whole.rest is not None
    np.testing.assert_allclose(whole.rest, combined([read_object(obj, True) for obj in parts]).vertices, atol=1e-5)
    assert np.abs(whole.vertices - whole.rest).max() > 3


def test_the_rest_of_a_mesh_with_an_armature_modifier_is_the_mesh(figure_object):
    rig = a_rig("All")
    obj = figure_object
    obj.vertex_groups.new(name="All").add(range(len(obj.data.vertices)), 1.0, "REPLACE")
    obj.modifiers.new("Armature", "ARMATURE").object = rig
    rig.pose.bones["All"].matrix = Matrix.Rotation(1.0, 4, "X") @ rig.pose.bones["All"].matrix
    bpy.context.view_layer.update()
    (reading,) = readings(obj)
    base = read_object(obj).vertices
    assert reading.rest is not None
    np.testing.assert_allclose(reading.rest, base, atol=1e-5)
    assert np.abs(reading.vertices - base).max() > 0.5


@pytest.mark.parametrize("state", ["no rig", "two rigs"])
def test_there_is_no_rest_unless_one_rig_moves_them_all(state, pulled_off, character):
    head, trunk = character["head"], character["trunk"]
    trunk.parent = None if state == "no rig" else a_rig("Other")  # such as a floor, or another character
    assert [each.rest for each in readings(head, trunk)] == [None, None]
    assert pulled_off.data.pose_position == "POSE"


@pytest.mark.parametrize("state", ["at rest", "as modelled"])
def test_meshes_at_rest_are_their_own_rest(state, pulled_off, character):
    if state == "at rest":
        pulled_off.data.pose_position = "REST"
    both = [character["head"], character["trunk"]]
    found = with_rests(both, [read_object(obj, state == "at rest") for obj in both])
    assert all(each.rest is each.vertices for each in found)
    assert len(touching(found, together=True)) == 1
    assert pulled_off.data.pose_position == ("REST" if state == "at rest" else "POSE")


def test_the_pose_is_back_after_an_error(pulled_off, character, monkeypatch):
    def refuses(_):
        raise MemoryError

    monkeypatch.setattr(rest_reading, "read_evaluated", refuses)
    reading = read_object(character["head"], True)
    with pytest.raises(MemoryError):
        with_rests([character["head"]], [reading])
    assert pulled_off.data.pose_position == "POSE"


def test_a_mesh_that_has_other_vertices_at_rest_has_no_rest(pulled_off, character, monkeypatch):
    reading = read_object(character["head"], True)
    monkeypatch.setattr(rest_reading, "read_evaluated", lambda _: (reading.vertices[1:], reading.faces))
    assert with_rests([character["head"]], [reading])[0].rest is None
