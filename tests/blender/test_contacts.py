"""Skin that has grown together, in Blender: parted for the form, shown by a group, gone after Clear."""

import bpy
import numpy as np
import pytest

from addon.blender.records.record import require_record
from addon.interface.result_panel import VIEW3D_PT_canonical_form_result
from tests.blender.conftest import add_object, drawn, snapshot
from tests.meshes.fused import fused_figure
from tests.meshes.rings import ring


@pytest.fixture(scope="module")
def figure():
    return fused_figure(86.0, 0.015)


def group_of(obj, name):
    number = obj.vertex_groups[name].index
    return {vertex.index for vertex in obj.data.vertices if any(part.group == number for part in vertex.groups)}


def test_the_form_is_opened_and_a_group_shows_where(blender, figure, capfd):
    vertices, faces, _ = figure
    obj = add_object("Scan", vertices, faces)
    before = snapshot(obj)
    assert bpy.ops.object.canonical_form(contacts="open", quality="draft") == {"FINISHED"}
    assert "grown together" in capfd.readouterr().out
    assert "Contacts" in obj.vertex_groups
    here = group_of(obj, "Contacts")
    assert 100 < len(here) < len(vertices) / 4
    record = require_record(obj.data)
    assert list(record.groups)[-1] == "Contacts"
    assert len(record.groups) == len(record.report.feature_points) + 2
    form = np.empty((len(vertices), 3), dtype=np.float32)
    obj.data.shape_keys.key_blocks["Canonical Form"].points.foreach_get("co", form.ravel())
    hands = vertices[:, 2] < np.quantile(vertices[:, 2], 0.6)
    hands &= np.abs(vertices[:, 0]) > 0.2
    assert np.abs(form[hands, 0]).min() > np.abs(vertices[hands, 0]).min()  # the arms are spread
    assert "Cut in a New Object" in drawn(VIEW3D_PT_canonical_form_result)
    assert bpy.ops.object.canonical_form_limb(patch=0, only=True) == {"FINISHED"}
    assert bpy.ops.object.canonical_form_clear() == {"FINISHED"}
    assert snapshot(obj) == before


def test_a_run_without_takes_the_group_away(blender, figure):
    vertices, faces, _ = figure
    obj = add_object("Scan", vertices, faces)
    assert bpy.ops.object.canonical_form(contacts="open", quality="draft", max_iterations=2) == {"FINISHED"}
    assert bpy.ops.object.canonical_form(contacts="keep", quality="draft", max_iterations=2) == {"FINISHED"}
    assert "Contacts" not in obj.vertex_groups


def add_ring():
    """A torus of quads with a UV map, a vertex group, a colour, materials and a face attribute."""
    points, triangles, along = ring()
    half = len(triangles) // 2
    quads = np.column_stack([triangles[:half], triangles[half:, 2]])
    obj = add_object("Ring", points, quads)
    mesh = obj.data
    uvs = mesh.uv_layers.new(name="UV").data
    loops = np.array([loop.vertex_index for loop in mesh.loops])
    uvs.foreach_set("uv", np.column_stack([along[loops], points[loops, 2]]).astype(np.float32).ravel())
    group = obj.vertex_groups.new(name="Mine")
    for weight in (0.25, 0.75):
        group.add(np.flatnonzero((along > 3) == (weight > 0.5)).tolist(), weight, "REPLACE")
    numbers = mesh.attributes.new("Number", "INT", "FACE")
    numbers.data.foreach_set("value", np.arange(len(mesh.polygons), dtype=np.int32))
    for name in ("One", "Two"):
        mesh.materials.append(bpy.data.materials.new(name))
    mesh.polygons.foreach_set("material_index", (along[quads].max(axis=1) > 3).astype(np.int32))
    return obj, along


def select(obj, vertices):
    chosen = np.zeros(len(obj.data.vertices), dtype=bool)
    chosen[vertices] = True
    obj.data.vertices.foreach_set("select", chosen)


def euler(mesh):
    return len(mesh.vertices) - len(mesh.edges) + len(mesh.polygons)


def test_marks_are_kept_in_a_group_and_taken_off(blender):
    obj, along = add_ring()
    select(obj, [])
    before = snapshot(obj)
    select(obj, np.flatnonzero(along == 0))
    assert bpy.ops.object.canonical_form_mark(marks="PART", how="ADD") == {"FINISHED"}
    assert len(group_of(obj, "Part Here")) == 16
    assert obj.vertex_groups.active.name == "Mine"
    select(obj, np.flatnonzero(along == 0)[:4])
    assert bpy.ops.object.canonical_form_mark(marks="PART", how="REMOVE") == {"FINISHED"}
    assert len(group_of(obj, "Part Here")) == 12
    assert bpy.ops.object.canonical_form_mark(marks="PART", how="CLEAR") == {"FINISHED"}
    select(obj, [])
    assert snapshot(obj) == before


def test_seams_can_be_marked_and_nothing_is_no_mark(blender, capfd):
    obj, along = add_ring()
    select(obj, [])
    for source in ("SELECTED", "SEAMS"):
        with pytest.raises(RuntimeError):
            bpy.ops.object.canonical_form_mark(marks="PART", how="ADD", source=source)
    for edge in obj.data.edges:
        edge.use_seam = all(along[vertex] == 0 for vertex in edge.vertices)
    assert bpy.ops.object.canonical_form_mark(marks="PART", how="ADD", source="SEAMS") == {"FINISHED"}
    assert group_of(obj, "Part Here") == set(np.flatnonzero(along == 0).tolist())


