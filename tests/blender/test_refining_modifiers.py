"""By itself, a body under modifiers that only refine it gets a shape key: of what the others show."""

import bpy
import numpy as np
import pytest

from addon.blender.objects.mesh_reading import read_evaluated
from addon.blender.records.record import require_record
from tests.blender.characters import activate
from tests.blender.conftest import QUICK, add_object
from tests.blender.rig_scenes import rigged_halves
from tests.meshes import shapes


@pytest.fixture
def halves(blender, lender):
    """A posed character of two objects, each smoothed after its rig."""
    objects, _ = rigged_halves(lender)
    for obj in objects:
        obj.modifiers.new("Finer", "SUBSURF").levels = 1
    bpy.context.view_layer.update()
    activate(*objects)
    return objects


def key_of(obj, name):
    return np.array([point.co for point in obj.data.shape_keys.key_blocks[name].data])


def test_it_is_a_shape_key_and_the_surface_stays_fine(halves):
    before = [len(read_evaluated(obj)[0]) for obj in halves]
    bpy.ops.object.canonical_form(mesh="AUTO", objects="TOGETHER", **QUICK)
    assert len(bpy.data.objects) == 3  # two and their armature
    assert [len(read_evaluated(obj)[0]) for obj in halves] == before
    assert all(obj.modifiers["Finer"].show_viewport for obj in halves)
    smooth = [key_of(obj, "Canonical Form") for obj in halves]
    for obj in halves:
        obj.modifiers.remove(obj.modifiers["Finer"])
    bpy.ops.object.canonical_form(mesh="SHOWN", objects="TOGETHER", **QUICK)
    assert all(
        np.allclose(key_of(obj, "Canonical Form"), each, atol=1e-5) for obj, each in zip(halves, smooth, strict=True)
    )


def test_limbs_and_poses_are_shape_keys_too(halves):
    bpy.ops.object.canonical_form(mesh="AUTO", objects="TOGETHER", **QUICK)
    whole = key_of(halves[0], "Canonical Form")
    bpy.ops.object.canonical_form_limb(patch=1, only=True)
    assert not np.allclose(key_of(halves[0], "Canonical Form"), whole, atol=1e-3)
    assert sum(require_record(halves[0].data).straightened) == 1
    bpy.ops.object.canonical_form_clear()
    bpy.ops.object.canonical_form_pose_like(pose="T", mesh="AUTO", objects="TOGETHER", **QUICK)
    assert all("T-Pose" in obj.data.shape_keys.key_blocks for obj in halves)
    assert len(bpy.data.objects) == 3


@pytest.mark.parametrize("mesh", ["AUTO", "SHOWN"])
def test_what_else_changes_the_vertices_is_written_to_new_objects(halves, mesh):
    if mesh == "AUTO":
        for obj in halves:
            obj.modifiers.new("Mirror", "MIRROR")
    bpy.context.view_layer.update()
    shown = len(read_evaluated(halves[0])[0])
    bpy.ops.object.canonical_form(mesh=mesh, objects="TOGETHER", **QUICK)
    assert halves[0].data.shape_keys is None
    assert len(bpy.data.objects[f"{halves[0].name} Canonical Form"].data.vertices) == shown


def test_a_new_object_keeps_what_is_shown(halves):
    shown = len(read_evaluated(halves[0])[0])
    bpy.ops.object.canonical_form(mesh="AUTO", result="OBJECT", objects="TOGETHER", **QUICK)
    assert len(bpy.data.objects[f"{halves[0].name} Canonical Form"].data.vertices) == shown
    assert halves[0].data.shape_keys is None


def test_of_a_base_mesh_the_warning_about_them_stays(figure_object):
    figure_object.modifiers.new("Thicker", "SOLIDIFY")
    bpy.ops.object.canonical_form(mesh="AUTO", **QUICK)
    assert any("Thicker" in each for each in require_record(figure_object.data).report.warnings)


def test_modifiers_that_others_follow_stay_on(figure_object):
    """What is bound to the finer mesh would show the base mesh without it."""
    cage = add_object("Cage", *shapes.figure(12))
    bpy.context.view_layer.objects.active = figure_object
    figure_object.modifiers.new("Finer", "SUBSURF").levels = 1
    bound = figure_object.modifiers.new("Bound", "SURFACE_DEFORM")
    bound.target = cage
    bpy.ops.object.surfacedeform_bind(modifier="Bound")
    assert bound.is_bound
    cage.location.x += 0.5
    activate(figure_object)
    bpy.context.view_layer.update()
    shown = read_evaluated(figure_object)[0]
    bpy.ops.object.canonical_form(mesh="AUTO", **QUICK)
    added = bpy.data.objects["Figure Canonical Form"]
    assert np.allclose([vertex.co for vertex in added.data.vertices], shown, atol=1e-5)
