"""Feature points by hand, steps, distances, sources and targets of a run."""

import bpy
import numpy as np
import pytest

from addon.blender.objects.mesh_reading import read_evaluated, read_mesh
from addon.blender.records.record import require_record
from addon.core import Settings, canonical_form
from addon.core.distance_fields import distance_field
from addon.core.distances.kinds import KINDS
from addon.interface import result_panel
from addon.interface.limb_operators import select_vertices
from tests.blender.conftest import QUICK, add_object, drawn, flat, snapshot


def select(obj, vertices):
    select_vertices(obj.data, np.isin(np.arange(len(obj.data.vertices)), list(vertices)), extend=False)


def members(obj, name):
    group = obj.vertex_groups[name]
    return [v.index for v in obj.data.vertices if any(p.group == group.index and p.weight > 0 for p in v.groups)]


@pytest.mark.parametrize("mode", ["OBJECT", "EDIT"])
def test_feature_points_by_hand(figure_object, mode):
    obj = figure_object
    choose = bpy.ops.object.canonical_form_choose
    select(obj, {5, 100, 300})
    bpy.ops.object.mode_set(mode=mode)
    assert choose(how="SET") == {"FINISHED"}
    chosen = bpy.context.object.canonical_form
    assert (chosen.feature_source, chosen.feature_group) == ("GROUP", "Chosen Feature Points")
    assert obj.mode == mode
    bpy.ops.object.mode_set(mode="OBJECT")
    select(obj, {7, 100})
    choose(how="ADD")
    assert members(obj, "Chosen Feature Points") == [5, 7, 100, 300]
    choose(how="REMOVE")
    assert members(obj, "Chosen Feature Points") == [5, 300]
    bpy.ops.object.canonical_form(**QUICK, feature_group="Chosen Feature Points")
    assert require_record(obj.data).report.feature_points == [5, 300]
    bpy.ops.object.canonical_form_clear()
    assert members(obj, "Chosen Feature Points") == [5, 300]  # the user's own


def test_adding_starts_from_the_detected_ones(figure_object):
    bpy.ops.object.canonical_form(**QUICK)
    found = require_record(figure_object.data).report.feature_points
    assert 7 not in found
    select(figure_object, {7})
    bpy.ops.object.canonical_form_choose(how="ADD")
    assert members(figure_object, "Chosen Feature Points") == sorted([*found, 7])


def test_slips_of_the_hand_are_refused(figure_object):
    select(figure_object, set())
    with pytest.raises(RuntimeError, match="No vertex is selected"):
        bpy.ops.object.canonical_form_choose(how="SET")
    select(figure_object, set(range(500)))
    with pytest.raises(RuntimeError, match="500 feature points"):
        bpy.ops.object.canonical_form_choose(how="SET")
    with pytest.raises(RuntimeError, match="no vertex group Nose"):
        bpy.ops.object.canonical_form(feature_group="Nose")
    figure_object.vertex_groups.new(name="Nose")
    with pytest.raises(RuntimeError, match="no vertex group Nose with vertices in it"):
        bpy.ops.object.canonical_form(feature_group="Nose")


def test_detect_only_and_patches_only(figure_object):
    before = snapshot(figure_object)
    bpy.ops.object.canonical_form(step="FEATURES")
    assert [group.name for group in figure_object.vertex_groups] == ["Feature Points"]
    assert [each.name for each in figure_object.data.color_attributes] == ["Auto Diffusion Function"]
    assert len(drawn(result_panel.VIEW3D_PT_canonical_form_result)) > 1
    assert drawn(result_panel.VIEW3D_PT_canonical_form_limbs) == []
    bpy.ops.object.canonical_form(step="PATCHES")
    assert len(figure_object.vertex_groups) == 6
    assert figure_object.data.shape_keys is None
    assert "canonical_form_patches" in drawn(result_panel.VIEW3D_PT_canonical_form_limbs)
    found = require_record(figure_object.data).report.feature_points
    bpy.ops.object.canonical_form(**QUICK)
    bpy.ops.object.canonical_form(step="PATCHES")  # removes the form again
    assert figure_object.data.shape_keys is None
    assert require_record(figure_object.data).report.feature_points == found
    bpy.ops.object.canonical_form_clear()
    assert snapshot(figure_object) == before


def test_a_number_of_feature_points(figure_object):
    bpy.ops.object.canonical_form(**QUICK, feature_count=3)
    assert len(require_record(figure_object.data).report.feature_points) == 3


