"""Feature points fixed by hand: kept with the mesh, and used by form, T-pose and rig alike."""

from typing import Any

import bpy
import numpy as np
import pytest

from addon.blender.objects.body_points import (
    ATTRIBUTE,
    body_points,
    fix_point,
    forget_points,
    points_by_hand,
    remove_point,
    swap_sides,
)
from addon.blender.records.record import require_record
from tests.blender.characters import activate
from tests.blender.conftest import QUICK, add_object, snapshot
from tests.blender.rig_scenes import rigged_halves
from tests.meshes import shapes

NAMES = ["head", "left_hand", "right_hand", "left_foot", "right_foot"]


def by_name(objects):
    """Objects and vertices of all points, by name; those without one are numbered."""
    points, _ = body_points(objects)
    return {
        name or number: (obj.name, vertex)
        for obj, own in zip(objects, points, strict=True)
        for number, (vertex, name) in enumerate(zip(*own, strict=True))
    }


def test_a_point_of_the_last_run_is_moved_and_the_others_stay(figure_object):
    bpy.ops.object.canonical_form(**QUICK)
    before = by_name([figure_object])
    assert body_points([figure_object])[1] is False
    fix_point([figure_object], figure_object, 7, "left_hand")
    points, by_hand = body_points([figure_object])
    assert by_hand
    assert by_name([figure_object])["left_hand"] == ("Figure", 7)
    assert len(points[0].vertices) in (len(before), len(before) + 1)


def test_the_next_run_uses_them_and_keeps_their_order(figure_object):
    for number, name in enumerate(NAMES):
        fix_point([figure_object], figure_object, 40 * number, name)
    bpy.ops.object.canonical_form(**QUICK)
    report = require_record(figure_object.data).report
    assert report.feature_points == [0, 40, 80, 120, 160]
    assert report.feature_names == NAMES
    bpy.ops.object.canonical_form_clear()
    assert points_by_hand(figure_object.data).names == NAMES


def test_points_given_by_a_script_come_first(figure_object):
    fix_point([figure_object], figure_object, 5, "head")
    bpy.ops.object.canonical_form(**QUICK, feature_points="3, 200", feature_names="head, tail")
    report = require_record(figure_object.data).report
    assert (report.feature_points, report.feature_names) == ([3, 200], ["head", "tail"])


def test_a_point_is_removed_and_all_are_forgotten(figure_object):
    before = snapshot(figure_object)
    for number, name in enumerate(NAMES):
        fix_point([figure_object], figure_object, 40 * number, name)
    remove_point([figure_object], figure_object, 80)
    assert points_by_hand(figure_object.data).names == [each for each in NAMES if each != "right_hand"]
    forget_points([figure_object])
    assert ATTRIBUTE not in figure_object.data.attributes
    assert snapshot(figure_object) == before


def test_left_and_right_are_swapped(figure_object):
    fix_point([figure_object], figure_object, 40, "left_hand")
    swap_sides([figure_object])
    assert points_by_hand(figure_object.data) == ([40], ["right_hand"])


def test_a_point_without_a_name_gives_way_to_one_near_it(figure_object):
    places = np.array([vertex.co for vertex in figure_object.data.vertices])
    near, far = np.argsort(np.linalg.norm(places - places[10], axis=1))[[1, -1]].tolist()
    for vertex in (near, far):
        fix_point([figure_object], figure_object, vertex, "")
    fix_point([figure_object], figure_object, 10, "head")
    assert sorted(points_by_hand(figure_object.data).vertices) == sorted([10, far])


def test_they_are_read_and_changed_in_edit_mode(figure_object):
    fix_point([figure_object], figure_object, 40, "left_hand")
    bpy.ops.object.mode_set(mode="EDIT")
    assert points_by_hand(figure_object.data) == ([40], ["left_hand"])
    fix_point([figure_object], figure_object, 80, "head")
    assert figure_object.mode == "EDIT"
    assert points_by_hand(figure_object.data) == ([80, 40], ["head", "left_hand"])
    bpy.ops.object.mode_set(mode="OBJECT")


def test_they_move_with_edits_of_the_mesh(figure_object):
    fix_point([figure_object], figure_object, 40, "left_hand")
    place = figure_object.data.vertices[40].co.copy()
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_mode(type="VERT")
    bpy.ops.mesh.select_all(action="DESELECT")
    bpy.ops.object.mode_set(mode="OBJECT")
    for vertex in range(10):
        figure_object.data.vertices[vertex].select = True
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.delete(type="VERT")
    bpy.ops.object.mode_set(mode="OBJECT")
    (vertex,), _ = points_by_hand(figure_object.data)
    assert figure_object.data.vertices[vertex].co == place


