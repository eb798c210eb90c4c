"""What data are transferred from: an armature stands for its meshes, and what does not fit is refused."""

import bpy
import numpy as np
import pytest

from addon.blender.rigging.rig_reading import read_rig_source
from addon.blender.transfer.donor import read_donor
from addon.blender.transfer.transfer_reading import read_source
from addon.blender.transfer.transfer_task import TransferTask
from addon.core import CanonicalFormError, InvalidMeshError, Settings, match
from addon.core.transfers import require_fit
from tests.blender.conftest import add_object, snapshot
from tests.blender.rig_scenes import RIG, armature_of
from tests.blender.test_limbs import keys_of, points_of
from tests.blender.test_transfer import TRANSFER, pair, rig, small  # noqa: F401 (fixtures)
from tests.meshes import shapes

pytestmark = pytest.mark.usefixtures("computed_once")


@pytest.fixture
def halves(pair, rig, small):  # noqa: F811
    """The base in two objects, left and right, which one armature moves; the scan is active."""
    scan, base, old = pair
    vertices, faces = small
    left = vertices[faces].mean(axis=1)[:, 0] < 0
    parts = []
    for name, own in (("Half L", left), ("Half R", ~left)):
        used, corners = np.unique(faces[own], return_inverse=True)
        part = add_object(name, vertices[used], corners.reshape(-1, 3))
        side = vertices[used, 0] > 0
        for group, members in (("Left", ~side), ("Right", side)):
            part.vertex_groups.new(name=group).add(np.flatnonzero(members).tolist(), 0.75, "REPLACE")
        layer = part.data.uv_layers.new(name="Map" if own is left else "Another")
        layer.uv.foreach_set("vector", vertices[faces[own].ravel()][:, :2].astype(np.float32).ravel())
        part.data.materials.append(bpy.data.materials.new(name))
        part.modifiers.new("Armature", "ARMATURE").object = rig
        part.select_set(False)
        parts.append(part)
    parts[1].shape_key_add(name="Basis")
    part = parts[1].shape_key_add(name="Wide")
    points = points_of(part)
    part.points.foreach_set("co", (points * [1.5, 1, 1]).astype(np.float32).ravel())
    bpy.data.objects.remove(base)
    bpy.context.view_layer.objects.active = scan
    scan.select_set(True)
    bpy.context.view_layer.update()
    return scan, parts, rig, old


def test_an_armature_stands_for_all_its_meshes(halves, small):  # noqa: F811
    scan, parts, rig, old = halves  # noqa: F811
    before = [snapshot(each) for each in parts]
    kinds = {"GROUPS", "UVS", "KEYS", "MATERIALS"}
    assert bpy.ops.object.canonical_form_transfer(**{**TRANSFER, "like": rig.name}, kinds=kinds) == {"FINISHED"}
    here, vertices = read_source(scan), small[0][old]
    inner = np.abs(vertices[:, 0]) > 0.4
    for name, members in (("Left", vertices[:, 0] < 0), ("Right", vertices[:, 0] > 0)):
        np.testing.assert_allclose(here.groups[name][inner], 0.75 * members[inner], atol=0.01)
    places = vertices[here.vertex_of][:, :2]
    (layer,) = here.uvs.values()  # of both, though one is called otherwise
    assert np.linalg.norm(layer - places, axis=1).mean() < 0.03
    slots = np.array([each.name for each in scan.data.materials])
    centres = vertices[np.array([list(face.vertices) for face in scan.data.polygons])].mean(axis=1)
    far = np.abs(centres[:, 0]) > 0.4
    chosen = slots[[face.material_index for face in scan.data.polygons]]
    assert (chosen[far] == np.where(centres[far, 0] < 0, "Half L", "Half R")).all()
    wide = points_of(keys_of(scan)["Wide"]) - points_of(keys_of(scan)["Basis"])
    assert np.abs(wide[vertices[:, 0] < -0.4]).max() < 0.02  # the left half has no such key
    assert np.abs(wide[vertices[:, 0] > 1.0, 0]).mean() > 0.3
    assert [(each.type, each.object) for each in scan.modifiers] == [("ARMATURE", rig)]
    assert [snapshot(each) for each in parts] == before


