"""Another's pose: shape key, groups and colours, limbs and in-betweens, the other side, and what is refused."""

import json

import bpy
import numpy as np
import pytest

from addon.blender.jobs.likeness import Likeness
from addon.blender.records.form_report import FormReport, LikeReport
from addon.blender.records.record import require_record
from addon.blender.results.in_betweens import PROPERTY
from addon.core import Settings, mannequin, pose_like
from addon.core.measures.alignment import rigid_fit
from addon.interface import menus, result_panel, rig_panel
from tests.blender.conftest import QUICK, add_object, drawn, flat, snapshot
from tests.blender.test_limbs import keys_of, points_of
from tests.blender.test_translations import MenuLayout
from tests.meshes import shapes

pytestmark = pytest.mark.usefixtures("computed_once")
POSE = {**QUICK, "pose": "OBJECT", "like": "Other"}


@pytest.fixture(scope="module")
def small():
    """A smaller figure than elsewhere: each run unfolds two."""
    return shapes.figure(13)


@pytest.fixture(scope="module")
def other():
    """The same figure in another resolution, and how its limbs hang in another pose."""
    vertices, faces = shapes.figure(15)
    bend = 0.4 * np.maximum(vertices[:, 0], 0.0)
    cos, sin = np.cos(bend), np.sin(bend)
    x, y, z = vertices.T
    return np.column_stack([x, cos * y - sin * z, sin * y + cos * z]), faces


@pytest.fixture
def pair(blender, small, other):
    """The small figure, active, and the other one beside it."""
    figure_object = add_object("Figure", *small)
    reference = add_object("Other", *other)
    reference.location = (7.0, 0.0, 0.0)
    reference.rotation_euler = (0.0, 0.0, 1.0)
    reference.select_set(False)
    figure_object.select_set(True)
    bpy.context.view_layer.objects.active = figure_object
    bpy.context.view_layer.update()
    return figure_object, reference


def names_of(obj):
    colours = [each.name for each in obj.data.color_attributes]
    return [key.name for key in keys_of(obj)], [group.name for group in obj.vertex_groups], colours


def test_the_pose_is_that_of_the_core_as_the_reference_stands_in_the_scene(pair, small, other):
    figure, reference = pair
    before = snapshot(reference)
    assert bpy.ops.object.canonical_form_pose_like(**POSE) == {"FINISHED"}
    turn = np.array(reference.matrix_world)[:3, :3]
    here, there = (each.astype(np.float32).astype(float) for each in (small[0], other[0]))  # as Blender keeps them
    numbers = {name: value for name, value in vars(Settings(**QUICK)).items() if isinstance(value, float)}
    rounded = {name: float(np.float32(value)) for name, value in numbers.items()}  # properties hold single precision
    plain = pose_like(here, small[1], there @ turn.T, other[1], Settings(**{**QUICK, **rounded}))
    np.testing.assert_allclose(points_of(keys_of(figure)["Like Other"]), plain.vertices, atol=1e-5)
    assert snapshot(reference) == before
    report = require_record(figure.data).report
    assert report.like is not None
    assert (report.like.pose, report.like.name, report.like.side) == ("OBJECT", "Other", 0)
    assert report.like.confidence == pytest.approx(plain.match.confidence.mean(), abs=0.01)
    assert not report.has_form
    assert FormReport.from_json(json.loads(json.dumps(report.as_json()))) == report


def test_the_match_is_shown_and_cleared_with_the_rest(pair):
    figure, _ = pair
    before = snapshot(figure)
    bpy.ops.object.canonical_form_pose_like(**POSE)
    keys, groups, colours = names_of(figure)
    assert keys == ["Basis", "Like Other"]
    assert groups[-1] == "Match Confidence"
    assert colours[-1] == figure.data.color_attributes.active_color_name == "Match"
    weights = [figure.vertex_groups["Match Confidence"].weight(number) for number in range(len(figure.data.vertices))]
    assert 0.0 <= min(weights) < max(weights) <= 1.0
    assert len(require_record(figure.data).patch_names) == len(figure.data.canonical_form_patches) == len(groups) - 2
    bpy.ops.object.canonical_form_clear()
    assert snapshot(figure) == before


