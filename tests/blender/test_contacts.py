"""Skin that has grown together, in Blender: parted for the form, shown by a group, gone after Clear."""

import bpy
import numpy as np
import pytest

from addon.blender.records.record import require_record
from tests.blender.conftest import add_object, snapshot
from tests.meshes.fused import fused_figure


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
    assert bpy.ops.object.canonical_form_limb(patch=0, only=True) == {"FINISHED"}
    assert bpy.ops.object.canonical_form_clear() == {"FINISHED"}
    assert snapshot(obj) == before


def test_a_run_without_takes_the_group_away(blender, figure):
    vertices, faces, _ = figure
    obj = add_object("Scan", vertices, faces)
    assert bpy.ops.object.canonical_form(contacts="open", quality="draft", max_iterations=2) == {"FINISHED"}
    assert bpy.ops.object.canonical_form(quality="draft", max_iterations=2) == {"FINISHED"}
    assert "Contacts" not in obj.vertex_groups
