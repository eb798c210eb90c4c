"""What a body is given by *Rig*: an armature, weights, keys and poses."""

from dataclasses import replace

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from addon import core
from addon.blender.records.rig_record import RIG_PROPERTY, read_rig, write_rig
from addon.blender.rigging.rig_posing import taken_pose
from addon.blender.rigging.rig_reading import read_rig_source
from addon.core.rigging.fitted_rig import rest_bends
from addon.interface.result_panel import least_sure
from addon.interface.rig_panel import VIEW3D_PT_canonical_form_rigged
from tests.blender.conftest import add_object, drawn
from tests.blender.rig_scenes import RIG, act, armature_of, scene, shown


def test_a_body_that_rests_as_it_stands_is_not_moved(body, scan, lender):
    assert bpy.ops.object.canonical_form_rig(**RIG, rest="NONE") == {"FINISHED"}
    np.testing.assert_allclose(shown(body), scan, atol=1e-6)
    armature = armature_of(body)
    assert sorted(bone.name for bone in armature.data.bones) == sorted(lender.skeleton.names)
    assert armature.data.bones["forearm.L"].use_connect
    assert not armature.data.bones["upper_arm.L"].use_connect
    assert not bpy.data.actions
    assert [key.name for key in body.data.shape_keys.key_blocks] == ["Basis", "Smile"]


@pytest.mark.parametrize(
    ("names", "some"),
    [
        ("MIXAMO", {"mixamorig:Hips", "mixamorig:LeftForeArm", "mixamorig:RightToeBase"}),
        ("UNREAL", {"pelvis", "lowerarm_l", "ball_r"}),
        ("VRM", {"hips", "leftLowerArm", "rightToes"}),
    ],
)
def test_bones_are_called_as_other_programs_call_them(body, names, some):
    assert bpy.ops.object.canonical_form_rig(**RIG, rest="T", names=names) == {"FINISHED"}
    bones = armature_of(body).data.bones
    assert some <= set(bones.keys())
    assert {group.name for group in body.vertex_groups} <= {"Mine", *bones.keys()}
    assert len(bones) == 22
    with pytest.raises(RuntimeError, match=r"Names: Rigify|switched off"):
        bpy.ops.object.canonical_form_rig(**RIG, rest="T", names=names, rigify=True)
    assert bpy.ops.object.canonical_form_rig_clear() == {"FINISHED"}
    assert not some & {group.name for group in body.vertex_groups}


def test_bones_turn_the_skin(body, scan, motions):
    bpy.ops.object.canonical_form_rig(**RIG, rest="NONE")
    armature = armature_of(body)
    armature.pose.bones["upper_arm.R"].rotation_mode = "XYZ"
    armature.pose.bones["upper_arm.R"].rotation_euler.x = 0.5
    moved = np.linalg.norm(shown(body) - scan, axis=1)
    assert 0.1 < moved.max() < 0.5
    assert (moved > 1e-3).mean() < 0.2
    armature.location.x += 2.0
    assert shown(body)[:, 0].mean() - scan[:, 0].mean() == pytest.approx(2.0, abs=0.05)


def test_elbows_and_knees_bend_about_their_x_axes(body, motions, lender):
    bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    armature, names = armature_of(body), lender.skeleton.names
    for name in names:
        number = names.index(name)
        axis = np.array(armature.data.bones[name].matrix_local)[:3, 0]
        np.testing.assert_allclose(axis, rest_bends(lender)[number], atol=1e-5)


