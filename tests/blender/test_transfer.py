"""What a mesh takes over from another: weights and rig, UV maps, colours, shape keys, materials."""

from typing import Any

import bmesh
import bpy
import numpy as np
import pytest

from addon.blender.records.transfer_record import TRANSFERS_PROPERTY, read_transfers
from addon.blender.transfer.transfer_reading import read_source
from addon.core import CanonicalFormError
from addon.interface import panels
from addon.interface.rig_panel import VIEW3D_PT_canonical_form_rig
from tests.blender.conftest import QUICK, add_object, drawn, snapshot
from tests.blender.test_limbs import keys_of, points_of
from tests.meshes import shapes

ALL = {"GROUPS", "UVS", "COLOURS", "KEYS", "MATERIALS"}
pytestmark = pytest.mark.usefixtures("computed_once")
TRANSFER: dict[str, Any] = {**QUICK, "like": "Base"}


@pytest.fixture(scope="module")
def small():
    """A figure with few vertices."""
    return shapes.figure(13)


@pytest.fixture
def pair(blender, small):
    """A mesh that has everything, and a bare one of the same shape under other numbers, moved; that is active."""
    vertices, faces = small
    base = add_object("Base", vertices, faces)
    mesh = base.data
    right = vertices[:, 0] > 0
    for name, members in (("Left", ~right), ("Right", right)):
        base.vertex_groups.new(name=name).add(np.flatnonzero(members).tolist(), 0.75, "REPLACE")
    layer = mesh.uv_layers.new(name="Map")
    layer.uv.foreach_set("vector", vertices[faces.ravel()][:, :2].astype(np.float32).ravel())
    for name, domain, kind, source in (
        ("Paint", "POINT", "FLOAT_COLOR", vertices),
        ("Bake", "CORNER", "BYTE_COLOR", vertices[faces.ravel()]),
    ):
        attribute = mesh.color_attributes.new(name=name, type=kind, domain=domain)
        values = np.column_stack([0.3 + 0.1 * source, np.ones(len(source))])
        attribute.data.foreach_set("color", values.astype(np.float32).ravel())
    base.shape_key_add(name="Basis")
    key = base.shape_key_add(name="Grow")
    key.data.foreach_set("co", (1.2 * vertices).astype(np.float32).ravel())
    key.slider_max = 2.0
    for name in ("Skin", "Cloth"):
        mesh.materials.append(bpy.data.materials.new(name))
    slots = (vertices[faces].mean(axis=1)[:, 0] > 0).astype(np.int32)
    mesh.polygons.foreach_set("material_index", slots)
    others, other_faces, old = shapes.permuted(vertices, faces)
    scan = add_object("Scan", others, other_faces)
    scan.location = (5.0, 0.0, 0.0)
    base.select_set(False)
    bpy.context.view_layer.update()
    return scan, base, old


@pytest.fixture
def rig(pair):
    """An armature with a bone for either half, that moves the base."""
    data = bpy.data.armatures.new("Rig")
    armature = bpy.data.objects.new("Rig", data)
    bpy.context.scene.collection.objects.link(armature)
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    for name, tail in (("Left", (-1, 0, 0)), ("Right", (1, 0, 0))):
        bone = data.edit_bones.new(name)
        bone.head, bone.tail = (0, 0, 0), tail
    bpy.ops.object.mode_set(mode="OBJECT")
    pair[1].modifiers.new("Armature", "ARMATURE").object = armature
    bpy.context.view_layer.objects.active = pair[0]
    return armature


