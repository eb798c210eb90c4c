import json

import bpy
import numpy as np
import pytest

from addon.blender.objects.mesh_reading import read_mesh
from addon.blender.records.record import read_record, require_record
from addon.core import Settings, canonical_form
from addon.interface import main_panel, panels, research_panel, result_panel
from addon.interface.properties import METHOD_NAMES, settings_of
from tests.blender.conftest import QUICK, add_object, drawn, flat, snapshot

pytestmark = pytest.mark.usefixtures("computed_once")


def compute(**options):
    return bpy.ops.object.canonical_form(**{**QUICK, **options})


def test_it_writes_key_groups_and_colours(figure_object, arrays):
    obj = figure_object
    assert compute(value=0.4) == {"FINISHED"}
    form = canonical_form(*read_mesh(obj.data), Settings(**QUICK))
    keys = obj.data.shape_keys
    assert [key.name for key in keys.key_blocks] == ["Basis", "Canonical Form"]
    assert keys.key_blocks[1].value == pytest.approx(0.4)
    assert keys.key_blocks[1].relative_key == keys.reference_key
    written = np.frombuffer(flat(keys.key_blocks[1].data, "co", 3), np.float32).reshape(-1, 3)
    np.testing.assert_allclose(written, form.vertices, atol=1e-5)  # Blender keeps options in single precision
    np.testing.assert_allclose(
        np.frombuffer(flat(keys.reference_key.data, "co", 3), np.float32).reshape(-1, 3), arrays[0].astype(np.float32)
    )
    count = len(form.feature_points)
    assert [group.name for group in obj.vertex_groups] == [
        "Feature Points", *(f"Patch {index + 1}" for index in range(count)),
    ]  # fmt: skip
    for vertex in obj.data.vertices:
        weights = {obj.vertex_groups[part.group].name: part.weight for part in vertex.groups}
        expected = {f"Patch {form.patches[vertex.index] + 1}": 1.0}
        if vertex.index in form.feature_points:
            expected["Feature Points"] = 1.0
        assert weights == expected
    colours = obj.data.color_attributes
    assert [(each.name, each.data_type, each.domain) for each in colours] == [
        ("Auto Diffusion Function", "FLOAT_COLOR", "POINT"), ("Patches", "FLOAT_COLOR", "POINT"),
    ]  # fmt: skip
    shown = np.frombuffer(flat(colours["Patches"].data, "color", 4), np.float32).reshape(-1, 4)
    assert len(np.unique(shown, axis=0)) == count


def test_run_and_clear_leave_the_mesh_as_it_was(figure_object):
    before = snapshot(figure_object)
    compute()
    assert snapshot(figure_object) != before
    assert bpy.ops.object.canonical_form_clear() == {"FINISHED"}
    assert snapshot(figure_object) == before


@pytest.fixture
def furnished(figure_object):
    """An object with two keys, five groups, colours, a material and properties of the user's own."""
    obj, rng = figure_object, np.random.default_rng(0)
    obj.shape_key_add(name="My Basis", from_mix=False)
    for name, value in (("Smile", 0.3), ("Canonical Form", 0.7)):  # the second has the name that we would take
        key = obj.shape_key_add(name=name, from_mix=False)
        moved = rng.normal(size=3 * len(obj.data.vertices)).astype(np.float32)
        key.data.foreach_set("co", moved)
        key.value, key.slider_max = value, 2.0
    for name in ("Left", "Right", "Patch 1", "Feature Points", "Arm"):
        group = obj.vertex_groups.new(name=name)
        for vertex in rng.choice(len(obj.data.vertices), 40, replace=False):
            group.add([int(vertex)], float(rng.uniform()), "REPLACE")
    obj.vertex_groups[1].lock_weight = True
    obj.vertex_groups.active_index = 2
    paint = obj.data.color_attributes.new(name="Patches", type="BYTE_COLOR", domain="CORNER")
    paint.data.foreach_set("color", rng.uniform(size=4 * len(paint.data)).astype(np.float32))
    obj.data.materials.append(bpy.data.materials.new("Skin"))
    obj.data["mine"], obj["mine too"] = 1, 2
    obj.active_shape_key_index = 1
    return obj


def test_the_users_own_data_survives_bit_for_bit(furnished):
    before = snapshot(furnished)
    compute()
    during = snapshot(furnished)
    assert all(during["keys"][name] == key for name, key in before["keys"].items())
    assert during["groups"][:5] == before["groups"]
    assert all(w[: len(b)] == b for w, b in zip(during["weights"], before["weights"], strict=True))
    assert all(during["colours"][name] == colour for name, colour in before["colours"].items())
    for same in ("vertices", "edges", "polygons", "chosen", "active key", "active group", "mode"):
        assert during[same] == before[same], same
    assert during["active colours"] in require_record(furnished.data).colours  # the patches are what is looked at
    furnished.data.color_attributes.active_color_name = before["active colours"]
    compute()
    assert snapshot(furnished)["active colours"] == before["active colours"]  # chosen after the first run
    bpy.ops.object.canonical_form_clear()
    assert snapshot(furnished) == before
    compute()
    bpy.ops.object.canonical_form_clear()
    assert snapshot(furnished) == before