def test_the_reference_can_show_the_colours_too(pair):
    figure, reference = pair
    before = snapshot(reference)
    bpy.ops.object.canonical_form_pose_like(**POSE)
    assert "Show Colours on Other" in drawn(rig_panel.VIEW3D_PT_canonical_form_rig)
    assert bpy.ops.object.canonical_form_match_colours(like="Other") == {"FINISHED"}
    assert reference.data.color_attributes.active_color_name == "Match Source"
    carried, source = (
        np.frombuffer(flat(each.data.color_attributes.active_color.data, "color", 4), dtype=np.float32).reshape(-1, 4)
        for each in (figure, reference)
    )
    assert np.ptp(source[:, :3], axis=0) == pytest.approx([0.95] * 3)
    np.testing.assert_allclose(carried.min(axis=0), source.min(axis=0), atol=0.1)
    np.testing.assert_allclose(carried.max(axis=0), source.max(axis=0), atol=0.1)
    assert "Remove Colours from Other" in drawn(rig_panel.VIEW3D_PT_canonical_form_rig)
    assert bpy.ops.object.canonical_form_match_colours(like="Other") == {"FINISHED"}
    assert snapshot(reference) == before
    own = reference.data.color_attributes.new(name="Match Source by hand", type="FLOAT_COLOR", domain="POINT").name
    for shown in ([own, "Match Source"], [own]):
        bpy.ops.object.canonical_form_match_colours(like="Other")
        assert [each.name for each in reference.data.color_attributes] == shown
    reference.data.color_attributes.remove(reference.data.color_attributes[own])
    reference.vertex_groups.new(name="Match Source")  # which takes the name away
    for shown in (["Match Source Colours"], []):
        bpy.ops.object.canonical_form_match_colours(like="Other")
        assert [each.name for each in reference.data.color_attributes] == shown
    with pytest.raises(RuntimeError, match="There is no object Nobody"):
        bpy.ops.object.canonical_form_match_colours(like="Nobody")


def test_colours_of_that_name_that_are_not_ours_stay_on_the_reference(pair):
    """A user's own, those that were painted over since, and those of a copied property."""
    _, reference = pair
    colours = reference.data.color_attributes
    colours.new(name="Match Source", type="BYTE_COLOR", domain="CORNER")
    for shown in (["Match Source", "Match Source.001"], ["Match Source"]):
        bpy.ops.object.canonical_form_match_colours(like="Other")
        assert sorted(each.name for each in colours) == shown
    bpy.ops.object.canonical_form_match_colours(like="Other")
    colours["Match Source.001"].data[0].color = (0.5, 0.5, 0.5, 1.0)  # painted
    bpy.ops.object.canonical_form_match_colours(like="Other")
    assert sorted(each.name for each in colours) == ["Match Source", "Match Source.001"]
    assert "canonical_form_match_source" not in reference.data
    for forged in (["Match Source", "print"], ["Match Source"], "Match Source", 3, [1.0, 2.0]):
        reference.data["canonical_form_match_source"] = forged
        bpy.ops.object.canonical_form_match_colours(like="Other")
        assert "Match Source" in colours


def test_a_form_gives_way_to_a_pose_and_the_pose_to_a_form(pair):
    figure, _ = pair
    bpy.ops.object.canonical_form(**QUICK)
    bpy.ops.object.canonical_form_pose_like(**POSE)
    assert names_of(figure)[0] == ["Basis", "Like Other"]
    bpy.ops.object.canonical_form(**QUICK)
    keys, groups, colours = names_of(figure)
    assert keys == ["Basis", "Canonical Form"]
    assert "Match Confidence" not in groups
    assert "Match" not in colours