def test_everything_is_taken_over_to_the_likes(pair, small):
    scan, base, old = pair
    assert bpy.ops.object.canonical_form_transfer(**TRANSFER, kinds=ALL) == {"FINISHED"}
    here, there = read_source(scan), read_source(base)
    vertices = small[0][old]
    inner = np.abs(vertices[:, 0]) > 0.4
    for name, members in (("Left", vertices[:, 0] < 0), ("Right", vertices[:, 0] > 0)):
        np.testing.assert_allclose(here.groups[name][inner], 0.75 * members[inner], atol=0.01)
    places = vertices[here.vertex_of][:, :2]
    assert np.linalg.norm(here.uvs["Map"] - places, axis=1).mean() < 0.02
    assert [(each.name, each.on_corners, each.data_type) for each in here.colours] == [
        (each.name, each.on_corners, each.data_type) for each in there.colours
    ]
    assert np.abs(here.colours[0].values[:, :3] - 0.3 - 0.1 * vertices).mean() < 0.01
    assert [key.name for key in keys_of(scan)] == ["Basis", "Grow"]
    grown = points_of(keys_of(scan)["Grow"])
    assert np.linalg.norm(grown - 1.2 * vertices, axis=1).mean() < 0.03
    assert keys_of(scan)["Grow"].slider_max == 2.0
    assert keys_of(scan)["Grow"].value == 0.0
    assert [slot.material.name for slot in scan.material_slots] == ["Skin", "Cloth"]
    slots = np.empty(len(scan.data.polygons), dtype=np.int32)
    scan.data.polygons.foreach_get("material_index", slots)
    corners = vertices[here.vertex_of.reshape(-1, 3)][:, :, 0]
    clear = np.abs(corners).min(axis=1) > 0.4
    assert np.array_equal(slots[clear] == 1, (corners.mean(axis=1) > 0)[clear])


def test_the_reference_is_left_as_it_was(pair):
    before = snapshot(pair[1])
    bpy.ops.object.canonical_form_transfer(**TRANSFER, kinds=ALL)
    assert snapshot(pair[1]) == before


def test_another_run_replaces_what_nobody_changed(pair):
    scan, _, _ = pair
    bpy.ops.object.canonical_form_transfer(**TRANSFER, kinds=ALL)
    once = snapshot(scan)
    bpy.ops.object.canonical_form_transfer(**TRANSFER, kinds=ALL)
    assert snapshot(scan) == once
    assert {kind: sorted(names) for kind, names in read_transfers(scan.data).items()} == {
        "groups": ["Left", "Right"], "uvs": ["Map"], "colours": ["Bake", "Paint"], "keys": ["Grow"], "rigs": [],
    }  # fmt: skip


def test_what_the_user_has_under_the_same_name_is_kept(pair, capfd):
    scan, _, _ = pair
    scan.vertex_groups.new(name="Left").add([0, 1], 0.5, "REPLACE")
    scan.data.uv_layers.new(name="Map")
    scan.shape_key_add(name="Basis")
    scan.shape_key_add(name="Grow")
    before = points_of(keys_of(scan)["Grow"]).copy()
    bpy.ops.object.canonical_form_transfer(**TRANSFER, kinds={"GROUPS", "UVS", "KEYS"})
    said = capfd.readouterr().out
    assert "vertex groups of its own called Left" in said
    assert "UV maps of its own called Map" in said
    assert scan.vertex_groups["Left"].weight(0) == 0.5
    assert [group.name for group in scan.vertex_groups] == ["Left", "Right"]
    np.testing.assert_array_equal(points_of(keys_of(scan)["Grow"]), before)
    assert [key.name for key in keys_of(scan)] == ["Basis", "Grow"]


def test_with_the_weights_comes_the_rig(pair, rig, small):
    scan, _, old = pair
    bpy.ops.object.canonical_form_transfer(**TRANSFER, kinds={"GROUPS"})
    assert [key.name for key in keys_of(scan)] == ["Basis", "Rest of Base"]
    assert keys_of(scan)["Rest of Base"].value == 1.0
    assert [(each.type, each.object) for each in scan.modifiers] == [("ARMATURE", rig)]
    placed = points_of(keys_of(scan)["Rest of Base"]) + np.array(scan.location)
    assert np.linalg.norm(placed - small[0][old], axis=1).mean() < 0.2  # on the rig
    bpy.ops.object.canonical_form_transfer(**TRANSFER, kinds={"GROUPS"})
    assert len(scan.modifiers) == 1
    assert len(keys_of(scan)) == 2