def test_a_second_run_replaces_its_own_results_only(furnished):
    compute()
    once = snapshot(furnished)
    compute()
    assert snapshot(furnished) == once
    compute(feature_points="3, 200")
    record = require_record(furnished.data)
    assert len(record.groups) == 3
    assert len(furnished.vertex_groups) == 5 + 3
    assert record.report.feature_points == [3, 200]


def test_results_that_the_user_renamed_or_removed_do_not_confuse_clear(figure_object):
    compute()
    figure_object.vertex_groups["Patch 1"].name = "Kept"
    figure_object.vertex_groups.remove(figure_object.vertex_groups["Patch 2"])
    figure_object.data.color_attributes.remove(figure_object.data.color_attributes["Patches"])
    key = figure_object.shape_key_add(name="Later", from_mix=False)
    bpy.ops.object.canonical_form_clear()
    assert [group.name for group in figure_object.vertex_groups] == ["Kept"]
    assert [each.name for each in figure_object.data.shape_keys.key_blocks] == ["Basis", key.name]


def test_what_the_user_put_in_place_of_a_result_is_the_users(figure_object):
    obj = figure_object
    compute()
    obj.data.shape_keys.key_blocks["Canonical Form"].name = "Kept"
    mine = obj.shape_key_add(name="Canonical Form", from_mix=False)
    mine.data[0].co = (9, 9, 9)
    obj.vertex_groups["Patch 1"].name = "Kept"
    obj.vertex_groups.new(name="Patch 1").add([1, 2, 3], 0.5, "REPLACE")
    obj.data.color_attributes["Patches"].data[0].color = (0, 0, 0, 1)
    kept = snapshot(obj)
    bpy.ops.object.canonical_form_clear()
    after = snapshot(obj)
    assert after["keys"] == kept["keys"]
    assert [name for name, *_ in after["groups"]] == ["Kept", "Patch 1"]
    assert after["colours"] == {"Patches": kept["colours"]["Patches"]}
    assert read_record(obj.data) is None


def test_a_second_run_keeps_what_hangs_on_the_key(figure_object):
    obj = figure_object
    compute()
    key = obj.data.shape_keys.key_blocks["Canonical Form"]
    key.slider_max = 3.0
    key.keyframe_insert("value", frame=1)
    driver = key.driver_add("slider_min").driver
    driver.expression = "0.25"
    later = obj.shape_key_add(name="Later", from_mix=False)
    later.relative_key = key
    compute(feature_points="3, 200", value=0.5)
    keys = obj.data.shape_keys
    again = keys.key_blocks["Canonical Form"]
    assert [each.name for each in keys.key_blocks] == ["Basis", "Canonical Form", "Later"]
    assert keys.animation_data.action is not None
    assert len(keys.animation_data.drivers) == 1
    assert again.slider_max == 3.0
    assert keys.key_blocks["Later"].relative_key == again
    bpy.ops.object.canonical_form_clear()
    assert [each.name for each in keys.key_blocks] == ["Basis", "Later"]


def test_a_failure_half_way_takes_back_what_was_written(furnished, monkeypatch):
    from addon.blender.records.hidden_attributes import HiddenAttribute

    before = snapshot(furnished)
    monkeypatch.setattr(HiddenAttribute, "write", lambda *_: 1 / 0)
    with pytest.raises(RuntimeError, match="ZeroDivisionError"):
        compute()
    assert snapshot(furnished) == before


def test_a_mesh_edited_through_another_object_is_refused(figure_object):
    twin = bpy.data.objects.new("Twin", figure_object.data)
    bpy.context.scene.collection.objects.link(twin)
    bpy.context.view_layer.objects.active = twin
    figure_object.select_set(False)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.context.view_layer.objects.active = figure_object
    assert figure_object.mode == "OBJECT"
    refused("edited through another object")


def test_a_property_of_the_users_with_our_name_is_not_taken_for_a_record(figure_object):
    figure_object.data["canonical_form_record"] = "yes"
    assert read_record(figure_object.data) is None
    assert drawn(result_panel.VIEW3D_PT_canonical_form_result) == []