def test_another_run_keeps_the_key_and_what_animates_it(pair):
    figure, _ = pair
    bpy.ops.object.canonical_form_pose_like(**POSE)
    keys_of(figure)["Like Other"].keyframe_insert("value", frame=1)
    bpy.ops.object.canonical_form_pose_like(**POSE)
    assert figure.data.shape_keys.animation_data.action is not None
    assert names_of(figure)[0] == ["Basis", "Like Other"]


def test_limbs_and_in_betweens_work_on_a_pose(pair):
    figure, _ = pair
    bpy.ops.object.canonical_form_pose_like(**POSE)
    whole = points_of(keys_of(figure)["Like Other"]).copy()
    assert bpy.ops.object.canonical_form_limb(patch=1, only=True) == {"FINISHED"}
    alone = points_of(keys_of(figure)["Like Other"])
    assert 0.2 < (alone == points_of(keys_of(figure)["Basis"])).all(axis=1).mean() < 1
    bpy.ops.object.canonical_form_limb(patch=0)
    np.testing.assert_allclose(points_of(keys_of(figure)["Like Other"]), whole, atol=1e-6)
    assert bpy.ops.object.canonical_form_in_betweens(count=2) == {"FINISHED"}
    assert names_of(figure)[0] == ["Basis", "Like Other", "Like Other 33%", "Like Other 67%"]
    assert PROPERTY in figure.data.shape_keys
    bpy.ops.object.canonical_form_pose_like(**POSE)
    assert len(names_of(figure)[0]) == 4


def test_a_side_can_be_chosen(pair):
    figure, _ = pair
    bpy.ops.object.canonical_form_pose_like(**POSE)
    likeliest = points_of(keys_of(figure)["Like Other"]).copy()
    like = require_record(figure.data).report.like
    assert like is not None
    if len(like.sides) > 1:
        bpy.ops.object.canonical_form_pose_like(**POSE, side=1)
        assert np.abs(points_of(keys_of(figure)["Like Other"]) - likeliest).max() > 0.1
    with pytest.raises(RuntimeError, match="ways to match these meshes"):
        bpy.ops.object.canonical_form_pose_like(**POSE, side=99)


def test_the_pose_that_a_rig_gives_the_reference_is_taken(pair):
    figure, reference = pair
    bpy.ops.object.canonical_form_pose_like(**POSE)
    modelled = points_of(keys_of(figure)["Like Other"]).copy()
    modifier = reference.modifiers.new("Bend", "SIMPLE_DEFORM")
    modifier.deform_method, modifier.angle, modifier.deform_axis = "BEND", 1.6, "Z"
    bpy.context.view_layer.update()
    bpy.ops.object.canonical_form_pose_like(**POSE)
    bent = points_of(keys_of(figure)["Like Other"])
    rotation, shift = rigid_fit(bent, modelled)
    assert np.linalg.norm(bent @ rotation + shift - modelled, axis=1).mean() > 0.1


def test_several_objects_are_posed_as_one_body(character):
    before = {name: snapshot(obj) for name, obj in character.items()}
    reference = add_object("Other", *mannequin())
    reference.select_set(False)
    for obj in character.values():
        obj.select_set(True)
    bpy.context.view_layer.objects.active = character["trunk"]
    assert bpy.ops.object.canonical_form_pose_like(**POSE, objects="TOGETHER") == {"FINISHED"}
    for obj in character.values():
        assert "Like Other" in names_of(obj)[0]
    report = require_record(character["trunk"].data).report
    assert sorted(report.objects) == sorted(character)
    bpy.ops.object.canonical_form_clear()
    assert {name: snapshot(obj) for name, obj in character.items()} == before


def test_an_a_pose_needs_no_reference(blender):
    vertices, faces = mannequin(80.0)
    add_object("Body", vertices[:, [0, 2, 1]] * [1, 1, -1], faces)  # lying on its back
    obj = bpy.context.object
    bpy.ops.object.canonical_form_pose_like(pose="A")
    assert names_of(obj)[0] == ["Basis", "A-Pose"]
    narrow = np.ptp(points_of(keys_of(obj)["A-Pose"]), axis=0)
    np.testing.assert_allclose(narrow, np.ptp(mannequin(45.0)[0], axis=0), rtol=0.08)


