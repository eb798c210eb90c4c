"""Results with the rig: bones, weights and keys arrive in every kind that holds them, the form as one of the keys."""

from pathlib import Path

import numpy as np
import pytest

from tests.commands import run
from tests.meshes import shapes

bpy = pytest.importorskip("bpy")
from addon.blender.files.reading_files import open_meshes  # noqa: E402
from tests.blender.conftest import add_object  # noqa: E402

KINDS = ("glb", "fbx", "usdz")


@pytest.fixture
def character(tmp_path):
    """A figure with a rig that is turned and posed, weights, a key, a picture and a property."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    vertices, faces = shapes.figure(12)
    obj = add_object("Body", vertices, faces)
    obj.data.shade_smooth()
    layer = obj.data.uv_layers.new(name="UVMap")
    corners = np.array([loop.vertex_index for loop in obj.data.loops])
    layer.uv.foreach_set("vector", (vertices[corners][:, :2] / np.ptp(vertices)).astype(np.float32).ravel())
    picture = bpy.data.images.new("Skin", 16, 16)
    picture.pixels.foreach_set(np.linspace(0, 1, 1024, dtype=np.float32))
    picture.pack()
    material = bpy.data.materials.new("Skin")
    material.use_nodes = True
    texture = material.node_tree.nodes.new("ShaderNodeTexImage")
    texture.image = picture
    material.node_tree.links.new(
        texture.outputs["Color"], material.node_tree.nodes["Principled BSDF"].inputs["Base Color"]
    )
    obj.data.materials.append(material)
    rig = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    lower, upper = (rig.data.edit_bones.new(name) for name in ("Hips", "Chest"))
    low, high = vertices[:, 2].min(), vertices[:, 2].max()
    lower.head, lower.tail = (0, 0, low), (0, 0, (low + high) / 2)
    upper.head, upper.tail, upper.parent = lower.tail, (0, 0, high), lower
    bpy.ops.object.mode_set(mode="OBJECT")
    share = np.clip((vertices[:, 2] - low) / (high - low), 0, 1)
    for name, weights in (("Hips", 1 - share), ("Chest", share)):
        group = obj.vertex_groups.new(name=name)
        for vertex, weight in enumerate(weights.tolist()):
            group.add([vertex], weight, "REPLACE")
    obj.parent = rig
    obj.modifiers.new("Armature", "ARMATURE").object = rig
    rig.location, rig.rotation_euler = (1, 2, 0), (0, 0, 0.5)
    obj.shape_key_add(name="Basis")
    smile = obj.shape_key_add(name="Smile")
    smile.points.foreach_set("co", (vertices + np.array([0, 0.2, 0])).astype(np.float32).ravel())
    smile.value = 0.0
    obj["maker"] = "us"
    bone = rig.pose.bones["Chest"]
    bone.rotation_mode, bone.rotation_euler = "XYZ", (0.6, 0, 0)
    rig.hide_viewport = True
    path = tmp_path / "in.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    return path


def told(path):
    """Open a file and return what it holds of the character, in world space."""
    (obj,) = open_meshes(Path(path))
    bpy.context.scene.frame_set(bpy.context.scene.frame_current)  # .usd has the values of keys as an animation
    mesh, placement = obj.data, np.array(obj.matrix_world)
    shown = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data

    def placed(points):
        return np.array([point.co for point in points]) @ placement[:3, :3].T + placement[:3, 3]

    weights = np.zeros((len(mesh.vertices), 2))
    for vertex in mesh.vertices:
        for each in vertex.groups:
            name = obj.vertex_groups[each.group].name
            if name in ("Hips", "Chest"):
                weights[vertex.index, ("Hips", "Chest").index(name)] = each.weight
    return {
        "shown": placed(shown.vertices),
        "keys": {key.name.replace("_", " "): placed(key.data) for key in mesh.shape_keys.key_blocks},
        "weights": weights,
        "bones": sorted(bone.name for each in bpy.data.armatures for bone in each.bones),
        "groups": [group.name for group in obj.vertex_groups],
        "normals": np.array([normal.vector for normal in mesh.corner_normals]),
        "uvs": np.array([each.uv[:] for each in mesh.uv_layers.active.data]),
        "maker": obj.get("maker"),
        "pictures": [tuple(node.image.size) for node in mesh.materials[0].node_tree.nodes if node.type == "TEX_IMAGE"],
    }


@pytest.mark.parametrize("read_as", ["base", "shown"])
def test_rig_weights_and_keys_arrive_with_the_form_among_them(read_as, character, tmp_path):
    before = told(character)
    _, [kept], _ = run(character, "--output", tmp_path / "kept", "--mesh", read_as)
    held = told(kept["output"])
    for kind in KINDS:
        words = ("--output", tmp_path / "out", "--format", kind, "--keep-rig", "--mesh", read_as)
        code, [line], _ = run(character, *words)
        assert code == 0, line
        require_all(told(line["output"]), before, held, read_as)


def require_all(after, before, held, read_as):
    """Require what the character had, and the form that a .blend holds, of what arrived."""
    size = np.ptp(before["shown"])
    assert after["bones"] == ["Chest", "Hips"]
    assert after["groups"] == ["Hips", "Chest"]
    np.testing.assert_allclose(after["weights"], before["weights"], atol=2e-3)
    assert set(after["keys"]) == {"Basis", "Smile", "Canonical Form"}
    for name in ("Basis", "Smile"):
        np.testing.assert_allclose(after["keys"][name], before["keys"][name], atol=1e-4 * size)
    np.testing.assert_allclose(after["keys"]["Canonical Form"], held["keys"]["Canonical Form"], atol=1e-4 * size)
    form = held["shown"] if read_as == "shown" else held["keys"]["Canonical Form"]  # which a pose would bend
    np.testing.assert_allclose(after["shown"], form, atol=1e-3 * size)
    np.testing.assert_allclose(after["uvs"], before["uvs"], atol=1e-5)
    cosine = np.clip((after["normals"] * before["normals"]).sum(axis=1), -1, 1)
    assert np.degrees(np.arccos(cosine)).max() < 0.1
    assert after["maker"] == "us"
    assert after["pictures"] == [(16, 16)]


def test_what_is_hidden_by_its_collection_is_written_all_the_same(character, tmp_path):
    bpy.ops.wm.open_mainfile(filepath=str(character))
    put_away = bpy.data.collections.new("Put Away")
    bpy.context.scene.collection.children.link(put_away)
    for obj in bpy.data.objects[:]:
        put_away.objects.link(obj)
        bpy.context.scene.collection.objects.unlink(obj)
    put_away.hide_viewport = put_away.hide_select = True
    bpy.ops.wm.save_as_mainfile(filepath=str(character), copy=True)
    code, [line], _ = run(character, "--output", tmp_path / "out", "--format", "glb", "--keep-rig")
    assert code == 0, line
    found = told(line["output"])
    assert found["bones"] == ["Chest", "Hips"]
    assert set(found["keys"]) == {"Basis", "Smile", "Canonical Form"}


def test_a_file_does_not_take_over_from_itself(character, tmp_path):
    code, [line], _ = run(character, "--output", tmp_path / "out", "--reference", character, about="transfer")
    assert code == 1
    assert "the reference itself" in line["error"]


def test_a_rig_is_kept_where_a_key_can_hold_the_form(character, tmp_path):
    code, _, complaints = run(character, "--output", tmp_path / "out", "--keep-rig")
    assert code == 2
    assert "a .blend keeps the rig anyway" in complaints
    bpy.ops.wm.open_mainfile(filepath=str(character))
    bpy.data.objects["Body"].modifiers.new("Finer", "SUBSURF").levels = 1
    bpy.ops.wm.save_as_mainfile(filepath=str(character), copy=True)
    words = ("--output", tmp_path / "out", "--keep-rig", "--format", "glb", "--mesh", "shown")
    code, [line], _ = run(character, *words)
    assert code == 1
    assert "leave --keep-rig out" in line["error"]


@pytest.mark.parametrize("kind", ["blend", "glb", "fbx"])
def test_a_transfer_between_files_brings_the_rig_and_the_keys(kind, character, tmp_path):
    vertices, faces = shapes.figure(13)
    shapes.write_off(tmp_path / "scan.off", vertices, faces)
    words = ("--reference", character, "--kinds", "weights", "keys", "uvs", "materials", "--output", tmp_path / "out")
    code, [line], _ = run(tmp_path / "scan.off", *words, "--format", kind, about="transfer")
    assert code == 0, line
    assert line["from"] == "Body"
    found = told(line["output"])
    assert found["bones"] == ["Chest", "Hips"]
    np.testing.assert_allclose(found["weights"].sum(axis=1), 1, atol=1e-3)
    assert {"Basis", "Rest of Body", "Smile"} <= set(found["keys"])
    moved = found["keys"]["Smile"] - found["keys"]["Basis"]
    assert np.median(np.linalg.norm(moved, axis=1)) == pytest.approx(0.2, rel=0.1)
    assert len(bpy.data.objects) - (kind == "fbx") <= 3  # nothing else of the other file
    code, _, complaints = run(tmp_path / "scan.off", *words, "--mesh", "shown", about="transfer")
    assert code == 2
    assert "the mesh itself" in complaints
