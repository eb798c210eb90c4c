"""Regression tests: actions of a hostile user that once lost the user's data."""

import bpy
import numpy as np
import pytest

from addon.blender.jobs.distance_task import DistanceTask
from addon.blender.jobs.form_task import FormTask
from addon.blender.jobs.request import Request
from addon.blender.records.record import RECORD_PROPERTY, require_record
from addon.blender.results.in_betweens import PROPERTY
from addon.core import CanonicalFormError, Settings
from addon.interface import panels
from tests.blender.conftest import QUICK, add_object, drawn, flat, snapshot
from tests.blender.test_tools import bent, select

pytestmark = pytest.mark.usefixtures("computed_once")


def run(**options):
    return bpy.ops.object.canonical_form(**{**QUICK, **options})


@pytest.fixture
def formed(figure_object):
    run()
    return figure_object


def keys_of(obj):
    return obj.data.shape_keys.key_blocks


def test_a_refused_run_of_what_is_shown_keeps_the_earlier_result(formed):
    bpy.ops.object.canonical_form_in_betweens(count=1)
    cast = formed.modifiers.new("Cast", "CAST")
    cast.factor = 1.0
    before = snapshot(formed)
    with pytest.raises(RuntimeError, match="do not follow its vertices"):
        run(mesh="SHOWN")
    assert snapshot(formed) == before


def test_animation_of_the_key_survives_a_run_of_what_is_shown(formed):
    keys_of(formed)["Canonical Form"].keyframe_insert("value", frame=1)
    bent(formed)
    run(mesh="SHOWN")
    assert formed.data.shape_keys.animation_data.action.users > 0
    assert "Canonical Form" in keys_of(formed)


def test_a_new_object_has_the_faces_that_were_computed_on(formed):
    formed.modifiers.new("Fewer", "DECIMATE").ratio = 0.5
    run(mesh="SHOWN", result="OBJECT")
    added = bpy.data.objects["Figure Canonical Form"]
    record = require_record(added.data)
    assert record.report.vertices == len(added.data.vertices)
    for key in added.data.shape_keys.key_blocks:
        points = np.frombuffer(flat(key.data, "co", 3), np.float32).reshape(-1, 3)
        edges = np.array([edge.vertices[:] for edge in added.data.edges])
        lengths = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
        assert np.quantile(lengths, 0.99) < 4 * np.median(lengths)  # no face of another mesh


def test_a_new_object_is_as_sheared_as_the_object_and_falls_with_no_rigid_body(figure_object):
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.scene.collection.objects.link(parent)
    parent.scale = (1.0, 1.0, 3.0)
    figure_object.parent, figure_object.rotation_euler = parent, (0.8, 0.3, 0.0)
    bpy.ops.rigidbody.object_add()
    assert len(figure_object.users_collection) == 2
    bpy.context.view_layer.update()
    run(result="OBJECT")
    added = bpy.data.objects["Figure Canonical Form"]
    bpy.context.view_layer.update()
    np.testing.assert_allclose(np.array(added.matrix_world), np.array(figure_object.matrix_world), atol=1e-6)
    assert added.rigid_body is None
    assert added.users_collection == (bpy.context.scene.collection,)


@pytest.mark.parametrize("new_object", [False, True])
def test_modifiers_added_meanwhile_are_noticed(figure_object, new_object):
    bent(figure_object)
    before, objects = snapshot(figure_object), len(bpy.data.objects)
    task = FormTask([figure_object], Request(Settings(**QUICK), deformed=True, new_object=new_object))
    task.compute()
    figure_object.modifiers.new("Finer", "SUBSURF")
    with pytest.raises(CanonicalFormError, match="was edited"):
        task.write()
    assert snapshot(figure_object) == before
    assert len(bpy.data.objects) == objects


def test_clear_keeps_the_users_last_key(formed):
    smile = formed.shape_key_add(name="Smile", from_mix=False)
    smile.data[3].co.x += 1
    formed.active_shape_key_index = 2
    bpy.ops.object.shape_key_move(type="TOP")
    formed.active_shape_key_index = keys_of(formed).find("Basis")
    bpy.ops.object.shape_key_remove()
    bpy.ops.object.canonical_form_clear()
    assert [key.name for key in keys_of(formed)] == ["Smile"]


def test_clear_keeps_an_edited_basis(formed):
    basis = keys_of(formed)["Basis"]
    basis.name = "My Rest"
    basis.data[3].co.x += 5
    edited = basis.data[3].co.x
    bpy.ops.object.canonical_form_clear()
    assert keys_of(formed)["My Rest"].data[3].co.x == edited


