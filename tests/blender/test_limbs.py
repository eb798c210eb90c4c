"""One limb at a time, in-betweens, and patches that are selected and coloured."""

from typing import Any

import bpy
import numpy as np
import pytest

from addon.blender.objects.mesh_reading import read_evaluated
from addon.blender.records.hidden_attributes import patches_of, whole_form_of
from addon.blender.records.record import require_record
from addon.blender.results.in_betweens import PROPERTY
from addon.blender.results.limb_states import limbs_of
from addon.core import limb_shapes
from addon.interface import result_panel
from tests.blender.conftest import QUICK, Layout, drawn, flat, snapshot
from tests.blender.test_tools import bent

pytestmark = pytest.mark.usefixtures("computed_once")


@pytest.fixture
def formed(figure_object):
    """The small figure with its form."""
    bpy.ops.object.canonical_form(**QUICK)
    return figure_object


def points_of(key):
    return np.frombuffer(flat(key.data, "co", 3), np.float32).reshape(-1, 3)


def keys_of(obj):
    return obj.data.shape_keys.key_blocks


def test_one_limb_and_back(formed):
    before = snapshot(formed)
    basis, whole = points_of(keys_of(formed)["Basis"]), points_of(keys_of(formed)["Canonical Form"])
    sizes = require_record(formed.data).report.patch_sizes
    limb = int(np.argmin(sizes)) + 1
    assert bpy.ops.object.canonical_form_limb(patch=limb, only=True) == {"FINISHED"}
    alone = points_of(keys_of(formed)["Canonical Form"])
    still = (alone == basis).all(axis=1)
    assert still.sum() > 0.5 * len(basis)
    assert not still[patches_of(formed.data) == limb - 1].all()
    assert limbs_of(formed.data) == [number == limb - 1 for number in range(len(sizes))]
    assert not (alone == whole).all()
    bpy.ops.object.canonical_form_limb(patch=0)
    assert snapshot(formed) == before


def test_a_limb_that_keeps_its_pose_leaves_the_rest_of_the_form(formed):
    whole = points_of(keys_of(formed)["Canonical Form"])
    limb = int(np.argmin(require_record(formed.data).report.patch_sizes)) + 1
    bpy.ops.object.canonical_form_limb(patch=limb)
    without = points_of(keys_of(formed)["Canonical Form"])
    assert (without == whole).all(axis=1).sum() > 0.5 * len(whole)
    assert sum(limbs_of(formed.data)) == len(limbs_of(formed.data)) - 1
    now = whole_form_of(formed.data)
    assert now is not None
    np.testing.assert_array_equal(now.astype(np.float32), whole)
    bpy.ops.object.canonical_form_limb(patch=limb)
    np.testing.assert_array_equal(points_of(keys_of(formed)["Canonical Form"]), whole)


def test_in_betweens_follow_one_property(formed):
    before = snapshot(formed)
    keys_of(formed)["Canonical Form"].value = 0.25
    bpy.ops.object.canonical_form_in_betweens(count=3)
    keys = formed.data.shape_keys
    names = ["Canonical Form 25%", "Canonical Form 50%", "Canonical Form 75%", "Canonical Form"]
    assert keys[PROPERTY] == 0.25
    for value, expected in (
        (0.0, [0, 0, 0, 0]), (0.125, [0.5, 0, 0, 0]), (0.5, [0, 1, 0, 0]), (0.9, [0, 0, 0.4, 0.6]), (1.0, [0, 0, 0, 1]),
    ):  # fmt: skip
        keys[PROPERTY] = value
        keys.update_tag()
        bpy.context.view_layer.update()
        assert [keys.key_blocks[name].value for name in names] == pytest.approx(expected, abs=1e-6)
    assert all(curve.driver.is_simple_expression for curve in keys.animation_data.drivers)  # runs without Python
    bpy.ops.object.canonical_form_in_betweens(count=0)
    assert snapshot(formed) == before