@pytest.mark.parametrize("kind", list(KINDS))
def test_distances_are_shown(figure_object, kind):
    obj = figure_object
    select(obj, {10})
    assert bpy.ops.object.canonical_form_distance(kind=kind) == {"FINISHED"}
    field = distance_field(*read_mesh(obj.data), [10], kind)
    group = obj.vertex_groups[f"{KINDS[kind].label} Weights"]
    weights = np.array([group.weight(index) for index in range(len(obj.data.vertices))])
    np.testing.assert_allclose(weights, field / field.max(), atol=6e-4)
    colours = np.frombuffer(flat(obj.data.color_attributes[KINDS[kind].label].data, "color", 4), np.float32).reshape(
        -1, 4
    )
    lightness = colours[:, :3] @ [0.2126, 0.7152, 0.0722]
    assert np.argmin(lightness) == 10
    assert obj.data.color_attributes.active_color.name == KINDS[kind].label
    bpy.ops.object.canonical_form_distance(kind=kind, isolines=8)
    assert [each.name for each in obj.data.color_attributes] == [KINDS[kind].label]  # in place of the first
    assert len(obj.vertex_groups) == 1


def test_distances_that_the_user_changed_are_kept(figure_object):
    obj = figure_object
    select(obj, {10})
    bpy.ops.object.canonical_form_distance(kind="heat")
    obj.vertex_groups["Heat Geodesic Weights"].add([3], 0.123, "REPLACE")
    obj.data.color_attributes["Heat Geodesic"].data[3].color = (1, 0, 0, 1)
    bpy.ops.object.canonical_form_distance(kind="heat")
    assert obj.vertex_groups["Heat Geodesic Weights"].weight(3) == pytest.approx(0.123)
    assert len(obj.vertex_groups) == len(obj.data.color_attributes) == 2


def test_distances_need_a_selection(figure_object):
    select(figure_object, set())
    with pytest.raises(RuntimeError, match="No vertex is selected"):
        bpy.ops.object.canonical_form_distance()
    select(figure_object, set(range(len(figure_object.data.vertices))))
    with pytest.raises(RuntimeError, match="All vertices are selected"):
        bpy.ops.object.canonical_form_distance()


def test_several_objects_in_one_run(figure_object, arrays):
    other = add_object("Other", arrays[0] * 2, arrays[1])
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.scene.collection.objects.link(camera)
    loose = add_object("Points", np.eye(3), [])
    for obj in (figure_object, other, camera, loose):
        obj.select_set(True)
    bpy.context.view_layer.objects.active = figure_object
    before = snapshot(loose)
    bpy.ops.object.canonical_form(**QUICK)
    for obj in (figure_object, other):
        assert "Canonical Form" in obj.data.shape_keys.key_blocks
    assert snapshot(loose) == before
    bpy.ops.object.canonical_form_clear()
    assert figure_object.data.shape_keys is other.data.shape_keys is None


def test_one_bad_object_does_not_stop_the_others(figure_object, arrays):
    line = add_object("Line", np.outer(np.arange(3), np.ones(3)), [[0, 1, 2]])
    figure_object.select_set(True)
    bpy.context.view_layer.objects.active = figure_object
    bpy.ops.object.canonical_form(**QUICK)
    assert figure_object.data.shape_keys is not None
    assert line.data.shape_keys is None
    bpy.context.view_layer.objects.active = line
    bpy.ops.object.canonical_form_clear.poll()


def bent(obj):
    """Put an armature with a bent bone on an object."""
    armature = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    bpy.context.scene.collection.objects.link(armature)
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    low = armature.data.edit_bones.new("Low")
    low.tail = (0, 0, 1)
    high = armature.data.edit_bones.new("High")
    high.head, high.tail, high.parent = (0, 0, 1), (0, 0, 2), low
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.context.view_layer.objects.active = obj
    height = np.array([vertex.co.z for vertex in obj.data.vertices])
    for name, weights in (("Low", 1 - (height > 0.5)), ("High", 1.0 * (height > 0.5))):
        group = obj.vertex_groups.new(name=name)
        for index, weight in enumerate(weights):
            group.add([index], float(weight), "REPLACE")
    obj.modifiers.new("Rig", "ARMATURE").object = armature
    armature.pose.bones["High"].rotation_mode = "XYZ"
    armature.pose.bones["High"].rotation_euler = (0.6, 0.2, 0.0)
    bpy.context.view_layer.update()


def wanted_form(obj, *, rig=False):
    """The form of what is shown; a rig at rest shows the mesh."""
    shown, (base, faces) = read_evaluated(obj)[0], read_mesh(obj.data)
    return canonical_form(shown, faces, Settings(**QUICK), rest=base if rig else None).vertices


