"""A result kept: as the mesh's own shape, or as a new object of what is shown."""

from typing import Any

import bpy
import numpy as np
import pytest

from addon.blender.objects.mesh_reading import read_evaluated
from addon.blender.results.kept_form import KEPT_PROPERTY, keep_refusal
from tests.blender.characters import activate
from tests.blender.conftest import QUICK, add_object, snapshot
from tests.blender.rig_scenes import rigged_halves


def shape(obj):
    return np.array([vertex.co for vertex in obj.data.vertices])


def key_of(obj, name):
    return np.array([point.co for point in obj.data.shape_keys.key_blocks[name].data])


def ours(obj):
    """Names of groups, colours, attributes and properties that a run writes."""
    names = (*obj.vertex_groups.keys(), *obj.data.color_attributes.keys(), *obj.data.keys())
    begins = ("Patch", "Feature", "Auto", "Match", "canonical_form")
    return [name for name in names if name.startswith(begins) and name != KEPT_PROPERTY]


def test_the_form_becomes_the_shape_and_the_pose_stays_as_a_key(figure_object):
    before = shape(figure_object)
    bpy.ops.object.canonical_form(**QUICK)
    form = key_of(figure_object, "Canonical Form")
    assert bpy.ops.object.canonical_form_keep() == {"FINISHED"}
    assert np.allclose(shape(figure_object), form, atol=1e-6)
    assert np.allclose(key_of(figure_object, "Basis"), form, atol=1e-6)
    assert np.allclose(key_of(figure_object, "Posed"), before, atol=1e-6)
    assert figure_object.data.shape_keys.key_blocks["Posed"].value == 0.0
    assert "Canonical Form" not in figure_object.data.shape_keys.key_blocks
    assert ours(figure_object) == []
    assert keep_refusal(figure_object) is not None
    bpy.ops.object.canonical_form(**QUICK)  # and of the kept shape again
    assert "Canonical Form" in figure_object.data.shape_keys.key_blocks


def test_keys_of_the_user_go_on_changing_the_shape(figure_object):
    figure_object.shape_key_add(name="Basis")
    smile = figure_object.shape_key_add(name="Smile")
    smile.data[5].co.z += 0.1
    pushed = np.linalg.norm(key_of(figure_object, "Smile") - key_of(figure_object, "Basis"), axis=1)
    bpy.ops.object.canonical_form(**QUICK)
    bpy.ops.object.canonical_form_in_betweens(count=2)
    bpy.ops.object.canonical_form_keep()
    assert figure_object.data.shape_keys.key_blocks.keys() == ["Basis", "Smile", "Posed"]
    now = np.linalg.norm(key_of(figure_object, "Smile") - key_of(figure_object, "Basis"), axis=1)
    assert np.allclose(now, pushed, atol=1e-5)


def test_a_pose_of_several_objects_is_kept_on_each(blender, lender):
    objects, armature = rigged_halves(lender)
    for obj in objects:
        obj.modifiers.clear()
        obj.parent = None
    bpy.data.objects.remove(armature)
    bpy.context.view_layer.update()
    activate(*objects)
    bpy.ops.object.canonical_form_pose_like(pose="T", objects="TOGETHER", anyway=True, **QUICK)
    posed = [key_of(obj, "T-Pose") for obj in objects]
    bpy.ops.object.canonical_form_keep()
    assert all(np.allclose(shape(obj), each, atol=1e-6) for obj, each in zip(objects, posed, strict=True))
    assert [obj.data.shape_keys.key_blocks.keys() for obj in objects] == [["Basis", "Posed"]] * 2


@pytest.mark.parametrize("why", ["nothing", "rigged", "a twin rigged", "animated", "half", "muted", "masked"])
def test_what_cannot_be_kept_is_refused_and_nothing_changes(figure_object, lender, why):
    obj = figure_object
    if why == "rigged":
        (obj, _), _ = rigged_halves(lender)
        activate(obj)
    if why != "nothing":
        bpy.ops.object.canonical_form(mesh="AUTO", **QUICK)
    key: Any = None if why == "nothing" else obj.data.shape_keys.key_blocks["Canonical Form"]
    if why == "animated":
        key.keyframe_insert("value", frame=1)
    elif why == "half":
        key.value = 0.5
    elif why == "muted":
        key.mute = True
    elif why == "masked":
        key.vertex_group = obj.vertex_groups[0].name
    elif why == "a twin rigged":
        twin = bpy.data.objects.new("Twin", obj.data)
        bpy.context.scene.collection.objects.link(twin)
        rig = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
        twin.modifiers.new("Armature", "ARMATURE").object = rig
    before = snapshot(obj)
    said = {
        "nothing": "no shape key",
        "animated": "animated",
        "half": "in full",
        "muted": "in full",
        "masked": "in full",
    }
    with pytest.raises(RuntimeError, match=said.get(why, "New Object")):
        bpy.ops.object.canonical_form_keep()
    assert snapshot(obj) == before


def test_a_new_object_is_what_is_shown_and_nothing_is_computed(figure_object, monkeypatch):
    bpy.ops.object.canonical_form(**QUICK)
    figure_object.data.shape_keys.key_blocks["Canonical Form"].value = 0.5
    figure_object.modifiers.new("Finer", "SUBSURF").levels = 1
    bpy.context.view_layer.update()
    shown, before = read_evaluated(figure_object)[0], snapshot(figure_object)
    monkeypatch.setattr("addon.core.canonical_form", None)
    assert bpy.ops.object.canonical_form_copy() == {"FINISHED"}
    added = bpy.context.object
    assert added.name == "Figure Canonical Form"
    assert np.allclose(shape(added), shown, atol=1e-6)
    assert added.data.shape_keys is None
    assert not added.modifiers
    assert ours(added) == []
    assert snapshot(figure_object) == before


def test_the_objects_of_a_body_are_copied_together(blender, lender):
    objects, _ = rigged_halves(lender)
    activate(*objects)
    bpy.ops.object.canonical_form(mesh="AUTO", objects="TOGETHER", **QUICK)
    shown = [read_evaluated(obj)[0] for obj in objects]
    bpy.ops.object.canonical_form_copy()
    copies = [bpy.data.objects[f"{obj.name} Canonical Form"] for obj in objects]
    assert all(np.allclose(shape(copy), each, atol=1e-6) for copy, each in zip(copies, shown, strict=True))
    assert {*bpy.context.selected_objects} == {*copies}


def test_without_a_result_there_is_nothing_to_copy(figure_object):
    add_object("Other", *[np.array(each) for each in ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])])
    with pytest.raises(RuntimeError, match="no canonical form"):
        bpy.ops.object.canonical_form_copy()


def test_kept_shapes_are_known_again_and_keys_of_that_name_are_not_taken_for_them(figure_object):
    first = shape(figure_object)
    figure_object.shape_key_add(name="Basis")
    smile = figure_object.shape_key_add(name="Posed.smile")
    smile.data[5].co.z += 0.1
    bpy.ops.object.canonical_form(**QUICK)
    bpy.ops.object.canonical_form_keep()
    keys = figure_object.data.shape_keys.key_blocks
    moved = np.linalg.norm(key_of(figure_object, "Posed.smile") - key_of(figure_object, "Basis"), axis=1)
    assert np.flatnonzero(moved > 1e-5).tolist() == [5]
    keys["Posed"].name = "Before"
    bpy.ops.object.canonical_form(**QUICK)
    bpy.ops.object.canonical_form_keep()
    assert np.array_equal(key_of(figure_object, "Before"), first)
    assert keys.keys() == ["Basis", "Posed.smile", "Before", "Posed"]