def test_another_run_keeps_what_depends_on_keys_and_uv_maps(pair):
    scan, base, _ = pair
    scan.data.uv_layers.new(name="Own")
    bpy.ops.object.canonical_form_transfer(**TRANSFER, kinds={"KEYS", "UVS"})
    grow, map_of_base = keys_of(scan)["Grow"], scan.data.uv_layers["Map"]
    grow.driver_add("value").driver.expression = "0.5"
    grow.vertex_group = scan.vertex_groups.new(name="Mouth").name
    grow.slider_max = 5.0
    scan.data.uv_layers.active, map_of_base.active_render = map_of_base, True
    base.data.shape_keys.key_blocks["Grow"].data.foreach_set("co", np.zeros(3 * len(base.data.vertices)))
    bpy.ops.object.canonical_form_transfer(**TRANSFER, kinds={"KEYS", "UVS"})
    grow = keys_of(scan)["Grow"]
    assert np.ptp(points_of(grow), axis=0).max() < 0.1  # as the source is now
    assert [curve.data_path for curve in scan.data.shape_keys.animation_data.drivers] == ['key_blocks["Grow"].value']
    assert (grow.vertex_group, grow.slider_max) == ("Mouth", 5.0)
    assert [layer.name for layer in scan.data.uv_layers if layer.active_render] == ["Map"]
    assert scan.data.uv_layers.active.name == "Map"


@pytest.mark.parametrize("name", ["Body", "mixamorig_character_high_resolution_body_v02_final_LOD0_copy"])
def test_one_rest_pose_at_a_time(pair, rig, small, name):
    scan, base, old = pair
    for _ in range(2):
        bpy.ops.object.canonical_form_transfer(**TRANSFER, kinds={"GROUPS"})
        base.name = name  # as if there were another reference
        bpy.ops.object.canonical_form_transfer(**{**TRANSFER, "like": name}, kinds={"GROUPS"})
        base.name = "Base"
    rests = [key for key in keys_of(scan) if key.name.startswith("Rest of ")]
    assert [(key.name, key.value) for key in rests] == [(f"Rest of {name}".encode()[:63].decode(), 1.0)]
    placed = points_of(rests[0]) + np.array(scan.location)
    assert np.linalg.norm(placed - small[0][old], axis=1).mean() < 0.2  # on the rig


def test_a_rest_pose_that_was_changed_stays_without_bending_the_next(pair, rig):
    scan, base, _ = pair
    bpy.ops.object.canonical_form_transfer(**TRANSFER, kinds={"GROUPS"})
    keys_of(scan)["Rest of Base"].data[0].co.x += 1.0
    base.name = "Body"
    bpy.ops.object.canonical_form_transfer(**{**TRANSFER, "like": "Body"}, kinds={"GROUPS"})
    assert {key.name: key.value for key in keys_of(scan)[1:]} == {"Rest of Base": 0.0, "Rest of Body": 1.0}


def test_another_rig_takes_the_place_of_the_first(pair, rig):
    scan, base, _ = pair
    mine = scan.modifiers.new("Mine", "SMOOTH")
    bpy.ops.object.canonical_form_transfer(**TRANSFER, kinds={"GROUPS"})
    other = bpy.data.objects.new("Other rig", rig.data.copy())
    bpy.context.scene.collection.objects.link(other)
    base.modifiers["Armature"].object = other
    bpy.ops.object.canonical_form_transfer(**TRANSFER, kinds={"GROUPS"})
    assert [each.object for each in scan.modifiers if each.type == "ARMATURE"] == [other]
    assert mine.name in scan.modifiers


def test_a_renamed_rig_is_still_the_first(pair, rig):
    scan, base, _ = pair
    bpy.ops.object.canonical_form_transfer(**TRANSFER, kinds={"GROUPS"})
    rig.name = "Renamed"
    other = bpy.data.objects.new("Other rig", rig.data.copy())
    bpy.context.scene.collection.objects.link(other)
    for wanted in (other, rig):
        base.modifiers["Armature"].object = wanted
        bpy.ops.object.canonical_form_transfer(**TRANSFER, kinds={"GROUPS"})
        assert [each.object for each in scan.modifiers] == [wanted]


def test_a_key_that_the_source_has_is_no_rest_pose_of_ours(pair, rig):
    scan, base, _ = pair
    base.data.shape_keys.key_blocks["Grow"].name = "Rest of Old"
    bpy.ops.object.canonical_form_transfer(**TRANSFER, kinds={"KEYS"})
    bpy.ops.object.canonical_form_transfer(**TRANSFER, kinds={"GROUPS"})
    assert {"Rest of Old", "Rest of Base"} <= set(keys_of(scan).keys())