def test_its_pose_is_that_of_all_of_them(halves, small):  # noqa: F811
    scan, _, rig, _ = halves  # noqa: F811
    assert bpy.ops.object.canonical_form_pose_like(
        **{key: value for key, value in TRANSFER.items() if key != "like"}, pose="OBJECT", like=rig.name
    ) == {"FINISHED"}
    posed = points_of(keys_of(scan)[f"Like {rig.name}"])
    lengths = [np.linalg.norm(np.ptp(each, axis=0)) for each in (posed, small[0])]
    assert lengths[0] == pytest.approx(lengths[1], rel=0.1)


def test_the_parts_of_a_donor_are_one_mesh(halves):
    _, parts, rig, _ = halves  # noqa: F811
    donor = read_donor(rig)
    assert [each.name for each in donor.objects] == sorted(
        (each.name for each in parts), key=lambda name: -len(bpy.data.objects[name].data.vertices)
    )
    assert donor.rig is not None
    np.testing.assert_allclose(donor.rig.weights.sum(axis=1), 0.75, atol=1e-6)
    np.testing.assert_array_equal(donor.data.vertex_of[donor.data.triangle_corners][:, [0, 1, 2]], donor.faces)


def test_what_has_taken_over_is_no_donor_itself(halves, small, capfd):  # noqa: F811
    scan, parts, rig, _ = halves  # noqa: F811
    words = {**TRANSFER, "like": rig.name, "kinds": {"GROUPS"}}
    assert bpy.ops.object.canonical_form_transfer(**words) == {"FINISHED"}
    once = snapshot(scan)
    assert bpy.ops.object.canonical_form_transfer(**words) == {"FINISHED"}
    assert snapshot(scan) == once
    assert {each.name for each in read_donor(rig).objects} == {each.name for each in parts}
    bare = add_object("Bare", *small)
    bare.parent = rig  # a garment, say, that is to follow
    bpy.context.view_layer.update()
    assert bpy.ops.object.canonical_form_transfer(**words) == {"FINISHED"}
    assert {"Left", "Right"} <= {group.name for group in bare.vertex_groups}
    for each in parts:
        each.hide_set(True)
    scan.select_set(True)
    with pytest.raises(RuntimeError, match="moves no other mesh that is shown"):
        bpy.ops.object.canonical_form_transfer(**words)


def test_what_hangs_on_a_bone_follows_it(halves, small):  # noqa: F811
    scan, parts, rig, old = halves  # noqa: F811
    part = parts[0]
    part.modifiers.clear()
    part.vertex_groups.clear()
    place = part.matrix_world.copy()
    part.parent, part.parent_type, part.parent_bone = rig, "BONE", "Left"
    part.matrix_world = place
    rig.pose.bones["Left"].rotation_mode = "XYZ"
    rig.pose.bones["Left"].rotation_euler.x = 0.4
    bpy.context.view_layer.update()
    assert bpy.ops.object.canonical_form_transfer(**{**TRANSFER, "like": rig.name}, kinds={"GROUPS"}) == {"FINISHED"}
    here, vertices = read_source(scan), small[0][old]
    np.testing.assert_allclose(here.groups["Left"][vertices[:, 0] < -0.4], 1.0, atol=0.01)
    np.testing.assert_allclose(here.groups["Right"][vertices[:, 0] > 0.4], 0.75, atol=0.01)
    assert [(each.type, each.object) for each in scan.modifiers] == [("ARMATURE", rig)]


def test_a_part_without_materials_lends_none(halves, small):  # noqa: F811
    scan, parts, rig, old = halves  # noqa: F811
    parts[0].data.materials.clear()
    parts[1].data.polygons.foreach_set("material_index", np.full(len(parts[1].data.polygons), 3, dtype=np.int32))
    bpy.ops.object.canonical_form_transfer(**{**TRANSFER, "like": rig.name}, kinds={"MATERIALS"})
    vertices = small[0][old]
    centres = vertices[np.array([list(face.vertices) for face in scan.data.polygons])].mean(axis=1)[:, 0]
    slots = [slot.material.name if slot.material else "" for slot in scan.material_slots]
    chosen = np.array([slots[face.material_index] for face in scan.data.polygons])
    assert (chosen[centres < -0.4] == "").all()
    assert (chosen[centres > 0.4] == "Half R").all()