def test_a_button_takes_the_pose_of_the_scan_and_gives_it_back(body, scan, lender):
    bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    assert {"At Rest", "As Scanned"} <= {*drawn(VIEW3D_PT_canonical_form_rigged)}
    armature = armature_of(body)
    action = bpy.data.actions["Scan"]
    assert taken_pose(armature, action) == "REST"
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="POSE")
    bpy.ops.pose.select_all(action="DESELECT")
    some = armature.pose.bones["forearm.L"]
    (some if hasattr(some, "select") else some.bone).select = True  # all bones take the pose all the same
    assert bpy.ops.object.canonical_form_rig_pose(scan=True) == {"FINISHED"}
    bpy.context.view_layer.update()
    assert body.data.shape_keys.key_blocks["Scan"].value == 1.0
    np.testing.assert_allclose(shown(body), scan, atol=2e-3)
    assert taken_pose(armature, action) == "SCAN"
    some.rotation_quaternion.x += 0.1
    bpy.context.view_layer.update()
    assert taken_pose(armature, action) == ""
    data = armature_of(body).animation_data
    assert data is None or data.action is None
    bpy.ops.object.canonical_form_rig_pose()
    bpy.context.view_layer.update()
    np.testing.assert_allclose(shown(body), lender.vertices, atol=1e-5)
    assert body.data.shape_keys.key_blocks["Scan"].value == 0.0
    bpy.data.actions.remove(bpy.data.actions["Scan"])
    with pytest.raises(RuntimeError, match="gone"):
        bpy.ops.object.canonical_form_rig_pose(scan=True)


def test_bones_that_are_gone_are_told_and_the_others_take_the_pose(body, scan, capsys):
    bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    armature = armature_of(body)
    armature.data.bones["toe.L"].name = "Mine"
    assert bpy.ops.object.canonical_form_rig_pose(scan=True) == {"FINISHED"}
    assert "renamed or deleted" in capsys.readouterr().out
    assert body.data.shape_keys.key_blocks["Scan"].value == 0.0
    turned = [bone.name for bone in armature.pose.bones if not np.allclose(bone.matrix_basis, np.eye(4), atol=1e-4)]
    assert "forearm.L" in turned
    assert "Mine" not in turned


def test_a_body_that_rests_in_a_stance_keeps_its_scan(body, scan, lender):
    bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    keys = body.data.shape_keys.key_blocks
    assert [key.name for key in keys] == ["Basis", "Smile", "T-Pose at Rest", "Scan"]
    np.testing.assert_allclose(shown(body), lender.vertices, atol=1e-5)
    assert np.array_equal(np.array([tuple(each.co) for each in keys["Basis"].data]), scan.astype(np.float32))
    armature = armature_of(body)
    assert sorted(each.name for each in bpy.data.actions if each.asset_data) == ["Scan", "T-Pose"]
    act(armature, "Scan")
    np.testing.assert_allclose(shown(body), scan, atol=2e-3)  # weights are rounded to a thousandth
    keys["Scan"].value = 1.0
    np.testing.assert_allclose(shown(body), scan, atol=2e-3)
    act(armature, "T-Pose")
    keys["Scan"].value = 0.0
    np.testing.assert_allclose(shown(body), lender.vertices, atol=1e-5)


def test_the_key_of_the_scan_undoes_what_skinning_cannot_reach(body, scan, monkeypatch):
    found = core.rig

    def off(*arguments, **options):  # the skin of the scan lies elsewhere than skinning puts it
        rigged = found(*arguments, **options)
        rigged.vertices[:] += 0.01
        return rigged

    monkeypatch.setattr(core, "rig", off)
    bpy.ops.object.canonical_form_rig(**RIG, rest="A")
    act(armature_of(body), "Scan")
    assert np.abs(shown(body) - scan).max() > 5e-3
    body.data.shape_keys.key_blocks["Scan"].value = 1.0
    assert np.linalg.norm(shown(body) - scan, axis=1).mean() < 1e-3


def test_mode_and_selection_stay(body):
    other = add_object("Other", np.eye(3), [[0, 1, 2]])
    bpy.context.view_layer.objects.active = body
    body.select_set(True)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.object.canonical_form_rig(**RIG)
    assert body.mode == "EDIT"
    bpy.ops.object.mode_set(mode="OBJECT")
    assert bpy.context.view_layer.objects.active == body
    assert {obj for obj in bpy.data.objects if obj.select_get()} >= {body}
    assert not armature_of(body).select_get()
    assert other.name in bpy.data.objects


