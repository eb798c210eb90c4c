"""Several objects as one body: one run, one slider, one Clear; every object keeps its own space."""

import bpy
import numpy as np
import pytest

from addon.blender.jobs.meant_objects import meant_objects
from addon.blender.mesh_items.fingerprints import members_fingerprint
from addon.blender.objects.mesh_reading import read_evaluated, read_mesh
from addon.blender.records.record import require_record
from addon.blender.results.companions import companions_of
from addon.blender.results.in_betweens import PROPERTY
from addon.blender.words.limb_words import told_limb
from addon.core import Settings, canonical_form
from addon.interface import main_panel, result_panel
from addon.interface.overlay import shown_points
from tests.meshes import shapes

from .characters import key_of, run
from .conftest import PLACES, QUICK, add_object, drawn, snapshot
from .test_tools import select

pytestmark = pytest.mark.usefixtures("computed_once")


def in_scene(obj, key):
    """Positions of a key in the scene."""
    points = np.empty(3 * len(obj.data.vertices), dtype=np.float32)
    key.data.foreach_get("co", points)
    place = np.array(obj.matrix_world)
    return points.reshape(-1, 3) @ place[:3, :3].T + place[:3, 3]


def test_objects_that_touch_are_one_body(character, made):
    assert run(quality="draft", max_iterations=200) == {"FINISHED"}
    order = np.concatenate([made.pieces[name] for name in PLACES])
    number = np.empty(len(order), dtype=np.int64)
    number[order] = np.arange(len(order))
    faces = np.concatenate([made.faces[np.isin(made.faces[:, 0], made.pieces[name])] for name in PLACES])
    form = canonical_form(
        made.vertices[order], number[faces], Settings(**{**QUICK, "max_iterations": 200, "quality": "draft"})
    )
    written = np.concatenate([in_scene(obj, key_of(obj)) for obj in character.values()])
    assert np.abs(written - form.vertices).max() < 0.01 * np.ptp(form.vertices, axis=0).max()
    reports = [require_record(obj.data).report for obj in character.values()]
    assert len({len(report.feature_points) for report in reports}) == 1
    assert reports[0].objects == list(PLACES)
    assert all(report.stress == reports[0].stress for report in reports)
    owned = np.array([report.feature_points for report in reports]) >= 0
    assert (owned.sum(axis=0) == 1).all()  # every feature point lies on one object


def test_the_slider_of_any_moves_all(character):
    run(value=0.25)
    trunk, head = character["trunk"], character["head"]
    assert companions_of(head) == list(character.values())
    key_of(trunk).value = 0.75
    bpy.context.view_layer.update()
    assert [key_of(obj).value for obj in character.values()] == pytest.approx([0.75] * 5)
    wanted = 0.25 * read_mesh(head.data)[0] + 0.75 * np.array([point.co for point in key_of(head).data])
    assert read_evaluated(head)[0] == pytest.approx(wanted, abs=1e-5)


def test_clear_on_one_leaves_all_as_they_were(character):
    character["shirt"].shape_key_add(name="Basis")
    character["shirt"].shape_key_add(name="Smile")
    before = {name: snapshot(obj) for name, obj in character.items()}
    run()
    assert all(snapshot(obj) != before[name] for name, obj in character.items())
    for obj in character.values():
        obj.select_set(False)
    character["eye"].select_set(True)
    bpy.context.view_layer.objects.active = character["eye"]
    bpy.ops.object.canonical_form_clear()
    for name, obj in character.items():
        assert snapshot(obj) == before[name]


def test_a_run_on_one_takes_those_that_follow_it(character):
    run()
    for obj in character.values():
        obj.select_set(False)
    bpy.context.view_layer.objects.active = character["head"]
    assert {obj.name for obj in meant_objects(bpy.context)} == set(PLACES)
    run()
    assert companions_of(character["head"])[0] == character["trunk"]  # which leads on, whatever is active
    key_of(character["trunk"]).value = 0.5
    bpy.context.view_layer.update()
    assert key_of(character["head"]).value == pytest.approx(0.5)