def test_in_betweens_of_a_limb_are_made_anew(formed):
    bpy.ops.object.canonical_form_in_betweens(count=1)
    whole = points_of(keys_of(formed)["Canonical Form 50%"])
    bpy.ops.object.canonical_form_limb(patch=1, only=True)
    limb = points_of(keys_of(formed)["Canonical Form 50%"])
    assert not (limb == whole).all()
    assert len(keys_of(formed)) == 3


def test_clear_takes_in_betweens_away(figure_object):
    before = snapshot(figure_object)
    bpy.ops.object.canonical_form(**QUICK)
    bpy.ops.object.canonical_form_in_betweens(count=2)
    bpy.ops.object.canonical_form_clear()
    assert snapshot(figure_object) == before


def test_a_second_run_makes_in_betweens_anew_and_keeps_their_animation(figure_object):
    before = snapshot(figure_object)
    bpy.ops.object.canonical_form(**QUICK)
    bpy.ops.object.canonical_form_in_betweens(count=2)
    keys = figure_object.data.shape_keys
    keys.keyframe_insert(f'["{PROPERTY}"]', frame=1)
    names = [key.name for key in keys.key_blocks]
    first = points_of(keys.key_blocks[2]).copy()
    bpy.ops.object.canonical_form(**QUICK, value=0.5, feature_points="3, 200")
    assert [key.name for key in keys.key_blocks] == names
    assert keys[PROPERTY] == 0.5
    assert keys.animation_data.action is not None
    assert not (points_of(keys.key_blocks[2]) == first).all()
    keys.animation_data.action = None
    bpy.ops.object.canonical_form_clear()
    assert snapshot(figure_object) == before


def test_drivers_of_the_users_are_left_alone(formed):
    bpy.ops.object.canonical_form_in_betweens(count=1)
    keys = formed.data.shape_keys
    mine = formed.shape_key_add(name="Mine", from_mix=False)
    driver = mine.driver_add("value").driver
    driver.expression = "s / 2"
    variable = driver.variables.new()
    variable.name = "s"
    variable.targets[0].id_type, variable.targets[0].id = "KEY", keys
    variable.targets[0].data_path = f'["{PROPERTY}"]'
    bpy.ops.object.canonical_form_in_betweens(count=0)
    assert [curve.driver.expression for curve in keys.animation_data.drivers] == ["s / 2"]


def test_an_animated_key_is_not_driven(formed):
    keys_of(formed)["Canonical Form"].keyframe_insert("value", frame=1)
    before = snapshot(formed)
    with pytest.raises(RuntimeError, match="animated or driven"):
        bpy.ops.object.canonical_form_in_betweens(count=2)
    assert snapshot(formed) == before


def test_what_the_user_changed_is_the_users(formed):
    bpy.ops.object.canonical_form_in_betweens(count=2)
    keys_of(formed)["Canonical Form 33%"].data[0].co.x += 1
    with pytest.raises(RuntimeError, match="Rename them to keep them"):
        bpy.ops.object.canonical_form_limb(patch=1, only=True)
    bpy.ops.object.canonical_form_clear()
    assert [key.name for key in keys_of(formed)] == ["Basis", "Canonical Form 33%"]
    assert not formed.data.shape_keys.animation_data or not formed.data.shape_keys.animation_data.drivers


def test_a_changed_key_or_mesh_is_refused(formed):
    keys_of(formed)["Canonical Form"].data[0].co.x += 1
    with pytest.raises(RuntimeError, match="was changed, renamed or removed"):
        bpy.ops.object.canonical_form_limb(patch=1)
    with pytest.raises(RuntimeError, match="was changed, renamed or removed"):
        bpy.ops.object.canonical_form_in_betweens()


def test_a_patch_that_is_not_there_is_refused(formed):
    with pytest.raises(RuntimeError, match="Patch 9 does not exist; there are 5"):
        bpy.ops.object.canonical_form_limb(patch=9)