def test_the_posed_mesh_gets_a_key_that_shows_its_form(figure_object):
    bent(figure_object)
    wanted = wanted_form(figure_object, rig=True)
    assert np.abs(wanted - canonical_form(*read_mesh(figure_object.data), Settings(**QUICK)).vertices).max() > 0.05
    bpy.ops.object.canonical_form(**QUICK, mesh="SHOWN")
    bpy.context.view_layer.update()
    size = np.ptp(wanted, axis=0).max()
    np.testing.assert_allclose(read_evaluated(figure_object)[0], wanted, atol=1e-3 * size)
    once = flat(figure_object.data.shape_keys.key_blocks["Canonical Form"].data, "co", 3)
    bpy.ops.object.canonical_form(**QUICK, mesh="SHOWN")  # of the pose again, not of the form
    again = flat(figure_object.data.shape_keys.key_blocks["Canonical Form"].data, "co", 3)
    np.testing.assert_allclose(np.frombuffer(again, np.float32), np.frombuffer(once, np.float32), atol=1e-3 * size)


def test_other_keys_and_a_lattice_count_as_shown(figure_object):
    obj = figure_object
    obj.shape_key_add(name="Basis")
    taller = obj.shape_key_add(name="Taller", from_mix=False)
    for point in taller.data:
        point.co.z *= 1.3
    taller.value = 1.0
    lattice = bpy.data.objects.new("Cage", bpy.data.lattices.new("Cage"))
    lattice.scale = (8, 8, 8)
    bpy.context.scene.collection.objects.link(lattice)
    lattice.data.points[0].co_deform.x += 0.1
    obj.modifiers.new("Cage", "LATTICE").object = lattice
    bpy.context.view_layer.update()
    before = snapshot(obj)
    wanted = wanted_form(obj)
    bpy.ops.object.canonical_form(**QUICK, mesh="SHOWN")
    bpy.context.view_layer.update()
    np.testing.assert_allclose(read_evaluated(obj)[0], wanted, atol=1e-3 * np.ptp(wanted, axis=0).max())
    bpy.ops.object.canonical_form_clear()
    assert snapshot(obj) == before


@pytest.mark.parametrize("mesh", ["BASE", "SHOWN"])
def test_the_result_on_a_new_object_leaves_the_mesh_alone(figure_object, mesh):
    bpy.ops.object.canonical_form(**QUICK)
    bent(figure_object)
    before = snapshot(figure_object)
    bpy.ops.object.canonical_form(**QUICK, mesh=mesh, result="OBJECT")
    assert snapshot(figure_object) == before
    added = bpy.data.objects["Figure Canonical Form"]
    assert [key.name for key in added.data.shape_keys.key_blocks] == ["Basis", "Canonical Form"]
    assert not added.modifiers
    assert [group.name for group in added.vertex_groups].count("Patch 1") == 1
    assert "Patch 1.001" not in added.vertex_groups


def test_where_modifiers_change_the_vertices_a_new_object_is_made(figure_object):
    figure_object.modifiers.new("Fine", "SUBSURF").levels = 1
    before = snapshot(figure_object)
    bpy.ops.object.canonical_form(**QUICK, mesh="SHOWN")
    assert snapshot(figure_object) == before
    added = bpy.data.objects["Figure Canonical Form"]
    assert len(added.data.vertices) > 3 * len(figure_object.data.vertices)
    assert any("on a new object" in warning for warning in require_record(added.data).report.warnings)


def test_the_distance_tool_tells_what_was_mended(figure_object, capfd):
    obj = figure_object
    select(obj, {10})
    obj.data.polygons[0].vertices = obj.data.polygons[1].vertices[:]
    bpy.ops.object.canonical_form_distance(kind="heat")
    assert "Warning: 1 face was left out" in capfd.readouterr().out


def test_too_little_memory_is_reported(figure_object, monkeypatch):
    select(figure_object, {10})
    before = snapshot(figure_object)

    def exhausted(*_, **__):
        raise MemoryError

    monkeypatch.setattr(f"{distance_field.__module__}.distance_field", exhausted)
    with pytest.raises(RuntimeError, match="Not enough memory"):
        bpy.ops.object.canonical_form_distance(kind="heat")
    assert snapshot(figure_object) == before


def test_the_memory_limit_holds_for_distances_too(figure_object):
    select(figure_object, {10})
    bpy.context.object.canonical_form.memory_limit = 0.051
    with pytest.raises(RuntimeError, match=r"more than the limit of 0\.051 GB. Fast marching"):
        bpy.ops.object.canonical_form_distance(kind="heat")
