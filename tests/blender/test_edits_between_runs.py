"""What users change between two runs stays, and the new result shows all the same."""

import bpy
import numpy as np
import pytest

from addon.blender.records.record import require_record, write_record
from tests.meshes import shapes

from .conftest import QUICK, add_object, snapshot
from .test_limbs import keys_of, points_of

pytestmark = pytest.mark.usefixtures("computed_once")


def compute():
    assert bpy.ops.object.canonical_form(**QUICK) == {"FINISHED"}


def shown(obj):
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    return np.array([vertex.co for vertex in evaluated.vertices])


def edited_basis(obj):
    """Move a vertex of the Basis in Edit Mode; Blender moves it in the keys, too."""
    obj.active_shape_key_index = 0
    bpy.ops.mesh.select_all(action="DESELECT")
    bpy.ops.object.mode_set(mode="OBJECT")
    obj.data.vertices[7].select = True
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.transform.translate(value=(0.0, 0.0, 0.01))


def deleted_vertex(obj):
    bpy.ops.mesh.select_all(action="DESELECT")
    bpy.ops.object.mode_set(mode="OBJECT")
    obj.data.vertices[7].select = True
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.dissolve_verts()


@pytest.mark.parametrize("edited", [edited_basis, deleted_vertex])
@pytest.mark.parametrize("in_betweens", [False, True])
def test_the_form_of_an_edited_mesh_is_shown_alone(figure_object, edited, in_betweens):
    compute()
    if in_betweens:
        bpy.ops.object.canonical_form_in_betweens(count=2)
    bpy.ops.object.mode_set(mode="EDIT")
    edited(figure_object)
    bpy.ops.object.mode_set(mode="OBJECT")
    compute()
    (name,) = require_record(figure_object.data).keys
    form = points_of(keys_of(figure_object)[name])
    np.testing.assert_allclose(shown(figure_object), form, atol=1e-5)
    others = [key for key in keys_of(figure_object) if key.name not in ("Basis", name)]
    assert others  # they may hold changes
    assert all(key.value == 0.0 for key in others)


def test_an_animated_form_of_an_edited_mesh_is_switched_off(figure_object):
    compute()
    keys_of(figure_object)["Canonical Form"].keyframe_insert("value", frame=1)
    bpy.ops.object.mode_set(mode="EDIT")
    edited_basis(figure_object)
    bpy.ops.object.mode_set(mode="OBJECT")
    compute()
    bpy.context.scene.frame_set(10)
    (name,) = require_record(figure_object.data).keys
    np.testing.assert_allclose(shown(figure_object), points_of(keys_of(figure_object)[name]), atol=1e-5)


def test_a_pose_does_not_take_an_animated_form_away(figure_object):
    compute()
    driver = keys_of(figure_object)["Canonical Form"].driver_add("value").driver
    driver.expression = "0.5"
    bpy.context.view_layer.update()
    before = snapshot(figure_object)
    with pytest.raises(RuntimeError, match="it is animated"):
        bpy.ops.object.canonical_form_pose_like(pose="T", anyway=True, **QUICK)
    assert snapshot(figure_object) == before
    compute()  # of the same name
    assert len(figure_object.data.shape_keys.animation_data.drivers) == 1


def posed_like_another(obj):
    """A pose of its own figure is quick: no build is looked for."""
    add_object("Other", *shapes.figure(15))
    bpy.context.view_layer.objects.active = obj
    for each in bpy.data.objects:
        each.select_set(each == obj)
    bpy.ops.object.canonical_form_pose_like(pose="OBJECT", like="Other", **QUICK)


def test_a_new_colour_of_a_patch_leaves_those_of_the_match(figure_object):
    posed_like_another(figure_object)
    mesh = figure_object.data

    def colours(name):
        values = np.empty(4 * len(mesh.vertices), dtype=np.float32)
        mesh.color_attributes[name].data.foreach_get("color", values)
        return values

    match, patches = colours("Match"), colours("Patches")
    mesh.canonical_form_patches[1].colour = (1.0, 0.0, 0.5)
    np.testing.assert_array_equal(colours("Match"), match)
    assert (colours("Patches") != patches).any()