def test_nla_tracks_survive(formed):
    bpy.ops.object.canonical_form_in_betweens(count=1)
    keys = formed.data.shape_keys
    keys.keyframe_insert(f'["{PROPERTY}"]', frame=1)
    track = keys.animation_data.nla_tracks.new()
    track.strips.new("Slide", 1, keys.animation_data.action)
    keys.animation_data.action = None
    bpy.ops.object.canonical_form_limb(patch=1)
    assert len(keys.animation_data.nla_tracks) == 1
    bpy.ops.object.canonical_form_clear()
    assert formed.data.shape_keys is None or len(formed.data.shape_keys.animation_data.nla_tracks) == 1


def test_a_refused_variant_changes_nothing(formed):
    bpy.ops.object.canonical_form_in_betweens(count=3)
    keys_of(formed)["Canonical Form 25%"].data[0].co.x += 1
    before = snapshot(formed)
    with pytest.raises(RuntimeError, match="Rename them to keep them"):
        bpy.ops.object.canonical_form_limb(patch=1)
    assert snapshot(formed) == before


def test_a_property_of_the_users_is_not_taken(formed):
    formed.data.shape_keys[PROPERTY] = "mine"
    with pytest.raises(RuntimeError, match="property Pose to Form of your own"):
        bpy.ops.object.canonical_form_in_betweens(count=1)
    assert formed.data.shape_keys[PROPERTY] == "mine"


def test_a_hidden_object_in_another_mode_is_refused(figure_object):
    bpy.ops.object.mode_set(mode="EDIT")
    figure_object.hide_viewport = True
    with pytest.raises(RuntimeError):
        run()
    assert figure_object.mode == "EDIT"


@pytest.mark.parametrize(("edited", "selected"), [((True, False), (True, True)), ((True, True), (True, False))])
def test_several_objects_in_edit_mode_stay_as_they_are(figure_object, arrays, edited, selected):
    other = add_object("Other", *arrays)
    both = [figure_object, other]
    bpy.context.view_layer.objects.active = figure_object
    for obj, there in zip(both, edited, strict=True):
        obj.select_set(there)
    bpy.ops.object.mode_set(mode="EDIT")
    for obj, there in zip(both, selected, strict=True):
        obj.select_set(there)
    run()
    assert [obj.mode == "EDIT" for obj in both] == list(edited)
    assert [obj.select_get() for obj in both] == list(selected)
    bpy.ops.object.mode_set(mode="OBJECT")


def test_what_is_switched_off_is_not_taken_for_shown(figure_object):
    bent(figure_object)
    figure_object.hide_viewport = True
    with pytest.raises(RuntimeError, match=r"switched off in the views|Select a mesh"):
        run(mesh="SHOWN")


def test_steps_do_not_take_an_animated_form_away(formed):
    keys_of(formed)["Canonical Form"].keyframe_insert("value", frame=1)
    before = snapshot(formed)
    with pytest.raises(RuntimeError, match="Clear first"):
        run(step="FEATURES")
    assert snapshot(formed) == before


def test_objects_that_share_a_mesh_each_get_a_new_object(figure_object):
    twin = bpy.data.objects.new("Twin", figure_object.data)
    bpy.context.scene.collection.objects.link(twin)
    twin.select_set(True)
    run(result="OBJECT")
    assert {"Figure Canonical Form", "Twin Canonical Form"} <= set(bpy.data.objects.keys())


def test_a_mesh_that_is_shared_holds_the_form_of_the_first(figure_object, capfd):
    twin = bpy.data.objects.new("Twin", figure_object.data)
    bpy.context.scene.collection.objects.link(twin)
    twin.modifiers.new("Smooth", "SMOOTH").iterations = 30
    run(mesh="SHOWN", objects="EACH")
    alone = flat(keys_of(figure_object)["Canonical Form"].data, "co", 3)
    twin.select_set(True)
    run(mesh="SHOWN", objects="EACH")
    assert flat(keys_of(figure_object)["Canonical Form"].data, "co", 3) == alone
    assert "Twin has the mesh of Figure and shows the same form" in capfd.readouterr().out


def test_the_active_key_of_an_object_that_shares_the_mesh_is_kept(figure_object):
    twin = bpy.data.objects.new("Twin", figure_object.data)
    bpy.context.scene.collection.objects.link(twin)
    for name in ("Basis", "Smile", "Frown"):
        figure_object.shape_key_add(name=name, from_mix=False)
    twin.active_shape_key_index = 2
    run()
    bpy.ops.object.canonical_form_clear()
    assert twin.active_shape_key.name == "Frown"


