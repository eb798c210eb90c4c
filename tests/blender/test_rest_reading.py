"""A rig at rest tells what belongs together; afterwards it is posed as before."""

import bpy
import numpy as np
import pytest
from mathutils import Matrix

import addon.core.limbs as limbs
from addon.blender.objects import rest_reading
from addon.blender.objects.combining import combined, touching
from addon.blender.objects.mesh_reading import read_object
from addon.blender.objects.rest_reading import with_rests
from addon.blender.records.record import require_record
from addon.core import CanonicalFormError
from addon.core.assembly.bodies import bodies_of
from tests.blender.characters import activate, run
from tests.blender.conftest import add_object
from tests.meshes import shapes


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


def test_limbs_and_in_betweens_are_of_the_body_of_the_run(pulled_off, character, monkeypatch):
    rests, shapes_of = [], limbs.limb_shapes

    def noted(*some, rest=None, **more):
        rests.append(rest)
        return shapes_of(*some, rest=rest, **more)

    monkeypatch.setattr(limbs, "limb_shapes", noted)
    activate(*character.values())
    run(mesh="SHOWN", objects="TOUCHING")
    activate(character["trunk"])
    assert bpy.ops.object.canonical_form_limb(patch=1) == {"FINISHED"}
    assert bpy.ops.object.canonical_form_in_betweens(count=1) == {"FINISHED"}
    assert len(rests) == 2
    activate(*character.values())
    assert run(mesh="SHOWN", objects="TOUCHING") == {"FINISHED"}  # which computes the in-betweens again
    assert len(rests) == 3
    assert all(rest is not None for rest in rests)
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

    monkeypatch.setattr(rest_reading, "read_shown", refuses)
    reading = read_object(character["head"], True)
    with pytest.raises(MemoryError):
        with_rests([character["head"]], [reading])
    assert pulled_off.data.pose_position == "POSE"


@pytest.mark.parametrize("at_rest", ["other vertices", "nothing"])
def test_a_mesh_that_is_another_at_rest_has_no_rest(at_rest, pulled_off, character, monkeypatch):
    reading = read_object(character["head"], True)

    def read(_):
        if at_rest == "nothing":
            raise CanonicalFormError("no faces")
        return reading.vertices[1:], reading.faces

    monkeypatch.setattr(rest_reading, "read_shown", read)
    assert with_rests([character["head"]], [reading])[0].rest is None


def test_a_mesh_of_other_polygons_at_rest_has_no_rest(figure_object):
    """A modifier that reduces a mesh in its pose leaves as many vertices, but others."""
    rig = a_rig("All")
    figure_object.vertex_groups.new(name="All").add(range(300), 1.0, "REPLACE")
    figure_object.modifiers.new("Armature", "ARMATURE").object = rig
    figure_object.modifiers.new("Fewer", "DECIMATE").ratio = 0.5
    rig.pose.bones["All"].matrix = Matrix.Rotation(1.0, 4, "X") @ rig.pose.bones["All"].matrix
    bpy.context.view_layer.update()
    (reading,) = readings(figure_object)
    assert reading.rest is None


def test_quads_whose_triangles_depend_on_the_pose_have_a_rest(blender):
    """The pose makes a dart of a square, which is cut along its other diagonal."""
    mesh = bpy.data.meshes.new("Square")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [], [(0, 1, 2, 3)])
    obj = bpy.data.objects.new("Square", mesh)
    bpy.context.scene.collection.objects.link(obj)
    rig = a_rig("Corner", "Rest")
    for name, own in (("Corner", [1]), ("Rest", [0, 2, 3])):
        obj.vertex_groups.new(name=name).add(own, 1.0, "REPLACE")
    obj.modifiers.new("Armature", "ARMATURE").object = rig
    rig.pose.bones["Corner"].matrix = Matrix.Translation((-0.8, 0.8, 0)) @ rig.pose.bones["Corner"].matrix
    bpy.context.view_layer.update()
    (reading,) = readings(obj)
    assert not np.array_equal(reading.faces, read_object(obj).faces)
    assert reading.rest is not None


def test_seams_under_a_subdivision_stay_closed(blender, arrays):
    obj = add_object("Figure", *shapes.cut_along_seams(*arrays))
    rig = a_rig("All")
    obj.vertex_groups.new(name="All").add(range(len(obj.data.vertices)), 1.0, "REPLACE")
    obj.modifiers.new("Armature", "ARMATURE").object = rig
    obj.modifiers.new("Finer", "SUBSURF").levels = 1
    rig.pose.bones["All"].matrix = Matrix.Rotation(1.0, 4, "X") @ rig.pose.bones["All"].matrix
    bpy.context.view_layer.update()
    (reading,) = readings(obj)
    assert reading.rest is not None
    assert len(bodies_of(reading.rest, reading.faces).pieces.pieces) == 1


def test_cloth_is_not_put_to_rest(pulled_off, character):
    character["shirt"].modifiers.new("Cloth", "CLOTH")
    bpy.context.view_layer.update()
    assert [each.rest for each in readings(character["trunk"], character["shirt"])] == [None, None]


@pytest.mark.parametrize("kind", ["CHILD_OF", "ARMATURE"])
def test_constraints_tie_an_object_to_a_rig(kind, pulled_off, character):
    head, trunk = character["head"], character["trunk"]
    trunk.parent = None
    tie = trunk.constraints.new(kind)
    if kind == "ARMATURE":
        target = tie.targets.new()
        target.target, target.subtarget = pulled_off, "Hips"
    else:
        tie.target, tie.subtarget = pulled_off, "Hips"
    bpy.context.view_layer.update()
    assert all(each.rest is not None for each in readings(head, trunk))
    modelled = [read_object(obj) for obj in (head, trunk)]  # whose constraints still hold
    assert [each.rest for each in with_rests([head, trunk], modelled)] == [None, None]
    tie.mute = True
    bpy.context.view_layer.update()
    assert [each.rest for each in readings(head, trunk)] == [None, None]


def test_a_form_fits_itself_as_a_reference(pulled_off, character):
    """Its features are those of the rig's rest, so that bodies and numbers are the same."""
    pulled_off.pose.bones["Neck"].location = (0, 0, 0)
    for name in ("shirt", "eye", "hand"):
        bpy.data.objects.remove(character[name])
    head, trunk = character["head"], character["trunk"]
    matrix = head.matrix_world.copy()
    matrix.translation.z += 0.12  # floats: one body only by its rig
    head.matrix_world = matrix
    bpy.context.view_layer.update()
    activate(trunk, head)
    assert run(objects="TOUCHING") == {"FINISHED"}
    first = require_record(trunk.data).report
    assert run(objects="TOUCHING", reference="trunk") == {"FINISHED"}
    second = require_record(trunk.data).report
    assert first.objects == second.objects == ["trunk", "head"]
    assert first.feature_points == second.feature_points
    assert not [each for each in second.warnings if "reference" in each]