def test_each_lets_every_object_go(character):
    run()
    run(objects="EACH")
    assert all(companions_of(obj) == [obj] for obj in character.values())
    key_of(character["trunk"]).value = 0.5
    bpy.context.view_layer.update()
    assert key_of(character["head"]).value == 1.0
    assert all(obj.data.shape_keys.animation_data is None for obj in character.values())
    reports = [require_record(obj.data).report for obj in character.values()]
    assert not any("take part" in warning for report in reports for warning in report.warnings)


def test_objects_apart_have_forms_of_their_own(character):
    ball = add_object("Ball", *shapes.sphere(2))
    ball.location.x = 50
    for obj in character.values():
        obj.select_set(True)
    bpy.context.view_layer.update()
    alone = add_object("Alone", *shapes.sphere(2))
    run()
    expected = np.array([point.co for point in key_of(alone).data])
    alone.select_set(False)
    bpy.context.view_layer.objects.active = ball
    for obj in (ball, *character.values()):
        obj.select_set(True)
    run()
    assert companions_of(ball) == [ball]
    assert len(companions_of(character["eye"])) == 5
    assert np.array([point.co for point in key_of(ball).data]) == pytest.approx(expected, abs=1e-6)
    assert require_record(ball.data).part is None


def test_limbs_and_in_betweens_are_of_the_whole_body(character):
    run()
    whole = {name: in_scene(obj, key_of(obj)) for name, obj in character.items()}
    bpy.ops.object.canonical_form_limb(patch=1, only=True)
    assert all(sum(require_record(obj.data).limbs) == 1 for obj in character.values())
    bpy.ops.object.canonical_form_limb(patch=0)
    for name, obj in character.items():
        assert in_scene(obj, key_of(obj)) == pytest.approx(whole[name], abs=1e-4)
    assert bpy.ops.object.canonical_form_in_betweens(count=2) == {"FINISHED"}
    keys = character["trunk"].data.shape_keys
    keys[PROPERTY] = 1 / 3
    keys.update_tag()
    bpy.context.view_layer.update()
    for obj in character.values():
        blocks = obj.data.shape_keys.key_blocks
        assert [round(block.value, 4) for block in list(blocks)[1:]] == [0.0, 1.0, 0.0]
    run()  # computes them again
    assert all(len(require_record(obj.data).in_between_keys) == 2 for obj in character.values())
    bpy.ops.object.canonical_form_in_betweens(count=0)
    key_of(character["trunk"]).value = 0.5
    bpy.context.view_layer.update()
    assert [key_of(obj).value for obj in character.values()] == pytest.approx([0.5] * 5)


def test_what_is_moved_after_the_run_keeps_its_part(character):
    run()
    before = {name: np.array([point.co for point in key_of(obj).data]) for name, obj in character.items()}
    character["head"].location.x += 10
    bpy.context.view_layer.update()
    bpy.ops.object.canonical_form_limb(patch=1)
    bpy.ops.object.canonical_form_limb(patch=0)
    for name, obj in character.items():
        riding = 5e-4 if name in ("shirt", "eye") else 1e-6  # riders are laid on single-precision positions anew
        assert np.array([point.co for point in key_of(obj).data]) == pytest.approx(before[name], abs=riding)


def test_new_objects_follow_the_first_of_them(character):
    before = {name: snapshot(obj) for name, obj in character.items()}
    run(result="OBJECT")
    for name, obj in character.items():
        assert snapshot(obj) == before[name]
    added = [bpy.data.objects[f"{name} Canonical Form"] for name in PLACES]
    assert companions_of(added[3]) == added


