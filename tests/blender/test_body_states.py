"""What happens to a body of several objects in the hands of its user."""

import bpy
import numpy as np
import pytest

from addon.blender.objects.chosen_features import members_of
from addon.blender.records.record import read_record, require_record
from addon.blender.results.companions import companions_of
from addon.blender.results.in_betweens import PROPERTY
from tests.meshes import shapes

from .characters import activate, key_of, run
from .conftest import add_object, snapshot

pytestmark = pytest.mark.usefixtures("computed_once")


def limb(**options):
    return bpy.ops.object.canonical_form_limb(**options)


def clear():
    return bpy.ops.object.canonical_form_clear()


@pytest.mark.parametrize("reason", ["animated", "of your own"])
def test_a_refused_run_keeps_all_earlier_results(character, reason):
    trunk, head = character["trunk"], character["head"]
    run(objects="EACH")
    if reason == "animated":
        key_of(head).keyframe_insert("value", frame=1)
    else:
        head.data.shape_keys[PROPERTY] = 3.0
    activate(trunk)
    bpy.ops.object.canonical_form_in_betweens(count=2)
    before = {name: snapshot(obj) for name, obj in character.items()}
    activate(trunk, *character.values())
    with pytest.raises(RuntimeError, match=reason):
        run()
    assert {name: snapshot(obj) for name, obj in character.items()} == before


def test_one_that_cannot_take_part_no_longer_follows(character, capfd):
    trunk, head = character["trunk"], character["head"]
    run(feature_count=3)
    key_of(head).lock_shape = True
    run(feature_count=5)
    assert "head could not take part" in capfd.readouterr().out
    assert companions_of(head) == [head]
    assert head not in companions_of(trunk)
    key_of(head).lock_shape = False
    activate(head)
    limb(patch=1, only=True)
    assert len(require_record(head.data).limbs) == 3
    assert not require_record(trunk.data).limbs
    clear()
    assert read_record(head.data) is None
    assert read_record(trunk.data) is not None


def test_clear_refuses_where_it_cannot_clear_all(character):
    run()
    key_of(character["head"]).lock_shape = True
    activate(character["trunk"])
    before = {name: snapshot(obj) for name, obj in character.items()}
    with pytest.raises(RuntimeError, match="locked"):
        clear()
    assert {name: snapshot(obj) for name, obj in character.items()} == before


def test_a_copy_of_a_part_stands_alone(character):
    run()
    activate(character["eye"])
    bpy.ops.object.duplicate(linked=False)
    copy = bpy.data.objects["eye.001"]
    assert companions_of(copy) == [copy]
    assert companions_of(character["eye"]) == list(character.values())
    activate(character["trunk"])
    clear()
    assert all(read_record(obj.data) is None for obj in character.values())
    assert read_record(copy.data) is not None


def test_a_copy_of_all_is_a_body_too(character):
    run()
    activate(*character.values())
    bpy.ops.object.duplicate(linked=False)
    copies = [bpy.data.objects[f"{name}.001"] for name in character]
    assert companions_of(copies[2]) == copies
    activate(copies[0])
    clear()
    assert all(read_record(obj.data) is None for obj in copies)
    assert all(read_record(obj.data) is not None for obj in character.values())


@pytest.mark.parametrize("in_betweens", [False, True])
def test_an_animated_slider_leads_on_whatever_is_active(character, in_betweens):
    run()
    trunk = character["trunk"]
    activate(trunk)
    keys = trunk.data.shape_keys
    if in_betweens:
        bpy.ops.object.canonical_form_in_betweens(count=1)
    for frame, value in ((1, 0.0), (21, 1.0)):
        if in_betweens:
            keys[PROPERTY] = value
            keys.keyframe_insert(f'["{PROPERTY}"]', frame=frame)
        else:
            key_of(trunk).value = value
            key_of(trunk).keyframe_insert("value", frame=frame)
    activate(character["head"])
    run()
    bpy.context.scene.frame_set(1)
    assert [key_of(obj).value for obj in character.values()] == pytest.approx([0.0] * 5)
    bpy.context.scene.frame_set(21)
    assert [key_of(obj).value for obj in character.values()] == pytest.approx([1.0] * 5)


