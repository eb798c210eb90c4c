"""Keys of keys, masks of keys, and values that are not numbers, on their way to another mesh."""

import bpy
import numpy as np
import pytest

from addon.blender.transfer.transfer_reading import read_source
from tests.blender.conftest import add_object, snapshot
from tests.blender.test_limbs import keys_of, points_of
from tests.blender.test_transfer import TRANSFER
from tests.meshes import shapes

pytestmark = pytest.mark.usefixtures("computed_once")


@pytest.fixture
def keyed(blender):
    """A mesh with a group, a UV map, colours and a key, and a bare one of the same shape, which is active."""
    vertices, faces = shapes.figure(13)
    base = add_object("Base", vertices, faces)
    base.vertex_groups.new(name="Left").add(np.flatnonzero(vertices[:, 0] < 0).tolist(), 1.0, "REPLACE")
    base.data.uv_layers.new(name="Map")
    base.data.color_attributes.new(name="Paint", type="FLOAT_COLOR", domain="POINT")
    base.shape_key_add(name="Basis")
    key = base.shape_key_add(name="Grow")
    key.data.foreach_set("co", (1.2 * vertices).astype(np.float32).ravel())
    others, other_faces, _ = shapes.permuted(vertices, faces)
    scan = add_object("Scan", others, other_faces)
    base.select_set(False)
    bpy.context.view_layer.update()
    return scan, base, vertices


def test_masks_of_keys_and_keys_of_keys_come_along(keyed):
    scan, base, vertices = keyed
    keys = keys_of(base)
    keys["Grow"].vertex_group = "Left"
    more = base.shape_key_add(name="More", from_mix=False)
    more.data.foreach_set("co", (1.2 * vertices + [0, 0, 0.3]).astype(np.float32).ravel())
    more.relative_key = keys["Grow"]
    assert bpy.ops.object.canonical_form_transfer(**TRANSFER, kinds={"KEYS"}) == {"FINISHED"}
    got = keys_of(scan)
    assert scan.vertex_groups.keys() == ["Left"]
    assert (got["Grow"].vertex_group, got["More"].vertex_group) == ("Left", "")
    assert (got["Grow"].relative_key.name, got["More"].relative_key.name) == ("Basis", "Grow")
    way = points_of(got["More"]) - points_of(got["Grow"])
    assert np.linalg.norm(way - [0, 0, 0.3], axis=1).mean() < 0.02
    once = snapshot(scan)
    bpy.ops.object.canonical_form_transfer(**TRANSFER, kinds={"KEYS"})
    assert snapshot(scan) == once


@pytest.mark.parametrize("kind", ["KEYS", "UVS", "COLOURS"])
def test_values_that_are_not_numbers_are_left_out_and_told(kind, keyed, capfd):
    scan, base, _ = keyed
    keys_of(base)["Grow"].data[3].co.x = float("nan")
    base.data.uv_layers["Map"].uv[3].vector.x = float("nan")
    base.data.color_attributes["Paint"].data[3].color[0] = float("nan")
    assert bpy.ops.object.canonical_form_transfer(**TRANSFER, kinds={kind}) == {"FINISHED"}
    assert "not numbers" in capfd.readouterr().out
    here = read_source(scan)
    assert here.damaged == []
    assert (here.keys, [*here.uvs], [each.name for each in here.colours if each.name == "Paint"]) == ([], [], [])