def test_an_animated_slider_leads_and_a_second_one_keeps_its_animation(character):
    run(objects="EACH")
    for name in ("head", "hand"):
        key_of(character[name]).keyframe_insert("value", frame=1)
    run()
    assert companions_of(character["trunk"])[0] == character["head"]
    assert set(companions_of(character["trunk"])) == set(character.values()) - {character["hand"]}
    assert character["hand"].data.shape_keys.animation_data.action is not None
    assert any("hand keeps its animation" in each for each in require_record(character["trunk"].data).report.warnings)


def test_a_flat_object_is_named(character):
    before = snapshot(character["trunk"])
    character["hand"].scale.z = 0
    bpy.context.view_layer.update()
    with pytest.raises(RuntimeError, match="hand has a scale of 0"):
        run()
    assert snapshot(character["trunk"]) == before


def test_warnings_about_a_mesh_name_its_object(character):
    mesh = character["hand"].data
    corners = list(mesh.polygons[0].vertices)
    doubled = bpy.data.meshes.new("doubled")
    faces = [*(list(face.vertices) for face in mesh.polygons), corners[::-1]]
    doubled.from_pydata([*(vertex.co for vertex in mesh.vertices), (0, 0, 0)], [], faces)
    character["hand"].data = doubled
    run()
    told = [each for each in require_record(doubled).report.warnings if "left out" in each or "no face" in each]
    assert [(each[:2], each[-7:]) for each in told] == 2 * [("1 ", " (hand)")]


def test_a_linked_object_is_named_and_left_out(character, tmp_path, capfd):
    path = str(tmp_path / "belt.blend")
    belt = add_object("belt", *shapes.sphere(2))
    bpy.data.libraries.write(path, {belt})
    bpy.data.objects.remove(belt)
    with bpy.data.libraries.load(path, link=True) as (_, wanted):
        wanted.objects = ["belt"]
    linked = wanted.objects[0]
    bpy.context.scene.collection.objects.link(linked)
    bpy.context.view_layer.objects.active = character["trunk"]
    for obj in (linked, *character.values()):
        obj.select_set(True)
    assert run() == {"FINISHED"}
    assert "belt is linked from another file. Make it local first" in capfd.readouterr().out
    assert len(companions_of(character["trunk"])) == 5


def test_objects_that_share_a_mesh_are_told(character):
    twin = bpy.data.objects.new("twin", character["eye"].data)
    bpy.context.scene.collection.objects.link(twin)
    twin.location = (30, 0, 0)
    twin.select_set(True)
    assert run() == {"FINISHED"}
    assert "part" not in twin
    assert len(companions_of(character["trunk"])) == 5


def test_something_edited_meanwhile_is_not_half_written(character):
    from addon.blender.jobs.form_task import FormTask
    from addon.blender.jobs.request import Request
    from addon.core import CanonicalFormError

    before = snapshot(character["trunk"])
    task = FormTask(list(character.values()), Request(Settings(**QUICK), objects="TOGETHER"))
    task.compute()
    character["eye"].data.vertices[0].co.x += 1
    with pytest.raises(CanonicalFormError, match="eye was edited"):
        task.write()
    assert snapshot(character["trunk"]) == before


def test_an_object_on_a_bone_is_where_it_rests(character):
    rig = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    bone = rig.data.edit_bones.new("Neck")
    bone.head, bone.tail = (0, 0, 1), (0, 0.5, 1.5)
    bpy.ops.object.mode_set(mode="OBJECT")
    head = character["head"]
    place = head.matrix_world.copy()
    head.parent, head.parent_type, head.parent_bone = rig, "BONE", "Neck"
    bpy.context.view_layer.update()
    head.matrix_world = place
    bpy.context.view_layer.update()
    bpy.context.view_layer.objects.active = character["trunk"]
    run()
    expected = np.array([point.co for point in key_of(head).data])
    rig.pose.bones["Neck"].rotation_mode = "XYZ"
    rig.pose.bones["Neck"].rotation_euler = (1.0, 0.5, 0.0)
    bpy.context.view_layer.update()
    assert np.abs(np.array(head.matrix_world) - np.array(place)).max() > 0.1
    run()
    assert np.array([point.co for point in key_of(head).data]) == pytest.approx(expected, abs=1e-3)