@pytest.mark.parametrize("mode", ["EDIT", "SCULPT", "WEIGHT_PAINT", "VERTEX_PAINT"])
def test_it_works_from_other_modes_and_goes_back(figure_object, mode):
    bpy.ops.object.mode_set(mode=mode)
    compute()
    assert figure_object.mode == mode
    assert "Canonical Form" in figure_object.data.shape_keys.key_blocks
    bpy.ops.object.canonical_form_clear()
    assert figure_object.mode == mode
    assert figure_object.data.shape_keys is None


def test_edits_made_in_edit_mode_count(figure_object):
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.transform.resize(value=(2, 2, 2))
    compute()
    bpy.ops.object.mode_set(mode="OBJECT")
    size = np.ptp(np.frombuffer(flat(figure_object.data.shape_keys.key_blocks[1].data, "co", 3), np.float32))
    bpy.ops.object.canonical_form_clear()
    bpy.ops.transform.resize(value=(1, 1, 1))
    assert size > 1.5 * 2.2


def test_quads_and_ngons_keep_their_faces(blender):
    bpy.ops.mesh.primitive_cube_add()
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.subdivide(number_cuts=5)
    bpy.ops.mesh.select_all(action="DESELECT")
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.context.object.data.vertices[0].select = True
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.dissolve_verts()
    bpy.ops.object.mode_set(mode="OBJECT")
    sizes = sorted(len(polygon.vertices) for polygon in bpy.context.object.data.polygons)
    assert sizes[0] == 4
    assert sizes[-1] == 6
    polygons = snapshot(bpy.context.object)["polygons"]
    assert compute() == {"FINISHED"}
    assert snapshot(bpy.context.object)["polygons"] == polygons


def test_objects_that_share_a_mesh_share_the_result(figure_object):
    twin = bpy.data.objects.new("Twin", figure_object.data)
    bpy.context.scene.collection.objects.link(twin)
    compute()
    assert [group.name for group in twin.vertex_groups] == [group.name for group in figure_object.vertex_groups]
    bpy.context.view_layer.objects.active = twin
    bpy.ops.object.canonical_form_clear()
    assert read_record(figure_object.data) is None
    assert len(figure_object.vertex_groups) == 0


def refused(words, **options):
    with pytest.raises(RuntimeError, match=words):
        compute(**options)


def test_what_cannot_be_used_is_refused_with_a_sentence(blender, arrays):
    refused("Select a mesh object first")
    bpy.ops.object.camera_add()
    refused("not a mesh")
    add_object("Empty", [], [])
    refused("has no faces")
    add_object("Points", np.eye(3), [])
    refused("has no faces")
    hair = add_object("Hair", np.random.default_rng(0).normal(size=(1503, 3)), np.arange(1503).reshape(-1, 3))
    before = snapshot(hair)
    refused("501 loose parts.*M > By Distance")
    assert snapshot(hair) == before
    figure = add_object("Figure", *arrays)
    before = snapshot(figure)
    refused("Feature points must be", feature_points="three")
    refused("must lie between", feature_points="99999999")
    refused("GB", memory_limit=0.001)
    assert snapshot(figure) == before
    figure.shape_key_add(name="Basis")
    figure.data.shape_keys.use_relative = False
    refused("absolute")


def test_edit_mode_without_faces_is_refused_and_kept(blender):
    obj = add_object("Points", np.eye(3), [])
    bpy.ops.object.mode_set(mode="EDIT")
    refused("no faces")
    assert obj.mode == "EDIT"


