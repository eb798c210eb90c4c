"""Which meshes a run takes: the active one, the selected ones, those of the active armature."""

import bpy
import numpy as np
import pytest

from addon.blender.jobs.meant_objects import meant_object, meant_objects
from addon.blender.results.new_objects import make_active
from addon.interface import panels
from addon.interface.operators import takes_shown
from tests.meshes import shapes

from .conftest import add_object, drawn


@pytest.fixture
def rigged(figure_object):
    """A figure and a smaller one under an armature, which is active, as after the import of a .glb."""
    other = add_object("Small", *shapes.sphere(2))
    rig = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    bpy.context.collection.objects.link(rig)
    for obj in (figure_object, other):
        obj.parent = rig
        obj.modifiers.new("Armature", "ARMATURE").object = rig
        obj.select_set(False)
    bpy.context.view_layer.objects.active = rig
    rig.select_set(True)
    return rig, figure_object, other


def test_the_meshes_of_the_active_armature_are_computed(rigged):
    _, obj, other = rigged
    assert meant_objects(bpy.context) == [obj, other]
    assert meant_object(bpy.context) == obj
    assert bpy.ops.object.canonical_form.poll()
    assert bpy.ops.object.canonical_form(quality="draft") == {"FINISHED"}
    assert all("Canonical Form" in each.data.shape_keys.key_blocks for each in (obj, other))
    assert bpy.ops.object.canonical_form_limb(patch=1) == {"FINISHED"}
    assert bpy.ops.object.canonical_form_clear() == {"FINISHED"}
    assert obj.data.shape_keys is None
    assert other.data.shape_keys is None


def test_a_selected_mesh_goes_before_those_of_the_active_armature(rigged):
    _, _, other = rigged
    other.select_set(True)
    assert meant_objects(bpy.context) == [other]


def test_in_pose_mode_the_meshes_are_computed_too(rigged):
    rig, obj, _ = rigged
    bpy.ops.object.mode_set(mode="POSE")
    assert bpy.ops.object.canonical_form(quality="draft") == {"FINISHED"}
    assert rig.mode == "POSE"
    assert np.isfinite(obj.data.shape_keys.key_blocks["Canonical Form"].value)


def test_an_empty_or_nothing_active_is_refused_with_a_reason(rigged):
    rig, *_ = rigged
    for each in rigged[1:]:
        each.modifiers.clear()
    assert meant_objects(bpy.context) == [rig]
    assert not bpy.ops.object.canonical_form.poll()
    rig.select_set(False)
    bpy.context.view_layer.objects.active = None
    assert not bpy.ops.object.canonical_form.poll()


def test_what_is_shown_is_taken_by_itself_where_an_armature_poses_the_mesh(rigged):
    rig, obj, _ = rigged
    panel = bpy.types.VIEW3D_PT_canonical_form
    assert "Input: as modelled" in drawn(panel)
    bpy.ops.object.mode_set(mode="EDIT")
    rig.data.edit_bones.new("Bone").tail = (0.0, 0.0, 1.0)
    bpy.ops.object.mode_set(mode="OBJECT")
    assert "Input: as modelled" in drawn(panel)
    rig.pose.bones["Bone"].location.x = 0.3
    bpy.context.view_layer.update()
    assert f"Input: frame 1, by {rig.name}" in drawn(panel)
    assert takes_shown("AUTO", [obj])
    obj.canonical_form.mesh = "BASE"
    assert "Input: without the pose" in drawn(panel)
    rig.data.pose_position = "REST"
    assert not takes_shown("AUTO", [obj])


def test_keys_and_modifiers_are_taken_as_shown_too(figure_object):
    assert not takes_shown("AUTO", [figure_object])
    figure_object.shape_key_add(name="Basis")
    smile = figure_object.shape_key_add(name="Smile")
    smile.data[0].co.x += 1
    smile.value = 0
    assert not takes_shown("AUTO", [figure_object])
    smile.value = 0.5
    assert takes_shown("AUTO", [figure_object])
    smile.mute = True
    assert not takes_shown("AUTO", [figure_object])
    figure_object.modifiers.new("Finer", "SUBSURF")
    figure_object.modifiers.new("Mirror", "MIRROR")
    assert not takes_shown("AUTO", [figure_object])  # they change no pose
    figure_object.modifiers.new("Bend", "SIMPLE_DEFORM")
    assert takes_shown("AUTO", [figure_object])


def test_a_form_of_ours_is_no_pose(figure_object):
    bpy.ops.object.canonical_form(quality="draft", mesh="AUTO")
    assert figure_object.data.shape_keys.key_blocks["Canonical Form"].value == 1
    assert not takes_shown("AUTO", [figure_object])


def test_what_hangs_on_the_active_empty_is_meant(figure_object):
    root = bpy.data.objects.new("Root", None)
    bpy.context.scene.collection.objects.link(root)
    figure_object.parent = root
    figure_object.select_set(False)
    bpy.context.view_layer.objects.active = root
    bpy.context.view_layer.update()
    assert meant_objects(bpy.context) == [figure_object]


def test_many_warnings_are_folded_under_their_number(figure_object):
    from addon.blender.records.record import require_record, write_record

    bpy.ops.object.canonical_form(quality="draft")
    record = require_record(figure_object.data)
    record.report.warnings = [f"Warning {number}." for number in range(4)]
    write_record(figure_object.data, record)
    assert "4 warnings" in drawn(bpy.types.VIEW3D_PT_canonical_form_result)


def test_a_new_object_becomes_active_and_shows_its_result(figure_object):
    assert bpy.ops.object.canonical_form(quality="draft", result="OBJECT") == {"FINISHED"}
    assert bpy.context.object == figure_object  # a script goes on with the objects that it chose
    make_active([bpy.data.objects["Figure Canonical Form"]])
    added = bpy.context.object
    assert added.name == "Figure Canonical Form"
    assert bpy.context.selected_objects == [added]
    assert "Clear" in drawn(bpy.types.VIEW3D_PT_canonical_form_result)


def test_the_form_as_shown_tells_its_frame_and_offers_another_run(figure_object):
    scene, panel = bpy.context.scene, bpy.types.VIEW3D_PT_canonical_form_result
    scene.frame_set(3)
    bpy.ops.object.canonical_form(quality="draft", mesh="SHOWN")
    assert "Of frame 3 (bones stay posed)" in drawn(panel)
    assert "Again at 3" not in drawn(panel)
    scene.frame_set(5)
    assert "Again at 5" in drawn(panel)
    bpy.ops.object.canonical_form(quality="draft")
    assert not any("frame" in line for line in drawn(panel))


def test_nothing_meant_is_asked_for(blender):
    assert drawn(bpy.types.VIEW3D_PT_canonical_form) == ["Select a mesh, or the armature that", "moves it."]
    others = [panel for panel in panels.CLASSES[1:] if issubclass(panel, bpy.types.Panel)]
    assert all(drawn(panel) == [] for panel in others)