def test_feature_points_of_a_group_lie_on_any_of_them(character):
    for name, vertices in (("head", [0, 5]), ("hand", [3]), ("trunk", [10])):
        character[name].vertex_groups.new(name="Mine").add(vertices, 1.0, "REPLACE")
    run(feature_group="Mine")
    reports = {name: require_record(obj.data).report for name, obj in character.items()}
    assert reports["trunk"].feature_points == [10, -1, -1, -1]
    assert reports["head"].feature_points == [-1, 0, 5, -1]
    group = next(iter(require_record(character["eye"].data).groups.values()))
    assert group == members_fingerprint(np.zeros(0, dtype=int), np.ones(0))


def test_patches_alone_are_found_on_all(character):
    assert run(step="PATCHES") == {"FINISHED"}
    palettes = [require_record(obj.data).palette for obj in character.values()]
    assert all(palette == palettes[0] for palette in palettes)
    assert all(obj.data.shape_keys is None for obj in character.values())


def test_the_panel_and_the_labels_show_the_body(character):
    run()
    bpy.context.view_layer.objects.active = character["eye"]
    assert drawn(main_panel.VIEW3D_PT_canonical_form)[0] == "eye and 4 more"
    labels = shown_points([*character.values()], bpy.context.evaluated_depsgraph_get())
    names = require_record(character["eye"].data).report.feature_names
    assert sorted(point.label for point in labels) == sorted(
        told_limb(name) if name else str(number) for number, name in enumerate(names, start=1)
    )


@pytest.mark.parametrize("purged", [False, True])
def test_without_the_slider_the_others_are_told_and_led_by_another(character, purged):
    run()
    mesh = character.pop("trunk").data
    bpy.data.objects.remove(bpy.data.objects["trunk"])
    if purged:
        bpy.data.meshes.remove(mesh)
    bpy.context.view_layer.objects.active = character["head"]
    assert set(companions_of(character["head"])) == set(character.values())
    assert "Its slider is gone. Compute again" in drawn(result_panel.VIEW3D_PT_canonical_form_result)
    run(objects="TOGETHER")
    assert companions_of(character["eye"])[0] == character["head"]
    assert "Its slider is gone. Compute again" not in drawn(result_panel.VIEW3D_PT_canonical_form_result)
    key_of(character["head"]).value = 0.5
    bpy.context.view_layer.update()
    assert key_of(character["eye"]).value == pytest.approx(0.5)


def test_it_survives_saving_and_opening(character, tmp_path):
    run()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "body.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "body.blend"))
    objects = [bpy.data.objects[name] for name in PLACES]
    assert companions_of(objects[2]) == objects
    key_of(objects[0]).value = 0.5
    bpy.context.view_layer.update()
    assert key_of(objects[4]).value == pytest.approx(0.5)
    bpy.context.view_layer.objects.active = objects[1]
    bpy.ops.object.canonical_form_clear()
    assert all(obj.data.shape_keys is None for obj in objects)


def test_distances_go_on_over_all_that_touch(character):
    far = add_object("Far", *shapes.sphere(2))
    far.location.x = 40
    head = character["head"]
    bpy.context.view_layer.objects.active = head
    for obj in (far, *character.values()):
        obj.select_set(True)
    bpy.context.view_layer.update()
    select(head, {0})
    assert bpy.ops.object.canonical_form_distance(kind="fast_marching") == {"FINISHED"}
    assert "Fast Marching" not in far.data.color_attributes
    weights = {}
    for name, obj in character.items():
        group = obj.vertex_groups["Fast Marching Weights"].index
        weights[name] = [part.weight for vertex in obj.data.vertices for part in vertex.groups if part.group == group]
        assert len(weights[name]) == len(obj.data.vertices)
    assert min(weights["head"]) == 0
    assert max(weights["head"]) < max(weights["trunk"])
    assert max(max(each) for each in weights.values()) == 1
