"""Upright forms, and forms on a reference, as objects stand in the scene."""

import bpy
import numpy as np
import pytest
from mathutils import Euler, Matrix

from addon.blender.jobs.reference import Reference
from tests.meshes.animals import giraffe

from .conftest import QUICK, add_object, snapshot


def form_of(obj):
    points = obj.data.shape_keys.key_blocks["Canonical Form"].data
    found = np.empty(3 * len(points), dtype=np.float32)
    points.foreach_get("co", found)
    return found.reshape(-1, 3).astype(float)


def in_scene(obj, points):
    return points @ np.array(obj.matrix_world)[:3, :3].T


def compute(obj, **how):
    for other in bpy.context.view_layer.objects:
        other.select_set(other == obj)
    bpy.context.view_layer.objects.active = obj
    bpy.context.view_layer.update()
    assert bpy.ops.object.canonical_form(**{**QUICK, **how}) == {"FINISHED"}


def centred(points):
    return points - points.mean(axis=0)


def test_upright_is_upright_in_the_scene_whatever_the_objects_transform(blender):
    animal = giraffe(cells=40)
    plain, turned = add_object("Plain", *animal), add_object("Turned", *animal)
    turned.matrix_world = Matrix.LocRotScale((4.0, 1, 0), Euler((0.7, -0.3, 2.0)), (1, 1, 1))
    for obj in (plain, turned):
        compute(obj, orientation="upright", landmark_count=100)
    one, two = (centred(in_scene(obj, form_of(obj))) for obj in (plain, turned))
    np.testing.assert_allclose(two, one, atol=2e-3 * np.ptp(one))
    compute(turned)  # as posed
    assert np.abs(centred(in_scene(turned, form_of(turned))) - one).max() > 0.05 * np.ptp(one)


def test_a_form_is_laid_onto_that_of_another_object(figure_object, arrays):
    vertices, faces = arrays
    turn = np.array(Euler((0.4, 1.1, -0.6)).to_matrix())
    other = add_object("Other", vertices @ turn.T + [0, 0, 3], faces)
    other.matrix_world = Matrix.LocRotScale((9.0, 0, 0), Euler((0.0, 0.0, 1.0)), (1, 1, 1))
    compute(figure_object, orientation="upright", landmark_count=100)
    before = snapshot(figure_object)
    compute(other, reference="Figure", landmark_count=100)
    assert snapshot(figure_object)["keys"] == before["keys"]
    one, two = (in_scene(obj, form_of(obj)) for obj in (figure_object, other))
    np.testing.assert_allclose(two, one, atol=2e-3 * np.ptp(one))
    names = [[group.name for group in obj.vertex_groups] for obj in (figure_object, other)]
    assert names[0] == names[1]
    patches = [
        np.array([[colour.color[:] for colour in obj.data.color_attributes["Patches"].data]])
        for obj in (figure_object, other)
    ]
    np.testing.assert_allclose(patches[0], patches[1], atol=1e-3)


@pytest.mark.parametrize(("name", "words"), [("Nobody", "no object Nobody"), ("Plain", "has no form to refer to")])
def test_a_reference_without_a_form_is_refused_in_a_sentence(figure_object, arrays, name, words):
    add_object("Plain", *arrays)
    before = snapshot(figure_object)
    with pytest.raises(RuntimeError, match=words):
        compute(figure_object, reference=name)
    assert snapshot(figure_object) == before


def test_the_panel_offers_orientation_and_reference(figure_object):
    chosen = bpy.context.object.canonical_form
    assert [each.identifier for each in chosen.bl_rna.properties["orientation"].enum_items] == [
        "posed", "upright", "two_legs", "all_fours",
    ]  # fmt: skip
    assert chosen.reference is None


def test_a_mirrored_base_mesh_is_refused_and_can_be_taken_as_shown(figure_object):
    figure_object.modifiers.new("Mirror", "MIRROR").use_axis = (False, True, False)
    before = snapshot(figure_object)
    with pytest.raises(RuntimeError, match="has to stay on the mirror"):
        compute(figure_object, orientation="upright", landmark_count=100)
    assert snapshot(figure_object) == before
    compute(figure_object, orientation="upright", mesh="SHOWN", result="OBJECT")


def test_a_body_of_several_objects_is_a_reference_as_a_whole(character):
    for obj in character.values():
        obj.select_set(True)
    names = list(character)
    bpy.context.view_layer.update()
    assert bpy.ops.object.canonical_form(**QUICK, objects="TOGETHER") == {"FINISHED"}
    reference = Reference("trunk").computed()
    assert len(reference.vertices) == sum(len(character[name].data.vertices) for name in names)
    assert len(reference.bodies) >= 1


def test_a_reference_counts_with_all_limbs_straight(figure_object, arrays):
    compute(figure_object, orientation="upright", landmark_count=100)
    other = add_object("Other", *arrays)
    compute(other, reference="Figure", landmark_count=100)
    whole = form_of(other)
    compute_limb(figure_object)
    assert np.abs(form_of(figure_object) - whole).max() > 0.5
    compute(other, reference="Figure", landmark_count=100)
    np.testing.assert_allclose(form_of(other), whole, atol=1e-4)


def compute_limb(obj):
    for other in bpy.context.view_layer.objects:
        other.select_set(other == obj)
    bpy.context.view_layer.objects.active = obj
    assert bpy.ops.object.canonical_form_limb(patch=2, only=True) == {"FINISHED"}


def test_an_object_that_is_edited_can_be_its_own_reference(figure_object):
    compute(figure_object)
    before = form_of(figure_object)
    bpy.ops.object.mode_set(mode="EDIT")
    assert bpy.ops.object.canonical_form(**QUICK, reference="Figure") == {"FINISHED"}
    assert figure_object.mode == "EDIT"
    bpy.ops.object.mode_set(mode="OBJECT")
    np.testing.assert_allclose(form_of(figure_object), before, atol=1e-3)


def test_a_form_under_modifiers_is_no_reference(figure_object, arrays):
    figure_object.modifiers.new("Smooth", "SMOOTH")
    compute(figure_object, mesh="SHOWN")
    other = add_object("Other", *arrays)
    with pytest.raises(RuntimeError, match="under modifiers"):
        compute(other, reference="Figure", landmark_count=100)
