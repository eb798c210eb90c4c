"""What comes of files of every kind: the same form through every reader and writer, frames, references, axes."""

from pathlib import Path

import bpy
import numpy as np
import pytest

from addon.blender.files.reading_files import importer, open_meshes
from addon.blender.results.result_clearing import clear_from
from addon.core.measures.alignment import rigid_fit
from tests import commands
from tests.meshes import shapes

from .conftest import add_object

pytestmark = pytest.mark.usefixtures("computed_once")

KINDS = ("glb", "fbx", "usdc", "obj", "ply")


def run(*words):
    return commands.run(*words)[:2]


@pytest.fixture
def textured(tmp_path):
    """A .blend with a cylinder of n-gon caps, a UV map, two materials and a transform."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.mesh.primitive_cylinder_add(vertices=24, depth=4.0, rotation=(0.3, 0.2, 0.1), location=(1, 2, 3))
    obj = bpy.context.object
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.bisect(plane_co=(1, 2, 3), plane_no=(0, 0, 1))
    bpy.ops.object.mode_set(mode="OBJECT")
    obj.name = "Can"
    for name in ("Tin", "Paper label"):
        obj.data.materials.append(bpy.data.materials.new(name))
    for polygon in obj.data.polygons:
        polygon.material_index = len(polygon.vertices) == 4
    path = tmp_path / "can.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    return path


def told(path):
    """Positions in the scene, numbers of corners, UVs and materials of the one mesh of a file."""
    (obj,) = open_meshes(path)
    mesh = obj.data
    points = np.array([obj.matrix_world @ vertex.co for vertex in mesh.vertices])
    uv = np.array([each.uv[:] for each in mesh.uv_layers.active.data]) if mesh.uv_layers.active else np.zeros((0, 2))
    return points, sorted(len(each.vertices) for each in mesh.polygons), uv, {each.name for each in mesh.materials}


@pytest.mark.parametrize("kind", KINDS)
def test_forms_written_in_any_kind_are_read_again_as_they_were(kind, textured, tmp_path):
    code, [line] = run(textured, "--output", tmp_path / "out", "--format", kind)
    assert code == 0, line
    code, [kept] = run(textured, "--output", tmp_path / "blend")
    (obj,) = open_meshes(Path(kept["output"]))
    key = obj.data.shape_keys.key_blocks["Canonical Form"]
    truth = np.array([obj.matrix_world @ each.co for each in key.data])
    polygons = sorted(len(each.vertices) for each in obj.data.polygons)
    uvs = np.array([each.uv[:] for each in obj.data.uv_layers.active.data])
    points, corners, uv, materials = told(Path(line["output"]))
    if kind == "glb":  # it stores a copy of a vertex for every normal and UV coordinate
        points = np.unique(points.round(6), axis=0)
    assert len(points) == len(truth)
    order = np.linalg.norm(points[:, None] - truth, axis=2).argmin(axis=1)
    assert sorted(order) == list(range(len(truth)))
    np.testing.assert_allclose(points, truth[order], atol=1e-5 * np.ptp(truth))
    if kind != "glb":  # it holds triangles alone
        assert corners == polygons
    if kind != "ply":
        assert len(uv)
        np.testing.assert_allclose(np.unique(uv.round(4), axis=0), np.unique(uvs.round(4), axis=0), atol=2e-4)
        assert {"".join(name.split(".")[0].split()).replace("_", "") for name in materials} == {"Tin", "Paperlabel"}
    assert sorted(path.suffix for path in (tmp_path / "out").iterdir()) == sorted(
        [f".{kind}", ".mtl"] if kind == "obj" else [f".{kind}"]
    )


@pytest.mark.parametrize("kind", ["fbx", "usdc", "usda", "abc", "gltf"])
def test_every_reader_gives_the_same_form(kind, tmp_path):
    if importer(f".{kind}") is None:
        pytest.skip(f"this Blender does not read .{kind}")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    add_object("Figure", *shapes.figure(13))
    path = tmp_path / f"figure.{kind}"
    {
        "fbx": lambda: bpy.ops.export_scene.fbx(filepath=str(path), use_selection=True),
        "usdc": lambda: bpy.ops.wm.usd_export(filepath=str(path)),
        "usda": lambda: bpy.ops.wm.usd_export(filepath=str(path)),
        "abc": lambda: bpy.ops.wm.alembic_export(filepath=str(path), as_background_job=False),
        "gltf": lambda: bpy.ops.export_scene.gltf(filepath=str(path), export_format="GLTF_SEPARATE"),
    }[kind]()
    shapes.write_off(tmp_path / "plain.off", *shapes.figure(13))
    code, [read, plain] = run(path, tmp_path / "plain.off", "--output", tmp_path / "out", "--axes", "Z,-Y",
                              "--format", "ply")  # fmt: skip
    assert code == 0
    distorted = "edge_distortion_median"
    assert read["measures"][distorted] == pytest.approx(plain["measures"][distorted], rel=1e-2)
    forms = [told(Path(line["output"]))[0] for line in (read, plain)]
    near = np.linalg.norm(forms[0][:, None] - forms[1], axis=2)
    if kind != "fbx":  # the importer turns and scales it
        assert near.min(axis=1).max() < 1e-3 * np.ptp(forms[1])


def test_frames_of_a_rig_give_numbered_files_that_agree(tmp_path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    vertices, faces = shapes.joint(0)
    obj = add_object("Limb", vertices, faces)
    bpy.ops.object.armature_add(location=(0, 0, 0))
    rig = bpy.context.object
    bpy.ops.object.mode_set(mode="EDIT")
    bones = rig.data.edit_bones
    bones[0].head, bones[0].tail = (0, 0, 0), (2, 0, 0)
    child = bones.new("Fore")
    child.head, child.tail, child.parent = (2, 0, 0), (4, 0, 0), bones[0]
    first = bones[0].name
    bpy.ops.object.mode_set(mode="OBJECT")
    share = np.clip((vertices[:, 0] - 1.6) / 0.8, 0, 1)
    for name, weights in ((first, 1 - share), ("Fore", share)):
        group = obj.vertex_groups.new(name=name)
        for vertex, weight in enumerate(weights.tolist()):
            group.add([vertex], weight, "REPLACE")
    modifier = obj.modifiers.new("Armature", "ARMATURE")
    modifier.object = rig
    bone = rig.pose.bones["Fore"]
    bone.rotation_mode = "XYZ"
    for frame, angle in ((1, 0.0), (9, 1.2)):
        bone.rotation_euler = (0.0, 0.0, angle)
        bone.keyframe_insert("rotation_euler", frame=frame)
    path = tmp_path / "limb.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    code, lines = run(
        path, "--output", tmp_path / "out", "--frames", "1:9:4", "--format", "obj", "--reference", "first"
    )
    assert code == 0
    assert [line["frame"] for line in lines] == [1, 5, 9]
    names = ["limb-f0001.obj", "limb-f0005.obj", "limb-f0009.obj"]
    assert [Path(line["output"]).name for line in lines] == names
    forms = [shapes.read_obj(tmp_path / "out" / name)[0] for name in names]
    for form in forms[1:]:
        rotation, shift = rigid_fit(form, forms[0])
        apart = [np.sqrt(((each - forms[0]) ** 2).sum(axis=1).mean()) for each in (form, form @ rotation + shift)]
        assert apart[0] < 1.15 * apart[1] + 1e-3
    code, lines = run(path, "--output", tmp_path / "out", "--frames", "1:9:4", "--format", "obj", "--skip-existing")
    assert (code, [line.get("skipped") for line in lines]) == (0, [True] * 3)
    forms = [form[:, [0, 2, 1]] * [1, -1, 1] for form in forms]  # Y is up in .obj
    words = ("--frames", "1:9:4", "--frames-as", "keys", "--reference", "first")
    code, lines = run(path, "--output", tmp_path / "keys", *words)
    assert (code, {line["output"] for line in lines}) == (0, {str(tmp_path / "keys" / "limb.blend")})
    bpy.ops.wm.open_mainfile(filepath=lines[0]["output"])
    assert list(bpy.data.objects["Limb"].data.shape_keys.key_blocks.keys())[1:] == [
        "Canonical Form 1", "Canonical Form 5", "Canonical Form 9",
    ]  # fmt: skip
    for frame, form in zip((1, 5, 9), forms, strict=True):
        bpy.context.scene.frame_set(frame)
        shown = bpy.data.objects["Limb"].evaluated_get(bpy.context.evaluated_depsgraph_get()).data
        assert np.abs(np.array([vertex.co for vertex in shown.vertices]) - form).max() < 2e-3
    limb = bpy.data.objects["Limb"]
    limb.modifiers.new("Finer", "SUBSURF").levels = 1
    finer = tmp_path / "finer.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(finer), copy=True)
    code, found = run(finer, "--output", tmp_path / "finer", *words[:4], "--mesh", "shown")
    assert code == 1
    assert all("--frames-as files" in line["error"] for line in found)
    assert not (tmp_path / "finer" / "finer.blend").exists()
    bpy.ops.wm.open_mainfile(filepath=lines[0]["output"])
    limb = bpy.data.objects["Limb"]
    assert clear_from(limb) == []
    assert limb.data.shape_keys is None, "the keys of the frames cannot be cleared"


def test_objects_together_are_one_result(tmp_path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    vertices, faces = shapes.figure(13)
    add_object("Body", vertices, faces)
    ball, triangles = shapes.sphere(2)
    add_object("Ball", 0.2 * ball + vertices[100], triangles)
    path = tmp_path / "pair.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    code, [line] = run(path, "--output", tmp_path / "out", "--together", "--format", "glb")
    assert code == 0
    assert sorted(line["objects"]) == ["Ball", "Body"]
    assert len(open_meshes(Path(line["output"]))) == 2
    code, [line] = run(path, "--output", tmp_path / "out", "--together", "--format", "obj")
    assert code == 1
    assert "holds one object" in line["error"]
    code, lines = run(path, "--output", tmp_path / "each", "--objects", "Ball", "Body", "--format", "obj")
    assert [Path(each["output"]).name for each in lines] == ["pair-Ball.obj", "pair-Body.obj"]


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--axes", "Z,Z", "--format", "ply"], "two different axes"),
        (["--axes", "Z,-Y", "--format", "glb"], "has axes of its own"),
        (["--frames", "5:1"], "at least one frame"),
        (["--frames", "a:b"], "whole numbers"),
        (["--frames-as", "keys"], "needs --frames"),
        (["--frames-as", "keys", "--frames", "1:3", "--format", "glb"], "--format blend"),
        (["--frame", "2", "--frames", "1:3"], "not allowed with"),
        (["--value", "nan"], "between 0 and 1"),
        (["--value", "1.1"], "between 0 and 1"),
        (["--jobs", "0"], "at least 1"),
        (["--jobs", "2"], "one job only"),
        (["--reference", "nowhere.off"], "not a file"),
    ],
)
def test_words_that_make_no_sense_are_told_in_a_sentence(words, sentence, tmp_path, capsys):
    shapes.write_off(tmp_path / "figure.off", *shapes.figure(12))
    code, lines = run(tmp_path / "figure.off", "--output", tmp_path / "out", *words)
    assert code == (1 if "reference" in words[0] else 2)
    assert not lines
    assert sentence in capsys.readouterr().err


def test_folders_and_patterns_mean_the_meshes_in_them(tmp_path, capsys):
    for name in ("b.off", "a.off", "notes.txt"):
        shapes.write_off(tmp_path / name, *shapes.figure(12))
    for words in ([tmp_path], [tmp_path / "*.off"], [tmp_path / "a.off", tmp_path / "b.off"]):
        code, lines = run(*words, "--output", tmp_path / "out", "--format", "obj")
        assert (code, [Path(line["input"]).name for line in lines]) == (0, ["a.off", "b.off"])
    assert run(tmp_path / "x*.off", "--output", tmp_path / "out")[0] == 2
    assert "No mesh matches" in capsys.readouterr().err
    assert run(tmp_path / "**" / "*.off", "--output", tmp_path / "out", "--format", "obj")[1][0]["input"].endswith(
        "a.off"
    )
    assert len(run(tmp_path / "**" / "*.o*", "--output", tmp_path / "out", "--format", "obj")[1]) == 2
    (tmp_path / "empty").mkdir()
    assert run(tmp_path / "empty", "--output", tmp_path / "out")[0] == 2
    assert run(tmp_path / "out", "--output", tmp_path / "out")[0] == 2


def test_nothing_of_an_earlier_frame_is_left_in_a_blend(tmp_path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    add_object("Figure", *shapes.figure(14)).modifiers.new("Subdivision", "SUBSURF").levels = 1
    path = tmp_path / "figure.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    code, lines = run(path, "--output", tmp_path / "out", "--frames", "1:2")
    assert code == 0
    for line in lines:
        names = [obj.name for obj in open_meshes(Path(line["output"]))]
        assert names == ["Figure", "Figure Canonical Form"]


def test_objects_that_share_a_mesh_are_named_and_the_reference_may_have_others(tmp_path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    obj = add_object("Left", *shapes.figure(14))
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Right", obj.data))
    path = tmp_path / "shared.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    shapes.write_off(tmp_path / "other.off", *shapes.figure(14))
    words = ["--output", tmp_path / "out", "--format", "obj", "--reference", tmp_path / "other.off"]
    code, lines = run(path, *words, "--objects", "Left", "Right")
    assert (code, [line["object"] for line in lines]) == (0, ["Left"])
    code, lines = run(path, *words, "--objects", "Left", "Right", "--mesh", "shown")
    assert (code, [line["object"] for line in lines]) == (0, ["Left", "Right"])