def test_a_key_that_one_part_masks_moves_the_other_whole(halves, small):  # noqa: F811
    scan, parts, rig, old = halves  # noqa: F811
    left, right = parts
    left.shape_key_add(name="Basis")
    key = left.shape_key_add(name="Wide")
    key.points.foreach_set("co", (points_of(key) * [1.5, 1, 1]).astype(np.float32).ravel())
    right.vertex_groups.new(name="None")
    keys_of(right)["Wide"].vertex_group = "None"  # so it moves nothing there
    bpy.ops.object.canonical_form_transfer(**{**TRANSFER, "like": rig.name}, kinds={"KEYS"})
    wide = points_of(keys_of(scan)["Wide"]) - points_of(keys_of(scan)["Basis"])
    vertices = small[0][old]
    assert keys_of(scan)["Wide"].vertex_group == ""
    assert np.abs(wide[vertices[:, 0] > 0.4]).max() < 0.02
    assert np.abs(wide[vertices[:, 0] < -1.0, 0]).mean() > 0.3


def test_layers_that_only_a_smaller_part_has_come_too(halves):
    scan, parts, rig, _ = halves  # noqa: F811
    largest, smaller = sorted(parts, key=lambda each: -len(each.data.vertices))
    while largest.data.uv_layers:
        largest.data.uv_layers.remove(largest.data.uv_layers[0])
    smaller.data.color_attributes.new(name="Paint", type="FLOAT_COLOR", domain="POINT")
    bpy.ops.object.canonical_form_transfer(**{**TRANSFER, "like": rig.name}, kinds={"UVS", "COLOURS"})
    assert [layer.name for layer in scan.data.uv_layers] == [smaller.data.uv_layers[0].name]
    assert "Paint" in scan.data.color_attributes


def test_props_of_an_armature_are_no_skin(halves):
    _, parts, rig, _ = halves  # noqa: F811
    floor = add_object("Floor", *shapes.sphere(4))
    floor.parent = rig
    bpy.context.view_layer.update()
    donor = read_donor(rig)
    assert {each.name for each in donor.objects} == {each.name for each in parts}
    assert len(donor.warnings) == 1
    assert donor.warnings[0].endswith("does: Floor.")


def test_a_part_that_another_armature_moves_too_is_told(halves):
    scan, parts, rig, _ = halves  # noqa: F811
    other = bpy.data.objects.new("Second", bpy.data.armatures.new("Second"))
    bpy.context.scene.collection.objects.link(other)
    parts[1].modifiers.new("Second", "ARMATURE").object = other
    bpy.context.view_layer.update()
    donor = read_donor(rig)
    assert [each.name for each in donor.objects] == ["Half L"]
    assert donor.warnings[0].endswith("does: Half R.")
    assert read_rig_source(rig).warnings == donor.warnings
    task = TransferTask([scan], rig, {"GROUPS"}, Settings(), -1)
    assert donor.warnings[0] in task.warnings


def test_an_armature_that_was_deleted_meanwhile_is_told(halves):
    scan, _, rig, _ = halves  # noqa: F811
    settings = Settings(**{name: value for name, value in TRANSFER.items() if name in Settings.__dataclass_fields__})
    task = TransferTask([scan], rig, {"GROUPS"}, settings, -1)
    task.compute()
    bpy.data.objects.remove(rig)
    before = snapshot(scan)
    with pytest.raises(CanonicalFormError, match="was deleted meanwhile"):
        task.write()
    assert snapshot(scan) == before


def test_a_donor_of_ours_is_read_as_its_bones_rest(body, lender):
    bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    donor = read_donor(armature_of(body))
    np.testing.assert_allclose(donor.vertices, lender.vertices, atol=1e-5)
    assert donor.rig is not None


def test_a_renamed_armature_still_knows_who_has_taken_from_it(halves):
    _, parts, rig, _ = halves  # noqa: F811
    bpy.ops.object.canonical_form_transfer(**{**TRANSFER, "like": rig.name}, kinds={"GROUPS"})
    rig.name = "Hero"
    assert {each.name for each in read_donor(rig).objects} == {each.name for each in parts}


