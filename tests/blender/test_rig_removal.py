"""What *Remove Rig*, another *Rig* and failures leave: everything of the user, and nothing else."""

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from addon.blender.records.rig_record import RIG_PROPERTY
from addon.blender.rigging.made_data import MARK
from addon.blender.rigging.rig_reading import read_rig_source
from tests.blender.conftest import QUICK, add_object
from tests.blender.rig_scenes import RIG, act, armature_of, record_of, scene, shown


@pytest.mark.parametrize("rest", ["NONE", "T"])
def test_removing_leaves_everything_as_it_was(body, rest):
    body.location = (3.0, -2.0, 1.0)
    before = scene()
    bpy.ops.object.canonical_form_rig(**RIG, rest=rest)
    assert body.parent == armature_of(body)
    assert bpy.ops.object.canonical_form_rig_clear() == {"FINISHED"}
    assert scene() == before


def test_a_mesh_without_keys_has_none_afterwards(blender, known, scan, lender):
    obj = add_object("Bare", scan, lender.faces)
    before = scene()
    bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    bpy.ops.object.canonical_form_rig_clear()
    assert obj.data.shape_keys is None
    assert scene() == before


@pytest.mark.parametrize("first", ["form", "rig"])
def test_a_form_and_a_rig_in_any_order_leave_no_basis(blender, known, scan, lender, first):
    obj = add_object("Bare", scan, lender.faces)
    before = scene()
    steps = {"form": bpy.ops.object.canonical_form, "rig": bpy.ops.object.canonical_form_rig}
    clears = {"form": bpy.ops.object.canonical_form_clear, "rig": bpy.ops.object.canonical_form_rig_clear}
    second = "rig" if first == "form" else "form"
    for name in (first, second):
        steps[name](**(RIG if name == "rig" else QUICK), **({"rest": "T"} if name == "rig" else {}))
    clears[first]()
    assert obj.data.shape_keys is not None
    clears[second]()
    assert obj.data.shape_keys is None
    assert scene() == before


def test_a_form_and_a_rest_that_is_kept_leave_no_basis(blender, known, scan, lender):
    obj = add_object("Bare", scan, lender.faces)
    bpy.ops.object.canonical_form(**QUICK)
    bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    there = shown(obj)
    bpy.ops.object.canonical_form_rig_keep()
    bpy.ops.object.canonical_form_clear()
    bpy.ops.object.canonical_form_rig_clear()
    assert obj.data.shape_keys is None
    np.testing.assert_allclose(shown(obj), there, atol=1e-6)


def test_a_basis_that_the_user_has_renamed_stays(blender, known, scan, lender):
    obj = add_object("Bare", scan, lender.faces)
    bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    bpy.ops.object.canonical_form(**QUICK)
    obj.data.shape_keys.reference_key.name = "MyBase"
    bpy.ops.object.canonical_form_rig_clear()
    bpy.ops.object.canonical_form_clear()
    assert [key.name for key in obj.data.shape_keys.key_blocks] == ["MyBase"]


def test_another_run_replaces_the_rig(body):
    bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    once = scene()
    bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    assert scene() == once
    bpy.ops.object.canonical_form_rig(**RIG, rest="NONE", side=1)
    assert record_of(body).side == 1
    assert len(bpy.data.armatures) == 1
    assert not bpy.data.actions


def test_groups_of_the_users_that_are_called_like_bones_are_told(body):
    body.vertex_groups.new(name="forearm.L").add([5], 1.0, "REPLACE")
    before = scene()
    with pytest.raises(RuntimeError, match=r"groups of its own called forearm\.L"):
        bpy.ops.object.canonical_form_rig(**RIG)
    assert scene() == before


def test_a_rig_of_the_users_stays_the_only_one(body):
    armature = bpy.data.objects.new("Own", bpy.data.armatures.new("Own"))
    bpy.context.scene.collection.objects.link(armature)
    body.modifiers.new("Armature", "ARMATURE").object = armature
    before = scene()
    with pytest.raises(RuntimeError, match="is moved by the rig Own already"):
        bpy.ops.object.canonical_form_rig(**RIG)
    assert scene() == before
    assert not bpy.ops.object.canonical_form_rig_clear.poll()


def test_what_the_user_has_changed_is_kept_and_told(body, capsys):
    bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    body.vertex_groups["hand.L"].add([3], 0.5, "REPLACE")
    body.data.shape_keys.key_blocks["Scan"].data[0].co.x += 1
    bpy.ops.object.canonical_form_rig_clear()
    assert "Kept, since they may hold your changes: hand.L, Scan, T-Pose at Rest." in capsys.readouterr().out
    assert [group.name for group in body.vertex_groups] == ["Mine", "hand.L"]
    assert [key.name for key in body.data.shape_keys.key_blocks] == ["Basis", "Smile", "T-Pose at Rest", "Scan"]
    assert not bpy.data.armatures


def hat_on(armature):
    hat = bpy.data.objects.new("Hat", None)
    bpy.context.scene.collection.objects.link(hat)
    hat.parent = armature