def test_quotes_in_a_name_do_not_hide_a_key(figure_object):
    posed_like_another(figure_object)
    keys = figure_object.data.shape_keys
    bpy.ops.object.canonical_form_in_betweens(count=2)
    between = keys.key_blocks[-1]
    between.name = 'half "way"'
    keys["Pose to Form"] = 0.66
    keys.update_tag()
    bpy.context.view_layer.update()
    assert between.value > 0.5
    bpy.ops.object.canonical_form_remove_in_betweens()
    assert between.value == 0.0


def groups_and_colours(obj):
    return sorted([*obj.vertex_groups.keys(), *obj.data.color_attributes.keys()])


@pytest.mark.parametrize("again", [compute, bpy.ops.object.canonical_form_clear])
def test_groups_and_colours_of_an_edited_mesh_do_not_pile_up(figure_object, again):
    """Blender makes up weights and colours for new vertices, which are nobody's work."""
    before = groups_and_colours(figure_object)
    compute()
    written = groups_and_colours(figure_object)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.subdivide()
    bpy.ops.object.mode_set(mode="OBJECT")
    again()
    assert groups_and_colours(figure_object) == (written if again is compute else before)


def edited(obj, operator):
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT" if operator == "subdivide" else "DESELECT")
    bpy.ops.object.mode_set(mode="OBJECT")
    if operator != "subdivide":
        obj.data.vertices[7].select = True
    bpy.ops.object.mode_set(mode="EDIT")
    getattr(bpy.ops.mesh, operator)()
    bpy.ops.object.mode_set(mode="OBJECT")


@pytest.mark.parametrize("operator", ["subdivide", "dissolve_verts"])
@pytest.mark.parametrize("painted", ["group", "colours"])
def test_what_was_painted_stays_on_an_edited_mesh(figure_object, operator, painted):
    compute()
    if painted == "group":
        figure_object.vertex_groups["Patch 1"].add([30, 31, 32], 0.25, "REPLACE")
    else:
        for number in range(30, 60):
            figure_object.data.color_attributes["Patches"].data[number].color = (0.0, 0.0, 0.0, 1.0)
    edited(figure_object, operator)
    bpy.ops.object.canonical_form_clear()
    kept = "Patch 1" if painted == "group" else "Patches"
    assert kept in groups_and_colours(figure_object)


def test_a_record_from_elsewhere_takes_nothing_away_on_an_edited_mesh(figure_object):
    compute()
    figure_object.vertex_groups.new(name="Mine").add([1], 1.0, "REPLACE")
    record = require_record(figure_object.data)
    record.groups["Mine"], record.hidden[".canonical_form_patch"] = "x", "y"
    write_record(figure_object.data, record)
    bpy.ops.object.canonical_form_clear()
    assert "Mine" in figure_object.vertex_groups


def test_modifiers_go_on_using_a_group_that_makes_room(figure_object):
    compute()
    figure_object.vertex_groups["Patch 2"].add([0, 1, 2], 0.25, "REPLACE")
    figure_object.modifiers.new("Smooth", "SMOOTH").vertex_group = "Patch 2"
    own = figure_object.vertex_groups.new(name="Canonical Form")  # of another kind than the key of that name
    own.add([4], 1.0, "REPLACE")
    keys_of(figure_object)["Canonical Form"].data[0].co.x += 1.0
    compute()
    assert figure_object.modifiers["Smooth"].vertex_group == "Patch 2 (kept)"
    assert "Canonical Form" in figure_object.vertex_groups


def test_what_was_changed_by_hand_makes_room_for_the_new(figure_object):
    compute()
    figure_object.vertex_groups["Patch 2"].add([0, 1, 2], 0.25, "REPLACE")
    figure_object.data.color_attributes["Patches"].data[0].color = (0.5, 0.5, 0.5, 1.0)
    keys_of(figure_object)["Canonical Form"].data[0].co.x += 1.0
    compute()
    new = {"Patch 2", "Patches.001", "Canonical Form.001"}  # materials and animation find the old ones by their names
    kept = {"Patch 2 (kept)", "Patches", "Canonical Form"}
    assert new | kept <= {*groups_and_colours(figure_object), *keys_of(figure_object).keys()}
    assert any("Patch 2 (kept)" in each for each in require_record(figure_object.data).report.warnings)
    bpy.ops.object.canonical_form_clear()
    there = {*groups_and_colours(figure_object), *keys_of(figure_object).keys()}
    assert kept <= there
    assert not new & there