@pytest.mark.parametrize(
    ("kind", "sentence"),
    [
        ("none", "Choose an object"),
        ("nobody", "There is no object Nobody"),
        ("empty", "not a mesh"),
        ("bare", "no faces"),
        ("itself", "reference itself"),
    ],
)
def test_what_cannot_be_a_reference_is_told(pair, kind, sentence):
    figure, _ = pair
    name = {"none": "", "nobody": "Nobody", "itself": "Figure"}.get(kind, "Odd")
    if name == "Odd":
        mesh = bpy.data.meshes.new("Odd") if kind == "bare" else None
        bpy.context.scene.collection.objects.link(bpy.data.objects.new("Odd", mesh))
    before = snapshot(figure)
    with pytest.raises(RuntimeError, match=sentence):
        bpy.ops.object.canonical_form_pose_like(**{**POSE, "like": name})
    assert snapshot(figure) == before


def test_a_base_mesh_under_a_mirror_is_refused(pair):
    figure, _ = pair
    figure.modifiers.new("Mirror", "MIRROR")
    with pytest.raises(RuntimeError, match="has to stay on the mirror"):
        bpy.ops.object.canonical_form_pose_like(**POSE)


def test_a_form_cannot_refer_to_a_pose(pair):
    figure, reference = pair
    bpy.ops.object.canonical_form_pose_like(**POSE)
    figure.select_set(False)
    reference.select_set(True)
    bpy.context.view_layer.objects.active = reference
    with pytest.raises(RuntimeError, match="has no form to refer to"):
        bpy.ops.object.canonical_form(**QUICK, reference="Figure")


def test_the_panel_offers_the_poses_and_the_other_side(pair):
    figure, _ = pair
    chosen = bpy.context.object.canonical_form
    chosen.like = bpy.data.objects["Other"]
    bpy.ops.object.canonical_form_pose_like(**POSE)
    like = require_record(figure.data).report.like
    assert like is not None
    assert len(like.sides) > 1
    shown = drawn(result_panel.VIEW3D_PT_canonical_form_result)
    assert f"Other Side (2 of {len(like.sides)})" in shown
    assert "Pose to Like Other" in shown
    texts: list[str] = []
    menus.draw_actions(type("Self", (), {"layout": MenuLayout(texts, [])})(), bpy.context)
    assert f"Other Side (2 of {len(like.sides)})" in texts


def test_a_long_name_is_cut_to_what_blender_keeps():
    assert len(Likeness("OBJECT", "Ä" * 60).key.encode()) <= 63
    assert Likeness("T").key == "T-Pose"


def test_a_new_object_is_called_after_the_pose(pair):
    figure, _ = pair
    before = snapshot(figure)
    bpy.ops.object.canonical_form_pose_like(**POSE, result="OBJECT")
    added = bpy.data.objects["Figure Like Other"]
    assert names_of(added)[0] == ["Basis", "Like Other"]
    assert snapshot(figure) == before


@pytest.mark.parametrize(("pose", "sides", "text"), [("T", 2, "Flip Front/Back"), ("T", 3, "Other Side (2 of 3)")])
def test_a_body_that_stands_is_flipped(pair, pose, sides, text):
    texts: list[str] = []
    like = LikeReport(pose, "", "T-Pose", 0, [float(each) for each in range(sides)], 0.9)
    result_panel.draw_other_side(MenuLayout(texts, []), bpy.context.object.canonical_form, like)
    assert texts == [text]


@pytest.mark.parametrize(
    ("bones", "told"), [({}, []), ({"hand.L": 0.5}, []), ({"hand.L": 0.5, "toe.R": 0.04}, ["toe.R"])]
)
def test_a_bone_that_hardly_fits_is_named(bones, told):
    lines = result_panel.least_sure(bones)
    assert len(lines) == bool(told)
    assert all(word in lines[0] for word in told)
