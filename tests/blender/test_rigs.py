"""What a body is given by *Rig*: an armature, weights, keys and poses; and what *Remove Rig* leaves."""

from typing import Any

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from addon import core
from addon.blender.records.rig_record import RIG_PROPERTY, read_rig
from addon.blender.rigging import rig_task
from addon.blender.rigging.made_data import MARK
from addon.blender.rigging.rig_clearing import armature_given_to
from addon.blender.rigging.rig_reading import read_rig_source
from addon.core import Match, mannequin
from addon.core.results import Rigged
from addon.core.rigging.fitted_rig import rest_bends
from addon.core.rigging.reference_rig import mannequin_rig
from addon.core.rigging.skeleton import BoneMotions, moved_skeleton, skinned
from addon.core.surface.working_surface import working_surface
from addon.interface.rig_panel import VIEW3D_PT_canonical_form_rig
from tests.blender.conftest import QUICK, add_object, drawn, snapshot
from tests.meshes.bent_rigs import posed

BENDS = {"upper_arm.L": (0, 50, 10), "forearm.L": (0, 0, -40), "thigh.R": (-40, 0, 0), "shin.R": (50, 0, 0)}
RIG: dict[str, Any] = {**QUICK, "anyway": True}


@pytest.fixture(scope="module")
def lender():
    """A small mannequin with its bones."""
    vertices, faces = mannequin()
    coarse = working_surface(vertices, faces, 1500)
    return mannequin_rig(vertices, faces).at(coarse.kept, coarse.faces)


@pytest.fixture(scope="module")
def motions(lender):
    """How its bones are bent in the scan."""
    return posed(lender, BENDS)


@pytest.fixture(scope="module")
def scan(lender, motions):
    """The same body, bent."""
    return skinned(lender.vertices, lender.weights, motions)


@pytest.fixture
def known(monkeypatch, lender, motions, scan):
    """Let the core find the true bones at once, whatever the objects are; the costs of two ways to face."""
    nothing = np.zeros(len(scan), dtype=np.int64)
    sure = np.ones(len(scan))
    match = Match(nothing, nothing, np.ones((len(scan), 3)), sure, [1.0, 4.0], lender.faces, len(scan), {}, [], [])
    bones = lender.skeleton
    there = moved_skeleton(bones, motions)
    still = BoneMotions(there.heads, there.heads, np.broadcast_to(np.eye(3), motions.turns.shape))
    sure = np.ones(len(bones.names))
    sure[bones.names.index("toe.L")] = 0.01

    def found(vertices, faces, reference, settings, *, pose, **_):
        bends = rest_bends(lender)
        if pose is None:
            turned = np.einsum("bij,bj->bi", motions.turns, bends)
            return Rigged(vertices, there, still, turned, lender.weights, sure, match, {}, [])
        place = vertices[0] - scan[0]  # that of the object
        moved = BoneMotions(bones.heads + place, motions.heads + place, motions.turns)
        at_rest = bones._replace(heads=bones.heads + place, tails=bones.tails + place)
        return Rigged(lender.vertices + place, at_rest, moved, bends, lender.weights, sure, match, {}, [])

    monkeypatch.setattr(core, "rig", found)


@pytest.fixture
def body(blender, known, scan, lender):
    """The scan, with a key and a group of the user's."""
    obj = add_object("Body", scan, lender.faces)
    obj.shape_key_add(name="Basis")
    obj.shape_key_add(name="Smile")
    obj.vertex_groups.new(name="Mine").add([0, 1], 0.5, "REPLACE")
    return obj


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


def test_a_body_that_rests_as_it_stands_is_not_moved(body, scan, lender):
    assert bpy.ops.object.canonical_form_rig(**RIG, rest="NONE") == {"FINISHED"}
    np.testing.assert_allclose(shown(body), scan, atol=1e-6)
    armature = armature_of(body)
    assert sorted(bone.name for bone in armature.data.bones) == sorted(lender.skeleton.names)
    assert armature.data.bones["forearm.L"].use_connect
    assert not armature.data.bones["upper_arm.L"].use_connect
    assert not bpy.data.actions
    assert [key.name for key in body.data.shape_keys.key_blocks] == ["Basis", "Smile"]


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


def test_a_failure_leaves_nothing(body, monkeypatch):
    before = scene()
    fill, calls = rig_task.fill_group, []

    def failing(group, weights):
        calls.append(group.name)
        if len(calls) > 4:
            raise MemoryError
        return fill(group, weights)

    monkeypatch.setattr(rig_task, "fill_group", failing)
    with pytest.raises(RuntimeError, match="memory"):
        bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    assert scene() == before


def test_a_mesh_that_was_edited_meanwhile_is_not_written(body, monkeypatch):
    found = core.rig

    def meanwhile(*arguments, **options):
        rigged = found(*arguments, **options)
        body.data.shape_keys.reference_key.data[0].co.x += 1
        return rigged

    monkeypatch.setattr(core, "rig", meanwhile)
    with pytest.raises(RuntimeError, match="was edited while"):
        bpy.ops.object.canonical_form_rig(**RIG)
    assert not bpy.data.armatures


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
    assert "Flip Front/Back" not in drawn(VIEW3D_PT_canonical_form_rig)
    bpy.ops.object.canonical_form_rig(**RIG)
    lines = drawn(VIEW3D_PT_canonical_form_rig)
    assert "Fits worst: toe.L, 1%" in lines
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
