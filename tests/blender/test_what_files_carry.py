"""What a file carries arrives in its result: UV maps, colours, materials, pictures, normals, and nothing of ours."""

from pathlib import Path

import bpy
import numpy as np
import pytest

from addon.blender.files.reading_files import open_meshes
from tests.blender.conftest import add_object
from tests.commands import run
from tests.meshes import shapes

KINDS = ("glb", "fbx", "usdz")


@pytest.fixture
def painted(tmp_path):
    """A .glb of a smooth figure with a packed picture, colours, a property, a hard edge around its waist."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    vertices, faces = shapes.figure(13)
    obj = add_object("Body", vertices, faces)
    mesh = obj.data
    obj["studio"] = "north"
    mesh.shade_smooth()
    layer = mesh.uv_layers.new(name="UVMap")
    front = vertices[faces].mean(axis=1)[:, 1] > 0
    places = vertices[faces][:, :, [0, 2]] / 8 + 0.5 + np.where(front, 10.0, 0.0)[:, None, None]
    layer.uv.foreach_set("vector", places.astype(np.float32).ravel())
    paint = mesh.color_attributes.new(name="Paint", type="FLOAT_COLOR", domain="POINT")
    values = np.column_stack([np.clip(0.5 + 0.1 * vertices, 0, 1), np.ones(len(vertices))])
    paint.data.foreach_set("color", values.astype(np.float32).ravel())
    picture = bpy.data.images.new("Skin", 8, 8)
    picture.pack()
    material = bpy.data.materials.new("Skin")
    material.use_nodes = True
    node = material.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = picture
    shader = next(each for each in material.node_tree.nodes if each.type == "BSDF_PRINCIPLED")
    material.node_tree.links.new(node.outputs[0], shader.inputs["Base Color"])
    mesh.materials.append(material)
    path = tmp_path / "body.glb"
    bpy.ops.export_scene.gltf(filepath=str(path), export_extras=True, export_vertex_color="ACTIVE")
    return path


def normals_by_corner(mesh):
    """Normals of the corners by the centre of their triangle and their place, rounded."""
    found = {}
    for polygon in mesh.polygons:
        corners = [mesh.vertices[mesh.loops[loop].vertex_index].co for loop in polygon.loop_indices]
        centre = tuple(np.round(np.mean(corners, axis=0), 4))
        for loop, place in zip(polygon.loop_indices, corners, strict=True):
            found[centre, tuple(np.round(place, 4))] = np.array(mesh.corner_normals[loop].vector)
    return found


def test_a_glb_keeps_normals_and_seams(painted, tmp_path):
    (obj,) = open_meshes(painted)
    before, count = normals_by_corner(obj.data), len(obj.data.vertices)
    code, [line], _ = run(painted, "--output", tmp_path / "out", "--value", "0")
    assert code == 0
    (obj,) = open_meshes(Path(line["output"]))
    assert len(obj.data.vertices) == count
    after = normals_by_corner(obj.data)
    assert after.keys() == before.keys()
    assert min(float(before[key] @ after[key]) for key in before) > np.cos(np.radians(0.1))


@pytest.mark.parametrize("kind", KINDS)
def test_what_the_mesh_has_arrives_and_nothing_of_ours(kind, painted, tmp_path):
    (obj,) = open_meshes(painted)
    uvs = np.unique(np.array([each.uv[:] for each in obj.data.uv_layers.active.data]).round(4), axis=0)
    code, [line], _ = run(painted, "--output", tmp_path / "out", "--format", kind)
    assert code == 0
    (obj,) = open_meshes(Path(line["output"]))
    mesh = obj.data
    assert len(mesh.color_attributes) == 1
    assert not any("canonical" in key.lower() for owner in (obj, mesh) for key in owner.keys())  # noqa: SIM118
    assert obj.vertex_groups.keys() == []
    after = np.unique(np.array([each.uv[:] for each in mesh.uv_layers.active.data]).round(4), axis=0)
    np.testing.assert_allclose(after, uvs, atol=2e-4)
    (material,) = mesh.materials
    assert material.name.startswith("Skin")
    images = [node.image for node in material.node_tree.nodes if node.type == "TEX_IMAGE"]
    assert [tuple(image.size) for image in images] == [(8, 8)]
    if kind != "usdz":  # whose importer keeps them under another name
        assert obj["studio"] == "north"


@pytest.mark.parametrize(("kind", "held"), [("glb", True), ("usdz", True), ("usdc", False), ("obj", False)])
def test_pictures_that_do_not_come_along_are_told(kind, held, painted, tmp_path):
    code, [line], _ = run(painted, "--output", tmp_path / "out", "--format", kind)
    assert code == 0
    assert any("do not come along: Skin" in each for each in line["warnings"]) != held


@pytest.mark.parametrize(("kind", "name"), [("glb", "_PATCHES"), ("fbx", "Patches"), ("usdz", "Patches")])
def test_colours_are_added_on_request(kind, name, painted, tmp_path):
    code, [line], _ = run(painted, "--output", tmp_path / "out", "--format", kind, "--colours", "patches")
    assert code == 0
    (obj,) = open_meshes(Path(line["output"]))
    assert name in obj.data.attributes
    assert len(obj.data.color_attributes) == (1 if kind == "glb" else 2)


@pytest.mark.parametrize("kind", ["ply", "obj"])
def test_colours_of_a_scan_stay(kind, tmp_path):
    vertices, faces = shapes.figure(13)
    shades = np.clip(np.round(255 * (0.5 + 0.1 * vertices)), 0, 255).astype(int)
    path = tmp_path / "scan.ply"
    lines = ["ply", "format ascii 1.0", f"element vertex {len(vertices)}",
             *(f"property float {axis}" for axis in "xyz"),
             *(f"property uchar {name}" for name in ("red", "green", "blue")), f"element face {len(faces)}",
             "property list uchar int vertex_indices", "end_header"]  # fmt: skip
    lines += [
        " ".join(map(str, [*point, *shade])) for point, shade in zip(vertices.tolist(), shades.tolist(), strict=True)
    ]
    path.write_text("\n".join([*lines, *("3 " + " ".join(map(str, each)) for each in faces.tolist())]))
    code, [line], _ = run(path, "--output", tmp_path / "out", "--format", kind)
    assert code == 0
    rows = [each.split() for each in Path(line["output"]).read_text().splitlines()]
    start = 4 if kind == "obj" else 3
    found = [row[start : start + 3] for row in rows if len(row) == start + 3 and (kind == "ply" or row[0] == "v")]
    colours = np.array(found[: len(vertices)], dtype=float) * (255 if kind == "obj" else 1)
    np.testing.assert_allclose(colours, shades, atol=1)