def test_faces_without_a_material_in_the_source_keep_theirs(pair):
    scan, base, _ = pair
    for name in "abc":
        scan.data.materials.append(bpy.data.materials.new(name))
    own = np.arange(len(scan.data.polygons)) % 3
    scan.data.polygons.foreach_set("material_index", own.astype(np.int32))
    base.data.materials[1] = None
    bpy.ops.object.canonical_form_transfer(**TRANSFER, kinds={"MATERIALS"})
    now = np.empty(len(own), dtype=np.int32)
    scan.data.polygons.foreach_get("material_index", now)
    skin = now == 3
    assert 0.2 < skin.mean() < 0.8
    np.testing.assert_array_equal(now[~skin], own[~skin])
    base.data.materials.clear()
    scan.data.polygons.foreach_set("material_index", own.astype(np.int32))
    bpy.ops.object.canonical_form_transfer(**TRANSFER, kinds={"MATERIALS"})
    scan.data.polygons.foreach_get("material_index", now)
    np.testing.assert_array_equal(now, own)


def test_a_body_that_the_rig_does_not_fit_is_told(pair, rig, capfd):
    scan, _, _ = pair
    scan.scale = (3.0, 3.0, 3.0)
    bpy.context.view_layer.update()
    bpy.ops.object.canonical_form_transfer(**TRANSFER, kinds={"GROUPS"})
    assert "Scan is 3 times as large as Base" in capfd.readouterr().out


def test_the_side_is_that_of_the_pose(pair):
    scan, _, _ = pair
    bpy.ops.object.canonical_form_pose_like(**QUICK, pose="OBJECT", like="Base", side=1)
    bpy.ops.object.canonical_form_transfer(**TRANSFER, kinds={"GROUPS"})
    with_side = read_source(scan).groups["Left"]
    bpy.ops.object.canonical_form_transfer(**TRANSFER, kinds={"GROUPS"}, side=0)
    assert np.abs(with_side - read_source(scan).groups["Left"]).mean() > 0.05


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ({"like": ""}, "Choose an object"),
        ({"like": "Nobody"}, "There is no object Nobody"),
        ({"like": "Scan"}, "the reference itself"),
        ({"kinds": set()}, "Nothing is chosen"),
    ],
)
def test_what_makes_no_sense_is_told(pair, words, sentence):
    scan, _, _ = pair
    before = snapshot(scan)
    with pytest.raises(RuntimeError, match=sentence):
        bpy.ops.object.canonical_form_transfer(**{**TRANSFER, "kinds": {"GROUPS"}, **words})
    assert snapshot(scan) == before


@pytest.mark.parametrize("flat", ["Scan", "Base"])
def test_an_object_without_thickness_is_refused_by_name(pair, flat):
    scan, _, _ = pair
    bpy.data.objects[flat].scale = (1.0, 0.0, 1.0)
    bpy.context.view_layer.update()
    before = snapshot(scan)
    with pytest.raises(RuntimeError, match=rf"{flat} has a scale of 0 along an axis. Change its scale\.$"):
        bpy.ops.object.canonical_form_transfer(**TRANSFER, kinds={"KEYS"})
    assert snapshot(scan) == before


def test_colours_that_a_reference_shows_of_a_match_are_not_taken_over(pair):
    scan, base, _ = pair
    bpy.ops.object.canonical_form_match_colours(like="Base")
    assert "Match Source" in base.data.color_attributes
    bpy.ops.object.canonical_form_transfer(**TRANSFER, kinds={"COLOURS"})
    assert {each.name for each in scan.data.color_attributes} == {"Bake", "Paint"}
    del base.data["canonical_form_match_source"]  # so that they are the user's own
    bpy.ops.object.canonical_form_transfer(**TRANSFER, kinds={"COLOURS"})
    assert {each.name for each in scan.data.color_attributes} == {"Bake", "Paint", "Match Source"}


def test_a_property_of_that_name_of_the_users_own_is_none_of_ours(pair):
    scan, _, _ = pair
    scan.data[TRANSFERS_PROPERTY] = "[1, 2"
    assert not any(read_transfers(scan.data).values())


