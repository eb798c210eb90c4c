"""Feature points fixed by hand: kept with the mesh, and used by form, T-pose and rig alike."""

from typing import Any

import bpy
import numpy as np
import pytest
from mathutils import Vector

from addon.blender.objects.body_points import (
    ATTRIBUTE,
    body_points,
    fix_point,
    forget_points,
    points_by_hand,
    remove_point,
    swap_sides,
)
from addon.blender.objects.picking import picked
from addon.blender.records.record import require_record
from addon.interface.choices import there
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


def test_found_points_stay_when_one_is_fixed_in_edit_mode(figure_object):
    bpy.ops.object.canonical_form(**QUICK)
    found = by_name([figure_object])
    bpy.ops.object.mode_set(mode="EDIT")
    fix_point([figure_object], figure_object, 7, "head")
    bpy.ops.object.mode_set(mode="OBJECT")
    assert len(by_name([figure_object])) >= len(found)


def test_what_blender_blends_between_vertices_is_no_point(figure_object):
    for vertex, name in ((40, "right_foot"), (200, ""), (300, "left_hand")):
        fix_point([figure_object], figure_object, vertex, name)
    before = points_by_hand(figure_object.data)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.subdivide()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert points_by_hand(figure_object.data) == before
    figure_object.modifiers.new("Finer", "SUBSURF").levels = 1
    bpy.ops.object.modifier_apply(modifier="Finer")
    assert points_by_hand(figure_object.data) == before


def test_points_of_an_edited_mesh_are_not_those_of_the_last_run(figure_object):
    bpy.ops.object.canonical_form(**QUICK)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.subdivide()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert by_name([figure_object]) == {}


def test_objects_that_share_a_mesh_have_one_set(figure_object):
    twin = bpy.data.objects.new("Twin", figure_object.data)
    bpy.context.scene.collection.objects.link(twin)
    both = [figure_object, twin]
    for number, name in enumerate(NAMES[:3]):
        fix_point(both, figure_object, 40 * number, name)
    remove_point(both, twin, 0)
    assert points_by_hand(twin.data).names == NAMES[1:3]
    assert by_name(both) == {name: ("Figure", 40 * number) for number, name in enumerate(NAMES[:3]) if number}


@pytest.mark.parametrize(("away", "kept"), [(10.0, True), (0.0, False)])
def test_another_body_keeps_its_points(figure_object, arrays, away, kept):
    other = add_object("Other", *arrays)
    other.location.x = away
    bpy.context.view_layer.update()
    fix_point([figure_object, other], other, 40, "head")
    fix_point([figure_object, other], figure_object, 80, "head")
    assert points_by_hand(other.data).names == (["head"] if kept else [])


def test_a_click_on_a_mirror_image_is_of_the_other_side(blender):
    obj = add_object("Half", *shapes.grid(4, 4))
    for vertex in obj.data.vertices:
        vertex.co.x += 1
    obj.modifiers.new("Mirror", "MIRROR")
    bpy.context.view_layer.update()
    for x, image in ((1.0, False), (-1.0, True)):
        found = picked(bpy.context, [obj], Vector((x, 0.5, 5.0)), Vector((0.0, 0.0, -1.0)))
        assert found is not None
        assert found.image == image
        assert abs(obj.data.vertices[found.vertex].co.x - 1) < 0.5
    assert picked(bpy.context, [obj], Vector((50.0, 0.5, 5.0)), Vector((0.0, 0.0, -1.0))) is None


def test_the_other_side_is_set_too_where_the_mesh_is_symmetric(blender, lender):
    figure_object = add_object("Figure", lender.vertices, lender.faces)
    hand = max(figure_object.data.vertices, key=lambda vertex: vertex.co.x).index
    fix = bpy.ops.object.canonical_form_fix_point
    assert fix(limb="left_hand", owner="Figure", vertex=hand, mirror=True) == {"FINISHED"}
    points = points_by_hand(figure_object.data)
    assert points.names == ["left_hand", "right_hand"]
    left, right = (figure_object.data.vertices[vertex].co for vertex in points.vertices)
    assert (left - Vector((-right.x, right.y, right.z))).length < 0.2
    with pytest.raises(RuntimeError, match="no such vertex"):
        fix(limb="head", owner="Figure", vertex=10**6)
    assert bpy.ops.object.canonical_form_points(how="SWAP") == {"FINISHED"}
    assert points_by_hand(figure_object.data).names == ["left_hand", "right_hand"]
    assert points_by_hand(figure_object.data).vertices == points.vertices[::-1]
    assert bpy.ops.object.canonical_form_points(how="REMOVE", owner="Figure", vertex=hand) == {"FINISHED"}
    assert bpy.ops.object.canonical_form_points(how="FORGET") == {"FINISHED"}
    assert points_by_hand(figure_object.data) == ([], [])


def test_a_choice_of_a_deleted_object_is_none(figure_object, arrays):
    other = add_object("Other", *arrays)
    choices = figure_object.canonical_form
    choices.like = other
    assert there(choices.like) == other
    bpy.context.scene.collection.objects.unlink(other)
    assert there(choices.like) is None


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