@pytest.mark.parametrize("mode", ["OBJECT", "EDIT"])
def test_a_click_selects_a_patch(formed, mode):
    bpy.ops.object.mode_set(mode=mode)
    bpy.ops.object.canonical_form_select_patch(patch=2)
    assert formed.mode == mode
    bpy.ops.object.mode_set(mode="OBJECT")
    selected = np.array([vertex.select for vertex in formed.data.vertices])
    np.testing.assert_array_equal(selected, patches_of(formed.data) == 1)
    faces = np.array([polygon.vertices[:] for polygon in formed.data.polygons])
    chosen = [polygon.select for polygon in formed.data.polygons]
    np.testing.assert_array_equal(chosen, selected[faces].all(axis=1))
    bpy.ops.object.canonical_form_select_patch(patch=1, extend=True)
    assert sum(vertex.select for vertex in formed.data.vertices) == np.count_nonzero(
        np.asarray(patches_of(formed.data)) < 2
    )


def test_a_swatch_recolours_its_patch(formed):
    formed.data.canonical_form_patches[1].colour = (1.0, 0.0, 0.5)
    colours = np.frombuffer(flat(formed.data.color_attributes["Patches"].data, "color", 4), np.float32).reshape(-1, 4)
    patches = patches_of(formed.data)
    np.testing.assert_allclose(
        colours[patches == 1], np.tile([1, 0, 0.5, 1], (np.count_nonzero(patches == 1), 1)), atol=1e-6
    )
    assert not (colours[patches != 1] == [1, 0, 0.5, 1]).all(axis=1).any()
    bpy.ops.object.canonical_form_clear()
    assert "Patches" not in formed.data.color_attributes  # ours still
    assert len(formed.data.canonical_form_patches) == 0


def test_the_list_and_the_slider_are_drawn(formed):
    lines: list[str] = []
    data = formed.data
    draw: Any = result_panel.VIEW3D_UL_canonical_form_patches.draw_item
    draw(None, bpy.context, Layout(lines), data, data.canonical_form_patches[0], "NONE", data, "canonical_form_patch")
    assert lines == ["", "Head", "", ""]
    bpy.ops.object.canonical_form_limb(patch=1)
    assert "All Limbs" in drawn(result_panel.VIEW3D_PT_canonical_form_limbs)
    bpy.ops.object.canonical_form_in_betweens(count=1)
    assert drawn(result_panel.VIEW3D_PT_canonical_form_result)[0] == "Pose to Form"


def test_warnings_of_variants_are_reported(formed, monkeypatch, capfd):
    from addon.core.surface import working_surface

    real = working_surface.intrinsic_delaunay
    monkeypatch.setattr(working_surface, "intrinsic_delaunay", lambda surface, monitor: real(surface, monitor, 1))
    bpy.ops.object.canonical_form_in_betweens(count=2)
    assert "Warning: Some long, thin triangles could not be improved" in capfd.readouterr().out
    bpy.ops.object.canonical_form_clear()
    bpy.ops.object.canonical_form(**QUICK)
    bpy.ops.object.canonical_form_limb(patch=1, only=True)
    assert "Warning: Some long, thin triangles could not be improved" in capfd.readouterr().out