@pytest.mark.parametrize("value", [np.nan, "text"])
def test_an_attribute_of_another_kind_is_no_point(figure_object, value):
    kind = "FLOAT" if isinstance(value, float) else "STRING"
    figure_object.data.attributes.new(ATTRIBUTE, kind, "POINT")
    assert points_by_hand(figure_object.data) == ([], [])


def test_a_file_keeps_them(figure_object, tmp_path):
    fix_point([figure_object], figure_object, 40, "left_hand")
    path = str(tmp_path / "points.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert points_by_hand(bpy.data.objects["Figure"].data) == ([40], ["left_hand"])


def test_a_finer_mesh_as_shown_uses_them(figure_object):
    for number, name in enumerate(NAMES):
        fix_point([figure_object], figure_object, 40 * number, name)
    figure_object.modifiers.new("Finer", "SUBSURF").levels = 1
    bpy.ops.object.canonical_form(**QUICK, mesh="SHOWN")
    made = bpy.data.objects["Figure Canonical Form"]
    report = require_record(made.data).report
    assert report.feature_names == NAMES
    here = [figure_object.data.vertices[40 * number].co for number in range(5)]
    there = [made.data.shape_keys.reference_key.data[point].co for point in report.feature_points]
    assert max((one - other).length for one, other in zip(here, there, strict=True)) < 0.1


@pytest.mark.parametrize("mesh", ["BASE", "SHOWN"])
def test_the_image_in_a_mirror_is_of_the_other_side(blender, mesh):
    vertices, faces = shapes.figure(13)
    half = np.flatnonzero(vertices[:, 0] > -1e-6)
    number = np.full(len(vertices), -1)
    number[half] = np.arange(len(half))
    kept = number[faces]
    obj = add_object("Half", vertices[half], kept[(kept >= 0).all(axis=1)])
    obj.modifiers.new("Mirror", "MIRROR").use_clip = True
    fix_point([obj], obj, int(vertices[half, 0].argmax()), "left_hand")
    fix_point([obj], obj, int(vertices[half, 2].argmax()), "head")
    bpy.ops.object.canonical_form(**QUICK, mesh=mesh)
    shown = obj if mesh == "BASE" else bpy.data.objects["Half Canonical Form"]
    names = require_record(shown.data).report.feature_names
    assert names[:2] == ["head", "left_hand"]
    assert set(names) == ({"head", "left_hand"} if mesh == "BASE" else {"head", "left_hand", "right_hand"})


@pytest.fixture
def rigged(blender, lender):
    """A posed character of two objects."""
    return rigged_halves(lender)


def test_a_rigged_and_posed_character_of_two_objects_uses_them(rigged, tmp_path):
    objects, armature = rigged
    activate(*objects)
    whole = np.concatenate([np.array([vertex.co for vertex in obj.data.vertices]) for obj in objects])
    tips = [whole[:, 2].argmax(), whole[:, 0].argmax(), whole[:, 0].argmin()]
    low = whole[:, 2] < 0.1
    tips += [int(np.flatnonzero(low & (side * whole[:, 0] > 0))[0]) for side in (1, -1)]
    start = len(objects[0].data.vertices)
    meant = {
        name: (objects[int(tip >= start)].name, int(tip - start * (tip >= start)))
        for name, tip in zip(NAMES, tips, strict=True)
    }
    for name, (owner, vertex) in meant.items():
        fix_point(objects, bpy.data.objects[owner], vertex, name)
    assert by_name(objects) == meant
    path = str(tmp_path / "fixed.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    objects = [bpy.data.objects[name] for name in ("Upper", "Lower")]
    armature = bpy.data.objects["Rig"]
    assert by_name(objects) == meant

    def used():
        report = require_record(objects[0].data).report
        reports = [require_record(obj.data).report.feature_points for obj in objects]
        places = [(objects[int(one < 0)].name, max(one, other)) for one, other in zip(*reports, strict=True)]
        return dict(zip(report.feature_names, places, strict=True))

    activate(*objects)
    quick: dict[str, Any] = {**QUICK, "objects": "TOGETHER"}
    bpy.ops.object.canonical_form(**quick, mesh="SHOWN")
    assert used() == meant
    bpy.ops.object.canonical_form_clear()
    bpy.ops.object.canonical_form_pose_like(**quick, pose="T", mesh="SHOWN", side=0, anyway=True)
    assert used() == meant
    bpy.ops.object.canonical_form_clear()
    for obj in objects:  # a rig needs what no other rig moves
        obj.modifiers.clear()
        obj.parent = None
        obj.vertex_groups.clear()
    bpy.data.objects.remove(armature)
    bpy.ops.object.canonical_form_rig(**QUICK, rest="NONE", anyway=True)
    made = objects[0].modifiers[0].object
    hand = made.matrix_world @ made.data.bones["hand.L"].tail_local
    assert hand.x > 0.5
    assert by_name(objects) == meant