def test_the_panel_offers_what_can_be_taken_over(pair):
    bpy.context.object.canonical_form.like = bpy.data.objects["Base"]
    shown = drawn(VIEW3D_PT_canonical_form_rig)
    flags = [f"transfer_{kind}" for kind in ("groups", "uvs", "colours", "keys", "materials")]
    assert shown[-7:] == ["From", *flags, "object.canonical_form_transfer"]
    assert VIEW3D_PT_canonical_form_rig in panels.CLASSES


def test_an_object_that_its_transform_mirrors_takes_over_too(pair, small):
    scan, _, old = pair
    points = np.array([vertex.co for vertex in scan.data.vertices]) * [-1, 1, 1]
    scan.data.vertices.foreach_set("co", points.astype(np.float32).ravel())
    scan.data.flip_normals()
    scan.scale = (-1.0, 1.0, 1.0)
    bpy.context.view_layer.update()
    bpy.ops.object.canonical_form_transfer(**TRANSFER, kinds={"KEYS"})
    grown = points_of(keys_of(scan)["Grow"])
    assert np.linalg.norm(grown - 1.2 * small[0][old] * [-1, 1, 1], axis=1).mean() < 0.03


def test_all_selected_objects_take_over_those_that_touch_as_one_body(pair, small, capfd):
    """A button on the hand, with a scale of its own, and another scan far away, beside the scan and the base."""
    scan, base, old = pair
    vertices = small[0]
    hand = vertices[np.argmax(vertices[:, 0])]
    balls, ball_faces = shapes.sphere(2)
    button = add_object("Button", balls, ball_faces)
    button.scale = (0.05, 0.05, 0.05)
    button.location = np.array(scan.location) + hand
    other = add_object("Other", np.array([vertex.co for vertex in scan.data.vertices]), read_faces(scan))
    other.location = (-9.0, 3.0, 0.0)
    for obj in (base, button, other):
        obj.select_set(True)
    bpy.context.view_layer.objects.active = scan
    bpy.context.view_layer.update()
    untouched = snapshot(base)
    assert bpy.ops.object.canonical_form_transfer(**TRANSFER, kinds={"GROUPS", "KEYS"}) == {"FINISHED"}
    assert "vertex groups: 2, shape keys: 1" in capfd.readouterr().out
    assert snapshot(base) == untouched
    placed = vertices[old]
    inner = np.abs(placed[:, 0]) > 0.4
    for each in (scan, other):
        np.testing.assert_allclose(read_source(each).groups["Left"][inner], 0.75 * (placed[inner, 0] < 0), atol=0.01)
    assert np.linalg.norm(points_of(keys_of(other)["Grow"]) - 1.2 * placed, axis=1).mean() < 0.03
    weights = read_source(button).groups
    np.testing.assert_allclose(weights["Right"], 0.75, atol=0.01)
    np.testing.assert_allclose(weights["Left"], 0.0, atol=0.01)
    grown = 0.05 * points_of(keys_of(button)["Grow"]) + np.array(button.location) - np.array(scan.location)
    assert np.linalg.norm(grown.mean(axis=0) - 1.2 * hand) < 0.1  # it goes with the hand


@pytest.mark.parametrize("mode", ["OBJECT", "EDIT"])
def test_nothing_is_written_where_one_of_several_objects_was_changed(pair, mode):
    from addon.blender.transfer.transfer_task import TransferTask
    from addon.core import Settings

    scan, base, _ = pair
    other = add_object("Other", np.array([vertex.co for vertex in scan.data.vertices]), read_faces(scan))
    settings = Settings(**{name: value for name, value in QUICK.items() if name in Settings.__dataclass_fields__})
    task = TransferTask([scan, other], base, {"GROUPS"}, settings, -1)
    task.compute()
    if mode == "OBJECT":
        other.data.vertices[0].co.x += 1
    else:  # the mesh knows of it once the mode is left
        bpy.context.view_layer.objects.active = other
        bpy.ops.object.mode_set(mode="EDIT")
        next(iter(bmesh.from_edit_mesh(other.data).verts)).co.x += 1
    before = snapshot(scan)
    with pytest.raises(CanonicalFormError, match="Other"):
        task.write()
    assert snapshot(scan) == before
    assert not other.vertex_groups


def read_faces(obj):
    """The triangles of an object."""
    return np.array([list(polygon.vertices) for polygon in obj.data.polygons])
