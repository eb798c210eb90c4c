"""Seams of the base mesh under modifiers that add vertices."""

import bpy
import numpy as np
import pytest

from addon.blender.objects.mesh_reading import read_evaluated, read_object
from addon.blender.records.record import require_record
from addon.core.assembly.pieces import connected_pieces
from addon.core.mesh.edges import edge_table
from tests.meshes import shapes

from .conftest import QUICK, add_object, snapshot


@pytest.fixture
def seamed(blender):
    """A figure cut along seams, as a .glb stores it: quadrants with borders of their own."""
    return add_object("Seamed", *shapes.cut_along_seams(*shapes.figure(13)))


def parts_and_open_edges(vertices, faces):
    pieces = connected_pieces(vertices, faces)
    return len(pieces.pieces), np.count_nonzero(edge_table(pieces.faces).count == 1)


def test_subdivision_does_not_open_seams(seamed):
    seamed.modifiers.new("Finer", "SUBSURF").levels = 2
    before = snapshot(seamed)
    bare = read_evaluated(seamed)
    assert parts_and_open_edges(*bare)[1] > 100  # as Blender draws it
    reading = read_object(seamed, True)
    assert parts_and_open_edges(reading.vertices, reading.faces) == (1, 0)
    moved = np.linalg.norm(reading.vertices - bare[0], axis=1)
    assert 0 < np.count_nonzero(moved) < 0.3 * len(moved)
    assert snapshot(seamed) == before
    bpy.ops.object.canonical_form(mesh="SHOWN", **QUICK)
    record = require_record(bpy.data.objects["Seamed Canonical Form"].data)
    assert len(record.report.feature_points) <= 8
    assert not any("bodies" in each for each in record.report.warnings)


def test_what_a_mirror_copies_is_not_drawn_together(seamed):
    for vertex in seamed.data.vertices:
        vertex.co.x += 20
    seamed.modifiers.new("Mirror", "MIRROR")
    seamed.modifiers.new("Finer", "SUBSURF").levels = 1
    reading = read_object(seamed, True)
    assert parts_and_open_edges(reading.vertices, reading.faces) == (2, 0)
    assert np.abs(reading.vertices[:, 0]).min() > 10


def test_a_mesh_without_seams_is_read_as_it_is(figure_object):
    figure_object.modifiers.new("Finer", "SUBSURF").levels = 1
    assert np.array_equal(read_object(figure_object, True).vertices, read_evaluated(figure_object)[0])