@pytest.mark.parametrize("way", ["faces", "edges"])
def test_a_marked_ring_unrolls_and_a_new_object_is_cut_and_capped(blender, way):
    obj, along = add_ring()
    here = np.flatnonzero(np.isin(along, np.unique(along)[:2] if way == "faces" else [0.0]))
    select(obj, here)
    assert bpy.ops.object.canonical_form_mark(marks="PART", how="ADD") == {"FINISHED"}
    before = snapshot(obj)
    assert bpy.ops.object.canonical_form(result="OBJECT") == {"FINISHED"}
    assert snapshot(obj) == before
    made = bpy.context.view_layer.objects["Ring Canonical Form"]
    mesh = made.data
    assert euler(mesh) == 2
    assert not mesh.validate()
    assert all(len(polygon.vertices) in (3, 4) for polygon in mesh.polygons)
    assert len(mesh.vertices) > len(obj.data.vertices)
    form = mesh.shape_keys.key_blocks["Canonical Form"]
    shape = np.array([point.co for point in form.points])
    assert np.ptp(shape, axis=0).max() > 4
    pose = np.array([point.co for point in mesh.shape_keys.reference_key.points])
    assert np.ptp(pose, axis=0).max() < 2.5
    # quads keep their number, material, UV and weights
    numbers = np.array([each.value for each in mesh.attributes["Number"].data])
    quads = [polygon for polygon in mesh.polygons if len(polygon.vertices) == 4]
    there = {numbers[polygon.index]: polygon for polygon in quads}
    assert len(there) == len(obj.data.polygons) - (16 if way == "faces" else 0)
    for number in (40, 400, 1500):
        old, new = obj.data.polygons[number], there[number]
        assert new.material_index == old.material_index
        values = [
            sorted(tuple(each.data.uv_layers["UV"].data[loop].uv) for loop in polygon.loop_indices)
            for each, polygon in ((obj, old), (made, new))
        ]
        assert values[0] == values[1]
    own = [[vertex.groups[0].weight for vertex in each.data.vertices[:1]] for each in (obj, made)]
    assert own[0] == own[1]
    assert all(any(part.group == made.vertex_groups["Mine"].index for part in each.groups) for each in mesh.vertices)
    assert len(group_of(made, "Contacts")) >= len(here)
    assert len(require_record(mesh).report.patch_sizes) == len(require_record(mesh).report.feature_points)


def test_a_shape_key_spans_what_is_marked_as_a_membrane(blender, capfd):
    obj, along = add_ring()
    select(obj, np.flatnonzero(along == 0))
    assert bpy.ops.object.canonical_form_mark(marks="PART", how="ADD") == {"FINISHED"}
    before = snapshot(obj)
    assert bpy.ops.object.canonical_form() == {"FINISHED"}
    assert "handle" not in capfd.readouterr().out
    assert len(obj.data.vertices) == len(along)
    assert group_of(obj, "Contacts") == set(np.flatnonzero(along == 0).tolist())
    assert bpy.ops.object.canonical_form_clear() == {"FINISHED"}
    assert snapshot(obj) == before


def test_marks_of_several_objects_and_of_mirrored_ones_count(blender):
    one, along = add_ring()
    two, _ = add_ring()
    two.location = (0.0, 0.0, 5.0)
    for obj in (one, two):
        select(obj, np.flatnonzero(along == 0))
        bpy.context.view_layer.objects.active = obj
        assert bpy.ops.object.canonical_form_mark(marks="PART", how="ADD") == {"FINISHED"}
        obj.select_set(True)
    assert bpy.ops.object.canonical_form(objects="TOGETHER") == {"FINISHED"}
    for obj in (one, two):
        assert group_of(obj, "Contacts") == set(np.flatnonzero(along == 0).tolist())


def test_marks_and_modifiers_that_resize_are_refused(blender):
    obj, along = add_ring()
    select(obj, np.flatnonzero(along == 0))
    assert bpy.ops.object.canonical_form_mark(marks="PART", how="ADD") == {"FINISHED"}
    obj.modifiers.new("Smaller", "DECIMATE").ratio = 0.5
    with pytest.raises(RuntimeError, match="Part Here"):
        bpy.ops.object.canonical_form(mesh="SHOWN")
    assert bpy.ops.object.canonical_form(quality="draft") == {"FINISHED"}


def test_the_t_pose_of_several_marked_objects_shows_where_on_each(blender, capfd):
    """Each has its own part of the contacts, and it is told."""
    vertices, faces, _ = fused_figure(86.0, 0.015)
    left = (vertices[faces].mean(axis=1)[:, 2] > 1.3)[:, None]
    seam = np.intersect1d(faces[left[:, 0]], faces[~left[:, 0]])
    objects = []
    for name, own in (("Head", faces[left[:, 0]]), ("Body", faces[~left[:, 0]])):
        used, numbers = np.unique(own, return_inverse=True)
        objects.append((add_object(name, vertices[used], numbers.reshape(-1, 3)), used))
    (head, _), (body, used) = objects
    assert len(seam)
    below = vertices[used, 2] < 1.2
    marks = np.flatnonzero(below & (np.abs(np.abs(vertices[used, 0]) - 0.17) < 0.012))
    select(body, marks)
    for obj, _ in objects:
        obj.select_set(True)
    bpy.context.view_layer.objects.active = body
    assert bpy.ops.object.canonical_form_mark(marks="PART", how="ADD") == {"FINISHED"}
    assert bpy.ops.object.canonical_form_pose_like(pose="T", anyway=True, objects="TOGETHER", contacts="keep") == {
        "FINISHED"
    }
    assert "shows where skin was parted" in capfd.readouterr().out
    assert "Contacts" in body.vertex_groups
    assert group_of(body, "Contacts") <= set(marks.tolist())
    assert "Contacts" not in head.vertex_groups