def test_a_linked_mesh_is_refused_and_a_local_copy_works(blender, arrays, tmp_path):
    add_object("Figure", *arrays)
    path = str(tmp_path / "library.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path, copy=True)
    bpy.data.batch_remove([*bpy.data.objects, *bpy.data.meshes])
    with bpy.data.libraries.load(path, link=True) as (_, wanted):
        wanted.objects = ["Figure"]
    linked = bpy.data.objects["Figure"]
    bpy.context.scene.collection.objects.link(linked)
    bpy.context.view_layer.objects.active = linked
    refused("linked from another file.*Make Local")
    linked.make_local()
    linked.data.make_local()
    bpy.context.view_layer.objects.active = bpy.data.objects["Figure"]
    assert compute() == {"FINISHED"}


def test_clear_without_a_result_says_so(figure_object):
    with pytest.raises(RuntimeError, match="no canonical form"):
        bpy.ops.object.canonical_form_clear()


def test_results_survive_saving_and_loading(figure_object, tmp_path):
    before = snapshot(figure_object)
    compute(method="local_features")
    path = str(tmp_path / "saved.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    obj = bpy.data.objects["Figure"]
    stress = require_record(obj.data).report.stress
    assert stress is not None
    assert stress.steps == QUICK["max_iterations"]
    bpy.context.view_layer.objects.active = obj
    bpy.ops.object.canonical_form_clear()
    assert snapshot(obj) == before


def test_a_stretched_object_is_warned_about(figure_object):
    figure_object.scale = (1, 1, 3)
    bpy.context.view_layer.update()
    compute()
    assert any("scale of Figure is not uniform" in each for each in require_record(figure_object.data).report.warnings)


@pytest.mark.parametrize(("method", "label"), [("classical", "Classical MDS"), ("skeleton", "Skeleton")])
def test_a_rival_writes_what_the_method_writes(figure_object, method, label):
    chosen = bpy.context.object.canonical_form
    chosen.method = method
    assert "method" in drawn(main_panel.VIEW3D_PT_canonical_form)
    bpy.ops.object.canonical_form(method=method)
    record = require_record(figure_object.data)
    assert record.report.method == method
    assert len(record.report.feature_points) == 5
    assert figure_object.data.shape_keys.key_blocks["Canonical Form"].value == 1.0
    assert f"Method: {label}" in drawn(research_panel.VIEW3D_PT_canonical_form_research)
    bpy.ops.object.canonical_form_clear()
    assert figure_object.data.shape_keys is None
    chosen.property_unset("method")


def test_properties_mirror_the_settings(figure_object):
    chosen = settings_of(bpy.context.object.canonical_form)
    options = {name: value for name, value in vars(Settings()).items() if name not in ("part_here", "keep_joined")}
    for name, value in options.items():  # marks are on meshes
        assert getattr(chosen, name) == (pytest.approx(value) if isinstance(value, float) else value), name
    assert set(METHOD_NAMES) == set(options)


def test_the_panel_shows_what_was_found(figure_object):
    main, result = main_panel.VIEW3D_PT_canonical_form, result_panel.VIEW3D_PT_canonical_form_result
    limbs = ["Head", "Left Hand", "Right Hand", "Left Foot", "Right Foot"]
    wishes = ["T-Pose", "A-Pose", "Rig", "Straighten", "", "", "Pose Like"]
    body = ["Body", "Find the Limbs (optional)", *limbs, "Add", "Swap L/R", "Undo All"]
    options = ["Options", "mesh", "result", "quality", "Straighten: about 1 s"]
    options += ["preserve_detail", "orientation", "reference", "anyway"]
    assert drawn(main) == ["Figure", "Input: as modelled", *body, *wishes, *options, "show_points", "Live Update"]
    assert drawn(result) == drawn(result_panel.VIEW3D_PT_canonical_form_limbs) == []
    compute()
    lines = drawn(result)
    assert lines[0] == "Pose to Form"
    assert lines[-3:] == ["Keep as Rest", "New Object", "Clear"]
    assert any("feature points and patches" in line for line in drawn(research_panel.VIEW3D_PT_canonical_form_research))
    assert drawn(result_panel.VIEW3D_PT_canonical_form_limbs) == ["canonical_form_patches", "All Limbs"]
    shown = [name for panel in panels.CLASSES if issubclass(panel, bpy.types.Panel) for name in drawn(panel)]
    assert set(METHOD_NAMES) - set(shown) == {"start", "pair_weight", "biharmonic_scale"}
    bpy.context.object.canonical_form.method, bpy.context.object.canonical_form.feature_source = "as_published", "GROUP"
    assert set(METHOD_NAMES) <= {*shown, *drawn(research_panel.VIEW3D_PT_canonical_form_method)}
    assert "feature_group" in drawn(research_panel.VIEW3D_PT_canonical_form_features)


def test_on_a_cube_the_panel_counts_one_point_and_shows_no_negative_share(blender, capfd):
    bpy.ops.mesh.primitive_cube_add()
    compute(method="local_features")
    record = require_record(bpy.context.object.data)
    assert record.report.pair_reduction < 0
    assert len(record.report.feature_points) == 1
    lines = drawn(research_panel.VIEW3D_PT_canonical_form_research)
    assert any(line.startswith("1 feature point and patch,") for line in lines)
    assert not any("saved" in line for line in lines)
    told = capfd.readouterr().out
    assert "1 feature point," in told
    assert "saved" not in told


def test_the_record_is_json(figure_object):
    compute()
    report = require_record(figure_object.data).report
    assert json.loads(json.dumps(report.as_json())) == report.as_json()
    assert report.compactness_error is not None


def test_unregistering_leaves_nothing_behind(blender):
    import addon

    addon.unregister()
    assert not hasattr(bpy.types.Object, "canonical_form")
    assert not hasattr(bpy.types, "OBJECT_OT_canonical_form")
    assert not hasattr(bpy.types, "VIEW3D_PT_canonical_form")
    addon.register()
