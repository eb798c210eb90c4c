"""Files that version 0.1 wrote in Blender 4.2: its results are read, worked on and cleared.

files/first-of-0.1.blend is of the first commit that had a panel. It did not note what it wrote: nothing tells whether
the user has changed it, and it stays. files/last-of-0.1.blend is of the last before the record became a type, with a
limb in its pose and two in-betweens. Both hold the small figure and a vertex group of the user's.
"""

import shutil
from pathlib import Path

import bpy
import numpy as np
import pytest

from addon.blender.mesh_items.fingerprints import key_fingerprint
from addon.blender.records.record import require_record
from tests.blender.conftest import QUICK
from tests.meshes import shapes

FILES = Path(__file__).with_name("files")


def opened(which, folder):
    """The object of an old file, opened from a copy."""
    path = shutil.copy(FILES / f"{which}-of-0.1.blend", folder / "old.blend")
    bpy.ops.wm.open_mainfile(filepath=str(path))
    obj = bpy.data.objects["Figure"]
    bpy.context.view_layer.objects.active = obj
    return obj


@pytest.fixture(params=["first", "last"])
def old(request, blender, tmp_path):
    """The object of each old file."""
    return opened(request.param, tmp_path)


@pytest.fixture
def first(blender, tmp_path):
    """The object of the oldest file, with a form that its artist has sculpted further."""
    obj = opened("first", tmp_path)
    obj.data.shape_keys.key_blocks["Canonical Form"].data[0].co.x += 5
    obj.vertex_groups["Patch 1"].add(range(len(obj.data.vertices)), 0.125, "REPLACE")
    return obj


@pytest.fixture
def last(blender, tmp_path):
    """The object of the newer file."""
    return opened("last", tmp_path)


def users_own(obj):
    """What is left when everything of ours is gone."""
    mesh = obj.data
    own = {name for name in mesh.attributes.keys() if not name.startswith(".")} - {"position"}  # noqa: SIM118
    return obj.vertex_groups.keys(), mesh.shape_keys, list(mesh.color_attributes), own, list(mesh.keys())


def test_an_old_result_is_read(old):
    record = require_record(old.data)
    assert record.has_form
    assert len(record.groups) == 6
    assert len(record.report.feature_points) == 5
    assert record.report.seconds > 0
    assert record.straightened in ([], [True, False, True, True, True])


def test_an_old_result_is_cleared_wholly(last):
    before = np.array([vertex.co for vertex in last.data.vertices])
    assert bpy.ops.object.canonical_form_clear() == {"FINISHED"}
    groups, keys, colours, attributes, properties = users_own(last)
    assert (groups, keys, colours) == (["Mine"], None, [])
    assert not any("Canonical" in name or "canonical" in name for name in attributes)
    assert properties == []
    after = np.array([vertex.co for vertex in last.data.vertices])
    assert np.array_equal(before, after)
    assert np.allclose(after, shapes.figure(11)[0], atol=1e-6)


def test_limbs_and_in_betweens_of_an_old_result(old):
    if not require_record(old.data).hidden:  # the first build did not keep the whole form
        for operator in (bpy.ops.object.canonical_form_limb, bpy.ops.object.canonical_form_in_betweens):
            with pytest.raises(RuntimeError, match="Compute"):
                operator()
        return
    assert bpy.ops.object.canonical_form_limb(patch=1, only=True) == {"FINISHED"}
    assert bpy.ops.object.canonical_form_in_betweens(count=3) == {"FINISHED"}
    assert len(require_record(old.data).in_between_keys) == 3
    assert bpy.ops.object.canonical_form_clear() == {"FINISHED"}
    assert users_own(old)[:2] == (["Mine"], None)


def test_a_new_run_replaces_an_old_result(last):
    assert bpy.ops.object.canonical_form(**QUICK) == {"FINISHED"}
    names = [key.name for key in last.data.shape_keys.key_blocks]
    assert [name for name in names if "%" not in name] == ["Basis", "Canonical Form"]
    assert last.vertex_groups.keys().count("Feature Points") == 1
    assert bpy.ops.object.canonical_form_clear() == {"FINISHED"}
    assert users_own(last)[:3] == (["Mine"], None, [])


def test_what_no_fingerprint_confirms_stays(first):
    before = users_own(first)[0], [key_fingerprint(key) for key in first.data.shape_keys.key_blocks]
    assert bpy.ops.object.canonical_form(**QUICK) == {"FINISHED"}
    warnings = require_record(first.data).report.warnings
    assert any("Canonical Form, Feature Points, Patch 1" in warning for warning in warnings)
    assert "Canonical Form.001" in first.data.shape_keys.key_blocks
    assert bpy.ops.object.canonical_form_clear() == {"FINISHED"}
    assert (users_own(first)[0], [key_fingerprint(key) for key in first.data.shape_keys.key_blocks]) == before
    assert users_own(first)[4] == []