def test_several_objects_get_one_armature(blender, known, scan, lender):
    above = scan[:, 2] > np.median(scan[:, 2])
    objects = []
    for name, own, place in (("Top", above, Matrix.Translation((0, 1, 0))), ("Bottom", ~above, Matrix.Scale(2.0, 4))):
        number = np.cumsum(own) - 1
        faces = number[lender.faces[own[lender.faces].all(axis=1)]]
        inverse = np.array(place.inverted())
        obj = add_object(name, scan[own] @ inverse[:3, :3].T + inverse[:3, 3], faces)
        obj.matrix_world = place
        objects.append(obj)
    order = np.concatenate([np.flatnonzero(above), np.flatnonzero(~above)])
    found = core.rig

    def sorted_alike(*arguments, **options):
        return _taken(found(*arguments, **options), order)

    core.rig = sorted_alike
    try:
        for obj in objects:
            obj.select_set(True)
        bpy.context.view_layer.objects.active = objects[0]
        bpy.context.view_layer.update()
        before = scene()
        bpy.ops.object.canonical_form_rig(**RIG, rest="NONE")
        assert len(bpy.data.armatures) == 1
        for obj, own in zip(objects, (above, ~above), strict=True):
            np.testing.assert_allclose(shown(obj), scan[own], atol=1e-5)
        bpy.ops.object.canonical_form_rig_clear()
        assert scene() == before
    finally:
        core.rig = found


def _taken(rigged, order):
    return type(rigged)(
        rigged.vertices,
        rigged.skeleton,
        rigged.to_given,
        rigged.bends,
        rigged.weights[order],
        *list(vars(rigged).values())[5:],
    )


def test_the_record_survives_a_file(body, tmp_path):
    bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    record = read_rig(body.data)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "rig.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "rig.blend"))
    body = bpy.data.objects["Body"]
    assert read_rig(body.data) == record
    bpy.ops.object.canonical_form_rig_clear()
    assert [key.name for key in body.data.shape_keys.key_blocks] == ["Basis", "Smile"]
    assert not bpy.data.armatures


def test_a_spoilt_record_is_none(body):
    for text in ("", "[]", '{"armature": 3}', "{" * 2000):
        body.data[RIG_PROPERTY] = text
        assert read_rig(body.data) is None
    body.data[RIG_PROPERTY] = 3
    assert read_rig(body.data) is None


def test_the_panel_names_the_bone_that_fits_worst_and_the_other_way(body):
    assert "Flip Front/Back" not in drawn(VIEW3D_PT_canonical_form_rigged)
    bpy.ops.object.canonical_form_rig(**RIG)
    lines = drawn(VIEW3D_PT_canonical_form_rigged)
    assert "Check toe.L: it hardly fits" in lines
    assert "Flip Front/Back" in lines
    assert armature_of(body).data.bones["toe.L"].color.palette != "DEFAULT"
    assert armature_of(body).data.bones["hand.L"].color.palette == "DEFAULT"


def test_a_rig_is_read_with_its_meshes_and_rolls(body, lender):
    bpy.ops.object.canonical_form_rig(**RIG, rest="NONE")
    armature = armature_of(body)
    for chosen in (armature, body):
        source = read_rig_source(chosen)
        assert sorted(source.rig.skeleton.names) == sorted(lender.skeleton.names)
        np.testing.assert_allclose(source.rig.vertices, shown(body), atol=1e-5)
        order = [lender.skeleton.names.index(name) for name in source.rig.skeleton.names]
        np.testing.assert_allclose(source.rig.weights, lender.weights[:, order], atol=2e-3)
    with pytest.raises(core.CanonicalFormError, match="has no rig"):
        read_rig_source(add_object("Bare", np.eye(3), [[0, 1, 2]]))


def test_the_stance_of_a_rig_of_ours_is_read_at_its_rest(body, lender):
    bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    source = read_rig_source(body)
    np.testing.assert_allclose(source.rig.vertices, lender.vertices, atol=1e-5)


