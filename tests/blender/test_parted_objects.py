"""New objects that are cut and capped: the mesh that the core has parted, with all that the object carried."""

import bpy
import numpy as np
import pytest

from addon.blender.records.record import require_record
from addon.blender.words.advice import CUT
from tests.blender.conftest import add_object, snapshot
from tests.blender.test_contacts import add_ring, euler, group_of, select
from tests.meshes.animals import walker
from tests.meshes.fused import fused_figure
from tests.meshes.rings import ring


def part_here(obj, vertices):
    select(obj, vertices)
    assert bpy.ops.object.canonical_form_mark(marks="PART", how="ADD") == {"FINISHED"}


def lengths(mesh, points=None):
    """Lengths of the edges, on the vertices or on other points."""
    ends = np.array([edge.vertices[:] for edge in mesh.edges])
    points = np.array([vertex.co for vertex in mesh.vertices]) if points is None else points
    return np.linalg.norm(points[ends[:, 0]] - points[ends[:, 1]], axis=1)


def shape(mesh, name):
    return np.array([point.co for point in mesh.shape_keys.key_blocks[name].points])


def faces_at(mesh):
    """How many faces each edge has."""
    count = np.zeros(len(mesh.edges), dtype=int)
    for polygon in mesh.polygons:
        for loop in polygon.loop_indices:
            count[mesh.loops[loop].edge_index] += 1
    return count


@pytest.mark.parametrize("pose", [None, "T"])
def test_a_scan_is_cut_where_it_has_grown_together(blender, pose):
    vertices, faces, _ = fused_figure(86.0, 0.015)
    obj = add_object("Scan", vertices, faces)
    before = snapshot(obj)
    if pose is None:
        assert bpy.ops.object.canonical_form(result="OBJECT", quality="draft") == {"FINISHED"}
    else:
        assert bpy.ops.object.canonical_form_pose_like(pose=pose, result="OBJECT") == {"FINISHED"}
    assert snapshot(obj) == before
    (made,) = (each for each in bpy.data.objects if each != obj)
    mesh, key = made.data, "Canonical Form" if pose is None else "T-Pose"
    assert (faces_at(mesh) >= 2).all()  # closed
    assert not mesh.validate()
    longest = lengths(obj.data).max()
    assert lengths(mesh).max() < 1.5 * longest
    assert np.quantile(lengths(mesh, shape(mesh, key)), 0.999) < 2.5 * longest
    assert "Contacts" in made.vertex_groups
    report = require_record(mesh).report
    assert len(report.patch_sizes) == len(report.feature_points)
    assert CUT not in report.mends.values()


def test_an_animal_is_cut_beside_a_reference(blender):
    """Fore and hind leg of one side have grown together; another pose, in which they have not, is the reference."""
    whole, scan = add_object("Whole", *walker(cells=60)), add_object("Scan", *walker(0.46, cells=60))
    bpy.context.view_layer.objects.active = whole
    scan.select_set(False)
    assert bpy.ops.object.canonical_form(quality="draft") == {"FINISHED"}
    whole.select_set(False)
    scan.select_set(True)
    bpy.context.view_layer.objects.active = scan
    assert bpy.ops.object.canonical_form(result="OBJECT", quality="draft", reference="Whole") == {"FINISHED"}
    (made,) = (each for each in bpy.data.objects if each not in (whole, scan))
    assert "Contacts" in made.vertex_groups
    assert euler(made.data) == 2
    assert euler(scan.data) == 0
    report = require_record(made.data).report
    assert len(report.feature_points) == len(require_record(whole.data).report.feature_points)
    assert any("grown together" in str(each) for each in report.warnings)


@pytest.mark.parametrize("wide", [1, 3, 6])
def test_wide_bands_are_taken_out_whole(blender, wide):
    obj, along = add_ring()
    part_here(obj, np.flatnonzero(np.isin(along, np.unique(along)[:wide])))
    assert bpy.ops.object.canonical_form(result="OBJECT", quality="draft") == {"FINISHED"}
    mesh = bpy.data.objects["Ring Canonical Form"].data
    assert euler(mesh) == 2
    assert (faces_at(mesh) == 2).all()
    assert lengths(mesh).max() < 2.0 * lengths(obj.data).max()
    assert "Part Here" not in bpy.data.objects["Ring Canonical Form"].vertex_groups