@pytest.mark.parametrize("name", ["Canonical Form", "Canonical Form 33%"])
def test_in_betweens_of_which_one_was_renamed_can_be_removed_anyway(formed, name):
    bpy.ops.object.canonical_form_in_betweens(count=2)
    keys = formed.data.shape_keys
    assert "Remove Anyway" not in drawn(result_panel.VIEW3D_PT_canonical_form_result)
    keys.key_blocks[name].name = "Mine"
    assert "Remove Anyway" in drawn(result_panel.VIEW3D_PT_canonical_form_result)
    keys.key_blocks["Canonical Form 67%"].data[0].co.x += 1
    keys[PROPERTY] = 0.75
    bpy.context.view_layer.update()
    assert bpy.ops.object.canonical_form_remove_in_betweens() == {"FINISHED"}
    assert PROPERTY not in keys
    assert keys.animation_data is None
    left = {"Basis", "Mine", "Canonical Form 67%"} | ({"Canonical Form"} if name != "Canonical Form" else set())
    assert set(keys.key_blocks.keys()) == left  # the user's: renamed and changed
    values = {key.name: key.value for key in keys.key_blocks}
    assert values["Mine" if name == "Canonical Form" else "Canonical Form"] == 0.75
    assert name == "Canonical Form" or values["Mine"] == 0.0
    assert values["Canonical Form 67%"] == 0.0
    assert not bpy.ops.object.canonical_form_remove_in_betweens.poll()


def test_a_renamed_in_between_stays_hidden_if_the_key_of_the_form_was_removed(formed):
    bpy.ops.object.canonical_form_in_betweens(count=2)
    keys = formed.data.shape_keys
    formed.active_shape_key_index = keys.key_blocks.find("Canonical Form")
    bpy.ops.object.shape_key_remove()
    keys.key_blocks["Canonical Form 67%"].name = "Mine"
    bpy.context.view_layer.update()
    assert keys.key_blocks["Mine"].value == 0.0  # the slider is at the form
    bpy.ops.object.canonical_form_remove_in_betweens()
    assert {key.name: key.value for key in keys.key_blocks if key.name != "Basis"} == {"Mine": 0.0}


def test_limbs_and_in_betweens_of_what_is_shown_are_shapes_of_what_is_shown(figure_object):
    bent(figure_object)
    pose, faces = read_evaluated(figure_object)
    bpy.ops.object.canonical_form(**{**QUICK, "mesh": "SHOWN", "quality": "draft"})
    form = read_evaluated(figure_object)[0]
    pairs = np.array([edge.vertices[:] for edge in figure_object.data.edges])

    def stretched(points):
        before, after = (np.linalg.norm(np.diff(each[pairs], axis=1), axis=2)[:, 0] for each in (pose, points))
        return np.quantile(np.abs(after / before - 1), 0.95)

    bpy.ops.object.canonical_form_limb(patch=1, only=True)
    limb = read_evaluated(figure_object)[0]
    still = np.abs(limb - pose).max(axis=1) < 1e-3 * np.ptp(pose)
    assert len(pose) / 2 < still.sum() < len(pose)
    assert stretched(limb) < 1.5 * stretched(form)
    patches = patches_of(figure_object.data)
    assert patches is not None
    (expected,) = limb_shapes(pose, faces, form, patches == 0)
    assert limb == pytest.approx(expected, abs=1e-3 * float(np.ptp(pose)))
    bpy.ops.object.canonical_form_limb(patch=0)
    assert read_evaluated(figure_object)[0] == pytest.approx(form, abs=1e-3)
    bpy.ops.object.canonical_form_in_betweens(count=1)
    keys = figure_object.data.shape_keys
    keys[PROPERTY] = 0.5
    keys.update_tag()
    bpy.context.view_layer.update()
    assert stretched(read_evaluated(figure_object)[0]) < 1.5 * stretched(form)
    bpy.ops.object.canonical_form(**{**QUICK, "mesh": "SHOWN", "quality": "draft"})
    assert len(require_record(figure_object.data).in_between_keys) == 1


def test_another_number_of_in_betweens_takes_the_place_of_the_first(formed):
    names = []
    for count in (5, 2):
        assert bpy.ops.object.canonical_form_in_betweens(count=count) == {"FINISHED"}
        record = require_record(formed.data)
        names.append(record.in_between_keys)
        assert len(record.in_between_keys) == count
        assert "In-betweens" in drawn(result_panel.VIEW3D_PT_canonical_form_result)
    assert not set(names[0]) - set(names[1]) & {key.name for key in formed.data.shape_keys.key_blocks}