def test_bones_come_back_from_a_rigged_object_as_they_are(blender, scan, lender, motions):
    """The real fit: a character lends its bones, with their rolls, to itself in another pose."""
    add_object("Lender", lender.vertices, lender.faces)
    data = bpy.data.armatures.new("Bones")
    armature = bpy.data.objects.new("Bones", data)
    bpy.context.scene.collection.objects.link(armature)
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    for number, name in enumerate(lender.skeleton.names):
        bone = data.edit_bones.new(name)
        bone.head, bone.tail, bone.roll = lender.skeleton.heads[number], lender.skeleton.tails[number], 0.3 * number
        parent = int(lender.skeleton.parents[number])
        bone.parent = None if parent < 0 else data.edit_bones[lender.skeleton.names[parent]]
    bpy.ops.object.mode_set(mode="OBJECT")
    own = bpy.data.objects["Lender"]
    for name, weights in zip(lender.skeleton.names, lender.weights.T, strict=True):
        group = own.vertex_groups.new(name=name)
        for vertex in np.flatnonzero(weights > 1e-4).tolist():
            group.add([vertex], float(weights[vertex]), "REPLACE")
    own.modifiers.new("Armature", "ARMATURE").object = armature
    obj = add_object("Scan", scan, lender.faces)
    bpy.ops.object.canonical_form_rig(like="Bones", rest="NONE", equal=False)
    made = armature_of(obj)
    for number, name in enumerate(lender.skeleton.names):
        if not name.startswith(("toe", "hand", "foot", "shoulder")):
            here = made.matrix_world @ made.data.bones[name].matrix_local
            true = Matrix(motions.turns[number].tolist()) @ data.bones[name].matrix_local.to_3x3()
            turn = (here.to_3x3().inverted() @ true).to_quaternion().angle
            assert min(turn, 2 * np.pi - turn) < np.radians(12.0), name
            assert np.linalg.norm(np.array(here.translation) - motions.heads[number]) < 0.02, name


def test_a_rest_that_is_kept_is_the_basis(body, scan, lender):
    keys = body.data.shape_keys.key_blocks
    smile = scan + np.array([0.0, 0.0, 0.05])
    keys["Smile"].value = 0.0
    keys["Smile"].data.foreach_set("co", smile.astype(np.float32).ravel())
    bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    there = shown(body)
    armature = armature_of(body)
    assert bpy.ops.object.canonical_form_rig_keep() == {"FINISHED"}
    assert [key.name for key in keys] == ["Basis", "Smile", "Scan"]
    np.testing.assert_allclose(shown(body), there, atol=1e-6)
    points = np.empty((len(scan), 3), dtype=np.float32)
    body.data.vertices.foreach_get("co", points.ravel())
    np.testing.assert_allclose(points, lender.vertices, atol=1e-5)
    keys["Smile"].value = 1.0
    way = np.linalg.norm(shown(body) - there, axis=1)
    np.testing.assert_allclose(way, 0.05, atol=1e-4)  # turned as the surface is
    head = scan[:, 2] > np.quantile(scan[:, 2], 0.98)
    np.testing.assert_allclose((shown(body) - there)[head], np.tile([0, 0, 0.05], (head.sum(), 1)), atol=0.01)
    keys["Smile"].value = 0.0
    act(armature, "Scan")
    keys["Scan"].value = 1.0
    np.testing.assert_allclose(shown(body), scan, atol=2e-3)
    assert not bpy.ops.object.canonical_form_rig_keep.poll()
    bpy.ops.object.canonical_form_rig_clear()
    assert [key.name for key in keys] == ["Basis", "Smile"]
    np.testing.assert_allclose(shown(body), there, atol=1e-6)


def test_what_was_warned_of_is_in_the_panel(body):
    bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    record = read_rig(body.data)
    assert record is not None
    assert record.warnings == []
    assert "No warnings: look from all sides" in drawn(VIEW3D_PT_canonical_form_rigged) or least_sure(record.confidence)
    write_rig(body.data, replace(record, warnings=["Skin was parted."]))
    lines = drawn(VIEW3D_PT_canonical_form_rigged)
    assert "Skin was parted." in lines
    assert "No warnings: look from all sides" not in lines