def test_a_triangle_that_is_taken_out_is_its_own_cap(blender):
    points, faces, _ = ring()
    obj = add_object("Ring", points, faces)
    part_here(obj, faces[100])
    assert bpy.ops.object.canonical_form(result="OBJECT", quality="draft") == {"FINISHED"}
    mesh = bpy.data.objects["Ring Canonical Form"].data
    assert len(mesh.polygons) == len(faces)
    assert (faces_at(mesh) == 2).all()


def test_edges_keep_their_seams_and_values_on_both_lips(blender):
    obj, along = add_ring()
    values = obj.data.attributes.new("Value", "FLOAT", "EDGE").data
    values.foreach_set("value", np.ones(len(obj.data.edges), dtype=np.float32))
    for edge in obj.data.edges:
        edge.use_seam = edge.use_edge_sharp = True
    part_here(obj, np.flatnonzero(along == 0))
    assert bpy.ops.object.canonical_form(result="OBJECT", quality="draft") == {"FINISHED"}
    mesh = bpy.data.objects["Ring Canonical Form"].data
    quads = {
        mesh.loops[loop].edge_index for each in mesh.polygons if len(each.vertices) == 4 for loop in each.loop_indices
    }
    assert all(mesh.edges[edge].use_seam and mesh.edges[edge].use_edge_sharp for edge in quads)
    assert all(mesh.attributes["Value"].data[edge].value == 1 for edge in quads)


def test_custom_normals_stay_as_they_are(blender):
    obj, along = add_ring()
    obj.data.normals_split_custom_set([(0.0, 0.0, 1.0)] * len(obj.data.loops))
    part_here(obj, np.flatnonzero(along == 0))
    assert bpy.ops.object.canonical_form(result="OBJECT", quality="draft") == {"FINISHED"}
    mesh = bpy.data.objects["Ring Canonical Form"].data
    assert mesh.has_custom_normals
    assert not any(name.startswith("canonical_form_normals") for name in mesh.attributes.keys())  # noqa: SIM118
    quads = [loop for each in mesh.polygons if len(each.vertices) == 4 for loop in each.loop_indices]
    assert min(mesh.corner_normals[loop].vector.z for loop in quads) > 0.999


def test_copies_at_a_seam_leave_no_loose_vertices(blender):
    points, faces, along = ring()
    here = np.flatnonzero(along == along[32])
    copy = np.arange(len(points))
    copy[here] = len(points) + np.arange(len(here))
    after = (along[faces].mean(axis=1) > along[32]) & (along[faces].mean(axis=1) < 3)
    obj = add_object("Ring", np.concatenate([points, points[here]]), np.where(after[:, None], copy[faces], faces))
    part_here(obj, here)
    assert bpy.ops.object.canonical_form(result="OBJECT", quality="draft") == {"FINISHED"}
    mesh = bpy.data.objects["Ring Canonical Form"].data
    used = {vertex for polygon in mesh.polygons for vertex in polygon.vertices}
    assert len(used) == len(mesh.vertices)


def test_of_several_objects_none_is_cut_and_it_is_told(blender, capfd):
    one, along = add_ring()
    two, _ = add_ring()
    two.location = (0.0, 0.0, 5.0)
    for obj in (one, two):
        bpy.context.view_layer.objects.active = obj
        obj.select_set(True)
        part_here(obj, np.flatnonzero(along == 0))
    assert bpy.ops.object.canonical_form(objects="TOGETHER", result="OBJECT", quality="draft") == {"FINISHED"}
    assert "only a single object" in capfd.readouterr().out
    assert all(euler(each.data) == 0 for each in bpy.data.objects)


def test_a_piece_that_is_marked_all_over_stays_and_it_is_told(blender, capfd):
    obj, along = add_ring()
    part_here(obj, np.arange(len(along)))
    assert bpy.ops.object.canonical_form(quality="draft") == {"FINISHED"}
    assert "A piece is marked as a whole" in capfd.readouterr().out
    assert np.ptp(shape(obj.data, "Canonical Form"), axis=0).max() > 1
    assert "Contacts" not in obj.vertex_groups


def test_the_group_of_marks_is_read_in_edit_mode(blender):
    obj, along = add_ring()
    part_here(obj, np.flatnonzero(along == 0))
    bpy.ops.object.mode_set(mode="EDIT")
    assert bpy.ops.object.canonical_form(quality="draft") == {"FINISHED"}
    assert obj.mode == "EDIT"
    bpy.ops.object.mode_set(mode="OBJECT")
    assert group_of(obj, "Contacts") == set(np.flatnonzero(along == 0).tolist())