def test_what_has_taken_over_a_rig_lends_it_at_its_rest(pair, rig, small):  # noqa: F811
    scan, _, old = pair
    bpy.ops.object.canonical_form_transfer(**TRANSFER, kinds={"GROUPS"})
    third = add_object("Third", *small)
    third.location.x = -6.0
    scan.select_set(False)
    bpy.context.view_layer.update()
    assert bpy.ops.object.canonical_form_transfer(**{**TRANSFER, "like": "Scan"}, kinds={"GROUPS", "KEYS"}) == {
        "FINISHED"
    }
    assert [key.name for key in keys_of(third)] == ["Basis", "Rest of Scan"]
    placed = points_of(keys_of(third)["Rest of Scan"]) + np.array(third.location)
    assert np.linalg.norm(placed - small[0], axis=1).mean() < 0.2  # on the rig
    assert len(old) == len(placed)


def test_keys_of_a_rig_of_ours_are_not_lent(body, scan, lender):
    bpy.ops.object.canonical_form_rig(**RIG, rest="T")
    assert [key.name for key in read_source(body).keys] == ["Smile"]


def test_the_skeleton_of_a_donor_tells_the_weights(body, scan, lender):
    bpy.ops.object.canonical_form_rig(**RIG, rest="NONE")
    taker = add_object("Taker", scan, lender.faces)
    body.select_set(False)
    bpy.context.view_layer.update()
    words = {**TRANSFER, "like": armature_of(body).name, "kinds": {"GROUPS"}}
    assert bpy.ops.object.canonical_form_transfer(**words) == {"FINISHED"}
    found = read_source(taker).groups
    for number, name in enumerate(lender.skeleton.names):
        assert np.abs(found.get(name, 0.0) - lender.weights[:, number]).mean() < 0.05, name


def test_bodies_in_two_halves_take_over_by_a_match(pair, rig, small):  # noqa: F811
    """A rig of half of a body would be none; data do not need one."""
    scan, base, _ = pair
    vertices, faces = small
    for obj in (scan, base):
        twice = bpy.data.meshes.new(obj.name)
        points = np.concatenate([vertices, vertices + np.array([9.0, 0, 0])])
        twice.from_pydata(points.tolist(), [], np.concatenate([faces, faces + len(vertices)]).tolist())
        obj.shape_key_clear()
        obj.data = twice
    for name, start in (("Left", 0), ("Right", len(vertices))):
        base.vertex_groups.new(name=name).add(list(range(start, start + len(vertices))), 1.0, "REPLACE")
    assert bpy.ops.object.canonical_form_transfer(**TRANSFER, kinds={"GROUPS"}) == {"FINISHED"}


def test_an_armature_without_meshes_is_no_donor(halves):
    scan, parts, rig, _ = halves  # noqa: F811
    for each in parts:
        each.hide_set(True)
    before = snapshot(scan)
    with pytest.raises(RuntimeError, match="moves no other mesh that is shown"):
        bpy.ops.object.canonical_form_transfer(**{**TRANSFER, "like": rig.name}, kinds={"GROUPS"})
    assert snapshot(scan) == before


def test_what_does_not_fit_is_refused_unless_it_is_wanted_anyway(pair):  # noqa: F811
    scan, _, _ = pair
    add_object("Star", *shapes.sphere(3)).select_set(False)
    bpy.context.view_layer.objects.active = scan
    before = snapshot(scan)
    words = {**TRANSFER, "like": "Star", "kinds": {"MATERIALS"}}
    with pytest.raises(RuntimeError, match="too unlike"):
        bpy.ops.object.canonical_form_transfer(**words)
    assert snapshot(scan) == before
    assert bpy.ops.object.canonical_form_transfer(**words, anyway=True) == {"FINISHED"}


def test_a_fit_is_weighed_by_area(small):  # noqa: F811
    vertices, faces = small
    found = match(vertices, faces, vertices, faces)
    require_fit(found, vertices, faces)
    found.confidence[:] = 0.3
    with pytest.raises(InvalidMeshError) as told:
        require_fit(found, vertices, faces)
    assert told.value.kind == "transfer_unlike"