def constrained_by(armature):
    eye = bpy.data.objects.new("Eye", None)
    bpy.context.scene.collection.objects.link(eye)
    eye.constraints.new("COPY_LOCATION").target = armature


def animated(armature):
    armature.pose.bones["spine"].keyframe_insert("location", frame=7)


def with_a_constraint(armature):
    armature.pose.bones["hand.L"].constraints.new("IK")


def with_a_bone_more(armature):
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    armature.data.edit_bones.new("tail").tail = (0, 0, 1)


@pytest.mark.parametrize("change", [hat_on, constrained_by, animated, with_a_constraint, with_a_bone_more])
def test_an_armature_that_holds_more_is_kept_and_the_mesh_is_as_it_was(body, change, capsys):
    before = scene()["meshes"]
    bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    armature = armature_of(body)
    change(armature)
    if armature.mode == "OBJECT":
        bpy.context.view_layer.objects.active = body
    assert bpy.ops.object.canonical_form_rig_clear() == {"FINISHED"}
    assert armature.name in bpy.data.objects
    assert "Kept, since they may hold your changes: Rig of Body." in capsys.readouterr().out
    assert scene()["meshes"] == before
    assert not body.modifiers
    assert body.parent is None
    bpy.context.view_layer.objects.active = body
    bpy.ops.object.canonical_form_rig(**RIG, rest="T")  # a new one
    assert len(bpy.data.armatures) == 2
    assert len(body.modifiers) == 1


def test_names_do_not_matter(body):
    before = scene()
    bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    armature = armature_of(body)
    armature.name = "Hero"
    own = bpy.data.objects.new("Rig of Body", armature.data.copy())
    del own.data[MARK]
    bpy.context.scene.collection.objects.link(own)
    body.modifiers[0].name = "Mine"
    body.data.shape_keys.key_blocks["T-Pose at Rest"].name = "TT"
    bpy.data.actions["Scan"].name = "Old"
    bpy.data.actions.new("Scan").use_fake_user = True
    assert read_rig_source(body).rig.vertices == pytest.approx(shown(body), abs=1e-5)
    bpy.ops.object.canonical_form_rig_clear()
    kept = body.data.shape_keys.key_blocks["TT"]  # what the user has named is the user's
    assert kept.value == 0.0
    body.shape_key_remove(kept)
    data = own.data
    bpy.data.objects.remove(bpy.data.objects["Rig of Body"])
    bpy.data.armatures.remove(data)
    assert list(bpy.data.actions.keys()) == ["Scan"]
    bpy.data.actions.remove(bpy.data.actions["Scan"])
    assert scene() == before


def test_a_copy_with_its_armature_is_another_character(body):
    bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    armature = armature_of(body)
    kept = scene()["meshes"]["Body"]
    copy, bones = body.copy(), armature.copy()
    copy.data, bones.data = body.data.copy(), armature.data.copy()
    copy.modifiers[0].object = copy.parent = bones
    for each in (copy, bones):
        bpy.context.scene.collection.objects.link(each)
    bpy.context.view_layer.objects.active = copy
    bpy.ops.object.canonical_form_rig_clear()
    assert armature_of(body) == armature
    assert scene()["meshes"]["Body"] == kept
    assert not copy.modifiers
    assert sorted(bpy.data.actions.keys()) == ["Scan", "T-Pose"]
    bpy.context.view_layer.objects.active = body
    bpy.ops.object.canonical_form_rig_clear()
    assert not bpy.data.actions
    assert [each.type for each in bpy.data.objects] == ["MESH", "MESH"]


def test_another_rig_for_a_copy_leaves_the_first_alone(body):
    bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    kept, armature = scene()["meshes"]["Body"], armature_of(body)
    copy = body.copy()
    copy.data = body.data.copy()
    bpy.context.scene.collection.objects.link(copy)
    body.select_set(False)
    copy.select_set(True)
    bpy.context.view_layer.objects.active = copy
    bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    assert armature_of(body) == armature
    assert armature_of(copy) != armature
    assert scene()["meshes"]["Body"] == kept


def test_a_mesh_of_several_objects_is_not_moved_under_them(body):
    other = body.copy()
    bpy.context.scene.collection.objects.link(other)
    before = scene()
    with pytest.raises(RuntimeError, match="shares its mesh"):
        bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    assert scene() == before


def test_a_deleted_armature_leaves_nothing_behind(body):
    before = scene()
    bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    bpy.data.objects.remove(armature_of(body))
    bpy.ops.object.canonical_form_rig_clear()
    assert scene() == before
    bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    bpy.data.objects.remove(armature_of(body))
    bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    assert len(body.modifiers) == 1
    assert "forearm.L.001" not in body.vertex_groups


def test_an_action_that_the_user_has_changed_is_kept(body):
    bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    armature = armature_of(body)
    act(armature, "Scan")
    armature.pose.bones["spine"].keyframe_insert("location", frame=30)
    bpy.ops.object.canonical_form_rig_clear()
    assert list(bpy.data.actions.keys()) == ["Scan"]
    bpy.data.actions.remove(bpy.data.actions["Scan"])
    bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    act(armature_of(body), "T-Pose")  # one of ours, as it is
    bpy.ops.object.canonical_form_rig_clear()
    assert not bpy.data.actions
    assert not bpy.data.armatures


