import io
import json
import os
import re
import sys
from pathlib import Path

import bpy
import numpy as np
import pytest

from addon.batch.command import main
from addon.batch.inputs import output_stems, separators
from addon.blender.files.off_format import read_off
from addon.core import CanonicalFormError, InvalidMeshError
from tests.commands import QUICK, ROOT, ended, run, run_apart, run_below_file_size, started
from tests.meshes import shapes

pytestmark = pytest.mark.usefixtures("computed_once")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The same small figure in every format, and some that are broken."""
    folder = tmp_path_factory.mktemp("meshes")
    vertices, faces = shapes.figure(13)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    mesh = bpy.data.meshes.new("Figure")
    mesh.from_pydata(vertices.tolist(), [], faces.tolist())
    obj = bpy.data.objects.new("Figure", mesh)
    bpy.context.scene.collection.objects.link(obj)
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "blend.blend"), copy=True)
    bpy.ops.wm.obj_export(filepath=str(folder / "obj.obj"), export_materials=False)
    bpy.ops.wm.ply_export(filepath=str(folder / "ply.ply"))
    bpy.ops.wm.stl_export(filepath=str(folder / "stl.stl"))
    bpy.ops.export_scene.gltf(filepath=str(folder / "glb.glb"))
    lines = ["OFF", "# a comment", f"{len(vertices)} {len(faces)} 0"]
    lines += [f"{x} {y} {z}" for x, y, z in vertices] + [f"3 {a} {b} {c}" for a, b, c in faces]
    (folder / "off.off").write_text("\n".join(lines))
    (folder / "short.off").write_text("\n".join(lines[:40]))
    (folder / "empty.blend").write_bytes(b"")
    (folder / "text.txt").write_text("hello")
    return folder


def test_every_format_gives_the_same_form(folder, tmp_path):
    inputs = [folder / f"{kind}.{kind}" for kind in ("blend", "obj", "ply", "stl", "glb", "off")]
    code, lines, _ = run_apart(*inputs, "--output", tmp_path)
    assert code == 0
    assert [Path(line["input"]).suffix for line in lines] == [path.suffix for path in inputs]
    vertices, faces = shapes.figure(13)
    for line in lines:
        assert line["faces"] == len(faces)
        if line["input"].endswith("glb"):  # flat faces share no vertices there
            assert line["vertices"] > 2 * len(vertices)
        else:
            assert line["vertices"] == len(vertices)
        assert len(line["feature_points"]) == len(lines[0]["feature_points"])
        distorted = "edge_distortion_median"
        assert line["measures"][distorted] == pytest.approx(lines[0]["measures"][distorted], rel=1e-2)
        assert set(line) == {
            "schema", "input", "object", "output", "vertices", "faces", "feature_points", "feature_names",
            "patch_sizes", "method", "pieces", "memory_estimate", "measures", "timings", "warnings",
        } | ({"notes"} if line["input"].endswith("glb") else set())  # fmt: skip
        bpy.ops.wm.open_mainfile(filepath=line["output"])
        obj = bpy.data.objects[line["object"]]
        assert "Canonical Form" in obj.data.shape_keys.key_blocks
        assert "Patches" in obj.data.color_attributes
        assert len(obj.vertex_groups) == 1 + len(line["feature_points"])
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(f"{path.stem}.blend" for path in inputs)


def test_a_method_that_lowers_one_stress_reports_it(folder, tmp_path):
    code, [line], _ = run(folder / "off.off", "--output", tmp_path, "--method", "local_features")
    assert code == 0
    assert line["stress"]["steps"] == 2
    assert line["stress"]["last"] < line["stress"]["first"]
    assert line["pair_count"] > 0
    assert line["pair_reduction"] == 1 - line["pair_count"] / line["vertices"] ** 2


@pytest.mark.parametrize("kind", ["obj", "ply"])
def test_the_bare_form_has_the_inputs_order_and_space(folder, tmp_path, kind):
    code, [line], _ = run(folder / "off.off", "--output", tmp_path, "--format", kind)
    assert code == 0
    assert Path(line["output"]) == tmp_path / f"off.{kind}"
    vertices, faces = shapes.figure(13)
    if kind == "obj":
        form, corners = shapes.read_obj(tmp_path / "off.obj")
        form = form[:, [0, 2, 1]] * [1, -1, 1]  # Y is up in .obj
        np.testing.assert_array_equal(corners, faces)
    else:
        bpy.ops.wm.read_factory_settings(use_empty=True)
        bpy.ops.wm.ply_import(filepath=line["output"])
        form = np.array([vertex.co for vertex in bpy.context.object.data.vertices])
    assert form.shape == vertices.shape
    np.testing.assert_allclose(form.mean(axis=0), vertices.mean(axis=0), atol=0.3)


def test_a_failed_mesh_does_not_stop_the_others(folder, tmp_path):
    broken = [folder / "short.off", folder / "empty.blend", folder / "text.txt", folder / "missing.obj"]
    code, lines, errors = run_apart(*broken, folder / "off.off", "--output", tmp_path)
    assert code == 1
    assert [("error" in line) for line in lines] == [True] * 4 + [False]
    assert "cut short" in lines[0]["error"]
    assert "not of a kind" in lines[2]["error"]
    assert "not a file" in lines[3]["error"]
    for line in lines[:4]:
        assert line["error"] in errors
    assert [path.name for path in tmp_path.iterdir()] == ["off.blend"]


def test_an_input_is_never_overwritten(folder, tmp_path):
    source = tmp_path / "off.obj"
    vertices, faces = shapes.figure(13)
    text = "\n".join([f"v {x} {y} {z}" for x, y, z in vertices] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces])
    source.write_text(text)
    code, [line], _ = run(source, "--output", tmp_path, "--format", "obj")
    assert code == 1
    assert "overwrite" in line["error"]
    assert source.read_text() == text


def test_an_existing_result_is_replaced_and_nothing_is_left_beside_it(folder, tmp_path):
    (tmp_path / "off.obj").write_text("old")
    assert run(folder / "off.off", "--output", tmp_path, "--format", "obj")[0] == 0
    assert (tmp_path / "off.obj").read_text().startswith("v ")
    assert len(list(tmp_path.iterdir())) == 1


def test_every_mesh_of_a_blend_file_is_done_and_one_can_be_named(tmp_path, folder):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    vertices, faces = shapes.figure(13)
    for name in ("One", "Two"):
        mesh = bpy.data.meshes.new(name)
        mesh.from_pydata(vertices.tolist(), [], faces.tolist())
        bpy.context.scene.collection.objects.link(bpy.data.objects.new(name, mesh))
    bpy.ops.object.camera_add()
    source = tmp_path / "two.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(source), copy=True)
    code, lines, _ = run(source, "--output", tmp_path / "out")
    assert code == 0
    assert [line["object"] for line in lines] == ["One", "Two"]
    code, lines, _ = run(source, "--output", tmp_path / "out", "--object", "Two", "--format", "obj")
    assert [line["object"] for line in lines] == ["Two"]
    code, lines, _ = run(source, "--output", tmp_path / "out", "--object", "Three")
    assert "no mesh object named" in lines[0]["error"]


def test_options_reach_the_method(folder, tmp_path):
    code, [line], _ = run(folder / "off.off", "--output", tmp_path, "--feature-points", "5,300")
    assert code == 0
    assert line["feature_points"] == [5, 300]
    for wrong in (["--feature-points", "x"], ["--prominence", "-1"], ["--symmetry", "nowhere"], ["--nonsense"]):
        code, lines, errors = run(folder / "off.off", "--output", tmp_path, *wrong)
        assert (code, lines) == (2, [])
        assert errors


def test_no_words_and_help():
    output = io.StringIO()
    assert main([], output) == 2
    assert output.getvalue() == ""
    assert main(["--help"], output) == 0
    for command in ("compute", "pose-like", "match"):
        assert main([command, "--help"], output) == 0
    assert main(["match", "only_one.obj", "--output", "folder"], output) == 2
    assert "--output DIR" in output.getvalue()


def test_files_of_one_name_get_their_folders_names(tmp_path):
    paths = [tmp_path / "a" / "rest.obj", tmp_path / "b" / "rest.obj", tmp_path / "b" / "walk.obj"]
    assert output_stems(paths) == ["a-rest", "b-rest", "walk"]
    with pytest.raises(CanonicalFormError, match="would have the same name"):
        output_stems([paths[0], paths[0]])


@pytest.mark.parametrize(
    ("text", "words"),
    [("", "OFF"), ("PLY\n", "OFF"), ("OFF\n1 x 0\n", "well-formed"), ("OFF\n3 1 0\n0 0 0\n", "cut short"),
     ("OFF\n-3 1 0\n", "cut short|announces"), ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 a\n3 0 1 2\n", "well-formed"),
     ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 9\n", "not there"), ("OFF", "well-formed"),
     ("OFF\n3 1 0\n0 0\n1 0\n0 1\n3 0 1 2\n", "less than three"),
     ("4OFF\n3 1 0\n0 0 0 1\n1 0 0 1\n0 1 0 1\n3 0 1 2\n", "a kind that is not read")],
)  # fmt: skip
def test_broken_off_files_are_refused(tmp_path, text, words):
    path = tmp_path / "broken.off"
    path.write_text(text)
    with pytest.raises(InvalidMeshError, match=words):
        read_off(path)


def test_off_with_counts_on_the_first_line_colours_and_quads(tmp_path):
    path = tmp_path / "quad.off"
    path.write_text("COFF 4 1 0\n0 0 0 255 0 0\n1 0 0 0 0 0\n1 1 0 0 0 0\n0 1 0 9 9 9\n4 0 1 2 3 0.5 0.5 0.5\n")
    vertices, polygons = read_off(path)[:2]
    np.testing.assert_array_equal(vertices[2], [1, 1, 0])
    assert polygons == [[0, 1, 2, 3]]


def test_a_file_with_awkward_objects_does_not_stop_the_run(tmp_path, folder):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    vertices, faces = shapes.figure(13)
    hidden = bpy.data.collections.new("Hidden")
    bpy.context.scene.collection.children.link(hidden)
    for name, collection in (("Cube.001", bpy.context.scene.collection), ("Cube_001", hidden)):
        mesh = bpy.data.meshes.new(name)
        mesh.from_pydata(vertices.tolist(), [], faces.tolist())
        collection.objects.link(bpy.data.objects.new(name, mesh))
    twin = bpy.data.objects.new("Twin", bpy.data.meshes["Cube.001"])
    bpy.context.scene.collection.objects.link(twin)
    bpy.context.view_layer.layer_collection.children["Hidden"].exclude = True
    bpy.data.texts.new("secret")
    bpy.data.scenes.new("Other")
    source = tmp_path / "awkward.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(source), copy=True)
    code, lines, _ = run(source, folder / "off.off", "--output", tmp_path / "obj", "--format", "obj")
    assert code == 0
    assert len({line["output"].casefold() for line in lines}) == len(lines) == 3
    assert len(list((tmp_path / "obj").iterdir())) == 3
    code, [line], _ = run(source, "--output", tmp_path / "one", "--object", "Twin")
    assert (code, line["object"]) == (0, "Twin")
    code, lines, _ = run(source, folder / "off.off", "--output", tmp_path / "both")
    assert code == 0
    bpy.ops.wm.open_mainfile(filepath=lines[-1]["output"])
    assert [len(each) for each in (bpy.data.texts, bpy.data.scenes, bpy.data.objects)] == [0, 1, 1]


def test_a_face_too_large_for_ply_is_refused(tmp_path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.mesh.primitive_cylinder_add(vertices=300)
    source = tmp_path / "round.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(source), copy=True)
    code, [line], _ = run(source, "--output", tmp_path, "--format", "ply")
    assert code == 1
    assert "300 corners" in line["error"]


HOSTILE_OFF = {  # what it is: the text, and words of the answer
    "indices of 2³¹": ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2147483648\n", "not there"),
    "negative indices": ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", "not there"),
    "faces without corners": ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n0\n", "well-formed|no mesh with faces"),
    "faces of two corners": ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n", "no mesh|no faces|no area|corners"),
    "counts of 10³⁰": (f"OFF\n{10**30} 1 0\n0 0 0\n", "cut short"),
    "not numbers": ("OFF\n3 1 0\nnan 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "not numbers"),
    "infinite": ("OFF\n3 1 0\n1e400 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "not numbers"),
    "no area": ("OFF\n3 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n", "no area"),
    "zeros": ("\0" * 1000, "does not start with OFF"),
}


def test_hostile_files_are_reported_in_sentences(tmp_path):
    where = tmp_path / "in"
    where.mkdir()
    wanted = {}
    for number, (text, words) in enumerate(HOSTILE_OFF.values()):
        wanted[where / f"{number}.off"] = words
        (where / f"{number}.off").write_text(text)
    for suffix in (".blend", ".obj", ".ply", ".stl", ".glb", ".off"):
        wanted[where / f"empty-{suffix[1:]}{suffix}"] = "cannot read|no mesh|does not start"
        (where / f"empty-{suffix[1:]}{suffix}").write_bytes(b"")
    wanted[where / "nowhere.ply"] = "is not a file"
    if sys.platform != "win32":
        wanted[where / "pipe.stl"] = "is not a file"
        os.mkfifo(where / "pipe.stl")
    before = sorted(where.iterdir())
    code, lines, _ = run(*wanted, "--output", tmp_path / "out")
    assert code == 1
    assert len(lines) == len(wanted)
    for line in lines:
        assert re.search(wanted[Path(line["input"])], line["error"]), line
    assert sorted(where.iterdir()) == before
    assert list((tmp_path / "out").iterdir()) == []


def test_odd_names_stay_in_the_output_folder(tmp_path, folder):
    source = tmp_path / "a\nb ü.off"
    source.write_bytes((folder / "off.off").read_bytes())
    bpy.ops.wm.read_factory_settings(use_empty=True)
    vertices, faces = shapes.figure(12)
    for name in ("../../out of here", "/tmp/x", "con", "a" * 60):
        mesh = bpy.data.meshes.new("Mesh")
        mesh.from_pydata(vertices.tolist(), [], faces.tolist())
        bpy.context.scene.collection.objects.link(bpy.data.objects.new(name, mesh))
    odd = tmp_path / "odd.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(odd), copy=True)
    code, lines, _ = run(source, odd, "--output", tmp_path / "out", "--format", "obj")
    assert code == 0
    outputs = {Path(line["output"]).resolve() for line in lines}
    assert outputs == set((tmp_path / "out").resolve().iterdir())
    assert len(outputs) == 5
    assert {path.name for path in tmp_path.iterdir()} == {source.name, "odd.blend", "out"}


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a disk that is full")
def test_a_full_disk_is_reported_and_the_old_file_stays(tmp_path, folder):
    out = tmp_path / "obj"
    _, [line], _ = run(folder / "off.off", "--output", out, "--format", "obj")
    old = Path(line["output"]).read_bytes()
    kinds = ("blend", "glb", "fbx", "usdc")  # Blender itself writes two of them in part without a word
    words = ["compute", str(folder / "off.off"), "--output"]
    (code, [line], complaints), *others = run_below_file_size(
        2000, [*words, str(out), "--format", "obj", "--value", "0.5"],
        *([*words, str(tmp_path / kind), "--format", kind] for kind in kinds),
    )  # fmt: skip
    assert code == 1
    assert "Traceback" not in complaints
    assert "too large" in line["error"]
    assert [path.read_bytes() for path in out.iterdir()] == [old]
    for kind, (code, [line], _) in zip(kinds, others, strict=True):
        assert code == 1, kind
        assert re.search("too large|Is the disk full", line["error"]), kind
        assert list((tmp_path / kind).iterdir()) == []


def test_a_file_that_is_still_to_be_read_is_never_overwritten(tmp_path, folder):
    out = tmp_path / "out"
    out.mkdir()
    first, second = tmp_path / "mesh.ply", out / "mesh.obj"
    first.write_bytes((folder / "ply.ply").read_bytes())
    second.write_bytes((folder / "obj.obj").read_bytes())
    other = tmp_path / "in" / "Pair.obj"
    other.parent.mkdir()
    other.write_bytes(second.read_bytes())
    target = out / "Pair.obj"
    target.hardlink_to(other)
    code, [line], _ = run(other, "--output", out, "--format", "obj")
    assert code == 1
    assert "overwrite an input" in line["error"]
    assert output_stems([tmp_path / "Bear.ply", tmp_path / "bear.obj"]) == ["Bear.ply", "bear.obj"]


def test_words_after_two_dashes_are_files(tmp_path, folder, monkeypatch):
    (tmp_path / "-odd.off").write_bytes((folder / "off.off").read_bytes())
    words = ["--output", tmp_path / "out", "--format", "obj", *QUICK, "--", "-odd.off"]
    process = started(words, cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(ROOT)})
    code, [line], _ = ended(process)
    assert (code, line["input"]) == (0, "-odd.off")


def test_names_of_objects_never_meet_those_of_other_files():
    assert separators(["cat", "cat-black", "dog"]) == ["--", "-", "-"]


def test_files_are_posed_and_matched_in_blender(folder, tmp_path):
    def told(about, *words):
        code, [line], _ = run(*words, "--output", tmp_path, about=about)
        assert code == 0, line
        return line

    line = told("pose-like", folder / "blend.blend", "--reference", folder / "off.off")
    assert line["like"]["pose"] == "OBJECT"
    bpy.ops.wm.open_mainfile(filepath=line["output"])
    obj = bpy.data.objects[line["object"]]
    assert [key.name for key in obj.data.shape_keys.key_blocks] == ["Basis", line["like"]["key"]]
    line = told("match", folder / "blend.blend", folder / "ply.ply", "--objects", obj.name)
    with np.load(line["output"]) as found:
        assert len(found["vertices"]) == line["vertices"]
        assert np.mean(found["vertices"] == np.arange(line["vertices"])) > 0.9  # the same mesh


def test_a_match_of_objects_that_are_in_neither_file_is_refused(folder, tmp_path):
    output = io.StringIO()
    words = ["match", str(folder / "off.off"), str(folder / "ply.ply"), "--objects", "Nope", "Nor this"]
    assert main([*words, "--output", str(tmp_path)], output, alone=True) == 1
    assert json.loads(output.getvalue())["error"] == "Neither file has a mesh called Nope or Nor this."