def test_a_part_whose_key_was_deleted_is_cleared_and_computed_with_the_others(character):
    run()
    head = character["head"]
    activate(head)
    head.active_shape_key_index = 1
    bpy.ops.object.shape_key_remove()
    activate(character["trunk"])
    run()
    assert companions_of(head) == list(character.values())
    activate(head)
    head.active_shape_key_index = 1
    bpy.ops.object.shape_key_remove()
    activate(character["trunk"])
    clear()
    assert read_record(head.data) is None


def test_a_broken_object_is_named_and_the_others_are_one_body(character, capfd):
    bad = add_object("Bad", *shapes.sphere(2))
    bad.data.vertices[3].co.x = float("nan")
    activate(character["trunk"], bad, *character.values())
    for objects in ("TOUCHING", "TOGETHER"):
        assert run(objects=objects) == {"FINISHED"}
        assert "Bad: 1 vertex has coordinates" in capfd.readouterr().out
        assert companions_of(character["trunk"]) == list(character.values())


def test_objects_that_share_a_mesh_have_results_of_their_own_where_it_cannot_hold_them(character):
    twin = bpy.data.objects.new("twin", character["eye"].data)
    bpy.context.scene.collection.objects.link(twin)
    twin.matrix_world = character["eye"].matrix_world.copy()
    twin.location.x += 0.3
    for obj in (twin, character["eye"]):
        obj.modifiers.new("Finer", "SUBSURF").levels = 1
    activate(*character.values(), twin)
    bpy.context.view_layer.update()
    run(mesh="SHOWN", objects="TOGETHER")
    assert "twin Canonical Form" in bpy.data.objects
    assert len(companions_of(bpy.data.objects["trunk Canonical Form"])) == 6


def test_limbs_at_another_frame_are_refused_where_parts_have_moved(character):
    eye = character["eye"]
    eye.keyframe_insert("location", frame=1)
    eye.location.x += 1
    eye.keyframe_insert("location", frame=20)
    bpy.context.scene.frame_set(20)
    run(mesh="SHOWN", objects="TOGETHER")
    before = {name: np.array([point.co for point in key_of(obj).data]) for name, obj in character.items()}
    bpy.context.scene.frame_set(1)
    activate(character["trunk"])
    with pytest.raises(RuntimeError, match="that of frame 20"):
        limb(patch=0)
    bpy.context.scene.frame_set(20)
    limb(patch=1)
    limb(patch=0)
    for name, obj in character.items():
        assert np.array([point.co for point in key_of(obj).data]) == pytest.approx(before[name], abs=1e-3)


def test_a_body_that_is_edited_stays_one_body(character):
    trunk = character["trunk"]
    run()
    activate(trunk, *character.values())
    bpy.ops.object.mode_set(mode="EDIT")
    assert {obj.mode for obj in character.values()} == {"EDIT"}
    limb(patch=1, only=True)
    bpy.ops.object.canonical_form_in_betweens(count=1)
    run()
    assert len(companions_of(trunk)) == len(character)
    assert {obj.mode for obj in character.values()} == {"EDIT"}
    clear()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert all(obj.data.shape_keys is None for obj in character.values())


def test_a_copy_of_a_part_can_be_a_reference(character):
    run()
    head = character["head"]
    assert min(require_record(head.data).report.feature_points) == -1  # it does not have all of them
    bpy.ops.object.select_all(action="DESELECT")
    copy = head.copy()
    copy.data = head.data.copy()
    bpy.context.scene.collection.objects.link(copy)
    activate(add_object("Another", *shapes.figure(13)))
    assert run(reference=copy.name) == {"FINISHED"}


def test_points_of_other_parts_are_not_added_to_the_chosen_ones(character):
    run()
    head = character["head"]
    own = [point for point in require_record(head.data).report.feature_points if point >= 0]
    activate(head)
    head.data.vertices.foreach_set("select", np.arange(len(head.data.vertices)) == 5)
    bpy.ops.object.canonical_form_choose(how="ADD")
    assert members_of(head, "Chosen Feature Points") == sorted({*own, 5})


def test_patches_alone_are_cleared_together(character):
    run(step="PATCHES")
    activate(character["eye"])
    clear()
    assert all(read_record(obj.data) is None for obj in character.values())


def test_a_feature_point_that_the_first_object_does_not_have_is_refused(character):
    count = len(character["trunk"].data.vertices)
    with pytest.raises(RuntimeError, match=f"{count - 1}"):
        run(feature_points=f"3, {count + 5}")