def test_a_forged_record_removes_nothing_of_the_users(body):
    bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    text = body.data[RIG_PROPERTY]
    bpy.ops.object.canonical_form_rig_clear()
    armature = bpy.data.objects.new("Rig of Body", bpy.data.armatures.new("Own"))
    bpy.context.scene.collection.objects.link(armature)
    bpy.data.actions.new("Scan").use_fake_user = True
    body.modifiers.new("Armature", "ARMATURE").object = armature
    before = scene()
    body.data[RIG_PROPERTY] = text
    bpy.ops.object.canonical_form_rig_clear()
    assert scene() == before


def test_channels_stay(body):
    body.rotation_euler = (0, 0, 7.5)
    body.scale = (1, -2, 1)
    body.matrix_parent_inverse = Matrix.Translation((1, 2, 3))
    channels = [tuple(body.rotation_euler), tuple(body.scale), [*map(tuple, body.matrix_parent_inverse)]]
    there = shown(body)
    bpy.ops.object.canonical_form_rig(**RIG, rest="NONE")
    bpy.context.view_layer.update()
    assert np.ptp(shown(body) - there, axis=0).max() < 1e-4
    bpy.ops.object.canonical_form_rig_clear()
    assert [tuple(body.rotation_euler), tuple(body.scale), [*map(tuple, body.matrix_parent_inverse)]] == channels


def test_a_script_may_override_the_context(body):
    other = add_object("Other", np.eye(3), [[0, 1, 2]])
    with bpy.context.temp_override(object=body, active_object=body, selected_objects=[body]):
        assert bpy.ops.object.canonical_form_rig(**RIG, rest="NONE") == {"FINISHED"}
    assert len(armature_of(body).data.bones) == 22
    assert armature_of(body).mode == "OBJECT"
    assert bpy.context.view_layer.objects.active == other


def test_a_form_is_switched_off_for_the_rest(body):
    bpy.ops.object.canonical_form(**QUICK)
    key = body.data.shape_keys.key_blocks["Canonical Form"]
    bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    assert key.value == 0.0
    bpy.ops.object.canonical_form_rig_clear()
    assert key.value == 1.0


def test_a_key_of_the_users_that_needs_ours_keeps_it(body, scan):
    bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    keys = body.data.shape_keys.key_blocks
    fist = body.shape_key_add(name="Fist", from_mix=False)
    fist.relative_key = keys["T-Pose at Rest"]
    for each, other in zip(fist.data, keys["T-Pose at Rest"].data, strict=True):
        each.co = other.co
    bpy.ops.object.canonical_form_rig_clear()
    assert [key.name for key in keys] == ["Basis", "Smile", "T-Pose at Rest", "Fist"]
    fist.value = 1.0
    np.testing.assert_allclose(shown(body), scan, atol=1e-5)


def test_an_animated_body_is_told(body, capsys):
    body.keyframe_insert("location", frame=1)
    bpy.ops.object.canonical_form_rig(**RIG, rest="NONE")
    assert "Body is animated, or held by a constraint" in capsys.readouterr().out


def test_an_armature_hangs_on_what_the_body_hangs_on(body):
    stand = bpy.data.objects.new("Stand", None)
    bpy.context.scene.collection.objects.link(stand)
    stand.location = (1.0, 2.0, 3.0)
    stand.rotation_euler = (0.3, 0.2, 0.1)
    body.parent = stand
    there = shown(body)
    bpy.ops.object.canonical_form_rig(**RIG, rest="NONE")
    np.testing.assert_allclose(shown(body), there, atol=1e-5)
    stand.location.x += 2.0
    np.testing.assert_allclose(shown(body), there + np.array([2.0, 0, 0]), atol=1e-5)
    bpy.ops.object.canonical_form_rig_clear()
    assert body.parent == stand
    assert "Stand" in bpy.data.objects


def test_a_parent_of_the_users_keeps_its_place_after_the_armature_was_deleted(body):
    bpy.ops.object.canonical_form_rig(**RIG, rest="NONE")
    bpy.data.objects.remove(armature_of(body))
    stand = bpy.data.objects.new("Stand", None)
    bpy.context.scene.collection.objects.link(stand)
    body.parent = stand
    body.matrix_parent_inverse = Matrix.Translation((1, 2, 3))
    bpy.ops.object.canonical_form_rig_clear()
    assert body.parent == stand
    assert body.matrix_parent_inverse == Matrix.Translation((1, 2, 3))


def test_a_scan_that_the_user_has_changed_stays_the_users_when_the_rest_is_kept(body):
    bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    body.data.shape_keys.key_blocks["Scan"].data[0].co.x += 1
    bpy.ops.object.canonical_form_rig_keep()
    bpy.ops.object.canonical_form_rig_clear()
    assert [key.name for key in body.data.shape_keys.key_blocks] == ["Basis", "Smile", "Scan"]