def test_active_key_and_group_stay_over_a_second_run(formed):
    formed.active_shape_key_index = keys_of(formed).find("Canonical Form")
    formed.vertex_groups.active_index = formed.vertex_groups.find("Patch 3")
    formed.shape_key_add(name="Smile", from_mix=False)
    formed.active_shape_key_index = keys_of(formed).find("Canonical Form")
    run()
    assert formed.active_shape_key.name == "Canonical Form"
    assert formed.vertex_groups.active.name == "Patch 3"


def test_distances_beside_the_users_own_of_that_name_do_not_pile_up(figure_object):
    figure_object.vertex_groups.new(name="Heat Geodesic Weights").add([1], 0.5, "REPLACE")
    figure_object.data.color_attributes.new(name="Heat Geodesic", type="BYTE_COLOR", domain="CORNER")
    select(figure_object, {10})
    for _ in range(3):
        bpy.ops.object.canonical_form_distance(kind="heat")
    assert len(figure_object.vertex_groups) == len(figure_object.data.color_attributes) == 2


def test_the_group_of_distances_is_told_by_its_name(figure_object, capfd):
    figure_object.vertex_groups.new(name="Heat Geodesic Weights").add([1], 0.5, "REPLACE")
    select(figure_object, {10})
    bpy.ops.object.canonical_form_distance(kind="heat")
    assert "the vertex group Heat Geodesic Weights.001" in capfd.readouterr().out
    assert "Heat Geodesic Weights.001" in figure_object.vertex_groups


@pytest.mark.parametrize("layers", range(5))
def test_the_distances_name_is_right_whatever_layers_there_are(figure_object, layers):
    for number in range(layers):
        figure_object.data.color_attributes.new(name=f"c{number}", type="FLOAT_COLOR", domain="POINT")
    select(figure_object, {10})
    task = DistanceTask([figure_object], "heat", 0)
    task.compute()
    assert task.write() == "Heat Geodesic"


def test_choosing_does_not_flatten_painted_weights(figure_object):
    group = figure_object.vertex_groups.new(name="Arm")
    group.add([5, 6], 0.25, "REPLACE")
    select(figure_object, {7})
    bpy.ops.object.canonical_form_choose(how="ADD", group="Arm")
    assert [group.weight(index) for index in (5, 6, 7)] == [0.25, 0.25, 1.0]
    with pytest.raises(RuntimeError, match="weights of its own"):
        bpy.ops.object.canonical_form_choose(how="SET", group="Arm")
    group.lock_weight = True
    with pytest.raises(RuntimeError, match="is locked"):
        bpy.ops.object.canonical_form_choose(how="ADD", group="Arm")


def test_materials_of_the_object_come_along(figure_object):
    figure_object.data.materials.append(None)
    figure_object.material_slots[0].link = "OBJECT"
    figure_object.material_slots[0].material = bpy.data.materials.new("Skin")
    run(result="OBJECT")
    assert bpy.data.objects["Figure Canonical Form"].material_slots[0].material.name == "Skin"


def test_a_record_of_another_version_breaks_no_panel(formed):
    import json

    record = json.loads(formed.data[RECORD_PROPERTY])
    del record["palette"], record["hidden"]
    formed.data[RECORD_PROPERTY] = json.dumps(record)
    for panel in panels.CLASSES:
        if issubclass(panel, bpy.types.Panel):
            drawn(panel)
    with pytest.raises(RuntimeError, match="no canonical form"):
        bpy.ops.object.canonical_form_limb(patch=1)
    assert bpy.ops.object.canonical_form_clear() == {"FINISHED"}


def test_an_object_that_left_the_scene_is_not_written_to(figure_object):
    task = FormTask([figure_object], Request(Settings(**QUICK)))
    task.compute()
    figure_object.use_fake_user = True
    bpy.context.scene.collection.objects.unlink(figure_object)
    with pytest.raises(CanonicalFormError, match="deleted or renamed"):
        task.write()


@pytest.mark.parametrize("copied", [False, True])
def test_no_keys_are_left_behind_without_a_mesh(figure_object, copied):
    obj = figure_object
    bpy.ops.object.canonical_form(**QUICK)
    if copied:  # Blender before 5.2 miscounts the users of these keys
        obj.data = obj.data.copy()
    bpy.ops.object.canonical_form(**QUICK, result="OBJECT")
    for each in (obj, bpy.data.objects["Figure Canonical Form"]):
        bpy.context.view_layer.objects.active = each
        bpy.ops.object.canonical_form_clear()
    used = [mesh.shape_keys for mesh in bpy.data.meshes if mesh.shape_keys is not None]
    assert len(bpy.data.shape_keys) == len(used)
