"""Files from strangers, each a line of docs/security.md: what they could do, and do not."""

import gzip
import http.server
import json
import os
import struct
import subprocess
import sys
import threading
from contextlib import suppress
from pathlib import Path

import bpy
import numpy as np
import pytest

from addon.batch.lines import complain
from addon.blender.files.replacing_files import replaced
from tests.commands import ROOT, run, run_apart
from tests.meshes import shapes

pytestmark = pytest.mark.usefixtures("computed_once")

OBJ = ("--format", "obj")


@pytest.fixture
def sound(tmp_path):
    """A file that is as it should be."""
    path = tmp_path / "sound.off"
    shapes.write_off(path, *shapes.figure(12))
    return path


@pytest.fixture
def scripted(tmp_path):
    """A .blend whose script and whose driver write a file each."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    vertices, faces = shapes.figure(12)
    mesh = bpy.data.meshes.new("Figure")
    mesh.from_pydata(vertices.tolist(), [], faces.tolist())
    obj = bpy.data.objects.new("Figure", mesh)
    bpy.context.scene.collection.objects.link(obj)
    text = bpy.data.texts.new("script.py")
    text.write(f"open({str(tmp_path / 'by-script')!r}, 'w')")
    text.use_module = True
    driver = obj.driver_add("location", 0).driver
    driver.expression = f"0.0 if open({str(tmp_path / 'by-driver')!r}, 'w') else 1.0"
    path = tmp_path / "scripted.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    for name in ("by-script", "by-driver"):
        (tmp_path / name).unlink(missing_ok=True)
    return path


def test_scripts_in_a_file_do_not_run_and_that_is_told(scripted, tmp_path):
    code, [line], _ = run_apart(scripted, "--output", tmp_path / "out", *OBJ)
    assert code == 0
    assert not (tmp_path / "by-script").exists()
    assert not (tmp_path / "by-driver").exists()
    assert any("left off" in warning and "--trust-scripts" in warning for warning in line["warnings"])


def test_scripts_run_where_the_user_trusts_them(scripted, tmp_path):
    code, [line], _ = run_apart(scripted, "--output", tmp_path / "out", *OBJ, "--trust-scripts")
    assert code == 0
    assert (tmp_path / "by-script").exists()
    assert (tmp_path / "by-driver").exists()
    assert not any("left off" in warning for warning in line["warnings"])


def test_only_files_with_scripts_are_told_to_have_them(scripted, sound, tmp_path):
    """Blender keeps the flag of the last .blend while it imports others."""
    _, lines, _ = run_apart(scripted, sound, "--output", tmp_path / "out", *OBJ)
    told = {Path(line["input"]): any("left off" in warning for warning in line["warnings"]) for line in lines}
    assert told == {scripted: True, sound: False}


@pytest.mark.parametrize("command", ["compute", "pose-like", "match"])
@pytest.mark.parametrize("trusted", [False, True])
def test_the_file_of_a_reference_is_trusted_as_all_others(scripted, sound, tmp_path, command, trusted):
    files = (sound, scripted) if command == "match" else (sound, "--reference", scripted)
    trust = ("--trust-scripts",) if trusted else ()
    code, [line], complaints = run(*files, *trust, "--output", tmp_path / "out", about=command)
    assert code == 0, line
    assert (tmp_path / "by-script").exists() == trusted
    assert ("scripted.blend: Scripts or Python drivers" in complaints) != trusted


def glb(path, described):
    """Write a .glb of a description alone."""
    text = json.dumps({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}], **described})
    data = text.encode() + b" " * (-len(text) % 4)
    path.write_bytes(struct.pack("<4sIIII", b"glTF", 2, 20 + len(data), len(data), 0x4E4F534A) + data)
    return path


def primitive(**more):
    return {"meshes": [{"primitives": [{"attributes": {"POSITION": 0}, **more}]}]}


def bombs(folder):
    """Small files that ask for much."""
    accessor = {"componentType": 5126, "count": 4_000_000_000_000, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1]}
    yield glb(folder / "accessor.glb", {**primitive(), "accessors": [accessor]})
    for kind, text in {
        "off": "OFF\n4000000000000 4000000000000 0\n0 0 0\n",
        "ply": "ply\nformat ascii 1.0\nelement vertex 4000000000000\nproperty float x\nproperty float y\n"
        "property float z\nelement face 4000000000000\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n",
        "obj": "v 0 0 0\nf 4000000000000 1 2\nf -4000000000000 1 1\n",
    }.items():
        (folder / f"count-{kind}.{kind}").write_text(text)
        yield folder / f"count-{kind}.{kind}"
    header = b"\0" * 80 + struct.pack("<I", 4_294_967_295)
    (folder / "count-stl.stl").write_bytes(header + b"\0" * 50)
    yield folder / "count-stl.stl"
    (folder / "zeros.blend").write_bytes(gzip.compress(b"BLENDER-v402" + b"\0" * 300_000_000))
    yield folder / "zeros.blend"
    (folder / "nested.usda").write_text("#usda 1.0\n" + 'def Xform "a" {\n' * 20_000)
    yield folder / "nested.usda"


def test_small_files_that_ask_for_much_cost_their_own_line_alone(sound, tmp_path):
    (tmp_path / "bombs").mkdir()
    paths = list(bombs(tmp_path / "bombs"))
    code, lines, _ = run_apart(*paths, sound, "--output", tmp_path / "out", *OBJ)
    assert code == 1
    told = {Path(line["input"]).name: line for line in lines}
    assert "error" not in told[sound.name]
    assert all(told[path.name]["error"] for path in paths)
    assert len(list((tmp_path / "out").glob("*.obj"))) == 1


def damaged(path, part, value):
    """A .blend of a mesh in which one number is wrong, and a whole one."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    mesh, whole = (bpy.data.meshes.new(name) for name in ("Damaged", "Whole"))
    for each in (mesh, whole):
        vertices, faces = shapes.figure(12)
        each.from_pydata(vertices.tolist(), [], faces.tolist())
        bpy.context.scene.collection.objects.link(bpy.data.objects.new(each.name, each))
    setattr((mesh.polygons if part == "loop_start" else mesh.loops)[7], part, value)
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    return path


def test_faces_of_what_does_not_exist_are_refused_before_blender_follows_them(tmp_path, sound):
    wrong = {"loop_start": -25085, "vertex_index": 2**30, "edge_index": -1}
    paths = [damaged(tmp_path / f"{part}.blend", part, value) for part, value in wrong.items()]
    code, lines, _ = run_apart(*paths, sound, "--output", tmp_path / "out", *OBJ)
    assert code == 1
    for line in lines[:-1]:
        assert "Damaged: the mesh is damaged" in line["error"]
    assert "error" not in lines[-1]
    for path in paths:
        code, lines, complaints = run_apart(sound, "--reference", path, "--output", tmp_path / "out", *OBJ)
        assert code != 0
        assert not lines
        assert "Damaged: the mesh is damaged" in complaints
    code, lines, _ = run_apart(*paths, "--objects", "Whole", "--output", tmp_path / "out", *OBJ)
    assert (code, len(lines)) == (0, len(paths))


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux keeps a process below a limit of its data")
def test_a_worker_is_refused_more_memory_than_there_is():
    steps = "from addon.scheduling.attempts import keep_below; import numpy as np; keep_below(1.0)\n"
    steps += "np.ones(10**7)\ntry:\n    np.ones(10**9)\nexcept MemoryError:\n    print('REFUSED')"
    done = subprocess.run([sys.executable, "-c", steps], capture_output=True, text=True, check=False, cwd=ROOT)
    assert done.stdout.strip() == "REFUSED", done.stderr


def test_no_address_in_a_file_is_asked(tmp_path, sound):
    asked: list[str] = []

    class Listening(http.server.BaseHTTPRequestHandler):
        def do_GET(self):
            asked.append(self.path)
            self.send_error(404)

        def log_message(self, *words):
            pass

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Listening)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    address = f"http://127.0.0.1:{server.server_port}/away"
    accessor = {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1]}
    path = glb(tmp_path / "away.glb", {
        **primitive(material=0), "accessors": [accessor], "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36, "uri": f"{address}.bin"}], "images": [{"uri": f"{address}.png"}],
        "textures": [{"source": 0}], "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
    })  # fmt: skip
    (tmp_path / "away.mtl").write_text(f"newmtl a\nmap_Kd {address}.jpg\n")
    vertices, faces = shapes.figure(12)
    lines = ["mtllib away.mtl", f"mtllib {address}.mtl", "usemtl a"]
    lines += [f"v {x} {y} {z}" for x, y, z in vertices] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]
    (tmp_path / "away.obj").write_text("\n".join(lines))
    run(path, tmp_path / "away.obj", sound, "--output", tmp_path / "out", *OBJ)
    server.shutdown()
    assert asked == []


@pytest.mark.skipif(os.name != "posix", reason="needs symbolic links")
def test_a_link_among_the_results_is_replaced_and_not_followed(tmp_path, sound):
    treasure = tmp_path / "treasure"
    treasure.write_text("mine")
    out = tmp_path / "out"
    out.mkdir()
    _, [line], _ = run(sound, "--output", out, *OBJ)
    target = Path(line["output"])
    target.unlink()
    target.symlink_to(treasure)
    code, _, _ = run(sound, "--output", out, *OBJ)
    assert treasure.read_text() == "mine"
    assert code == 0
    assert not target.is_symlink()


def test_what_is_written_holds_nothing_of_other_files(tmp_path, sound):
    """An .obj may name any file as its materials; the result does not carry it away."""
    (tmp_path / "secret.mtl").write_text("newmtl topsecretword\nKd 1 0 0\n")
    vertices, faces = shapes.figure(12)
    lines = ["mtllib ../../../../../../../../etc/passwd", "mtllib secret.mtl"]
    lines += [f"v {x} {y} {z}" for x, y, z in vertices] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]
    (tmp_path / "curious.obj").write_text("\n".join(lines))
    run(tmp_path / "curious.obj", "--output", tmp_path / "out", *OBJ)
    written = b"".join(path.read_bytes() for path in (tmp_path / "out").iterdir())
    assert written
    assert b"root:" not in written
    assert b"topsecretword" not in written


def png(path, colour):
    """Write a picture of one colour."""
    image = bpy.data.images.new("made", 8, 8)
    image.pixels.foreach_set(np.tile(np.array([*colour, 1], dtype=np.float32), 64))
    image.filepath_raw, image.file_format = str(path), "PNG"
    image.save()
    bpy.data.images.remove(image)
    return path


def textured(path, picture):
    """Write an .obj whose material names a picture."""
    path.parent.mkdir(exist_ok=True)
    path.with_suffix(".mtl").write_text(f"newmtl skin\nKd 1 1 1\nmap_Kd {picture}\n")
    vertices, faces = shapes.figure(12)
    lines = [f"mtllib {path.stem}.mtl", *(f"v {x} {y} {z}" for x, y, z in vertices), "vt 0 0", "usemtl skin"]
    path.write_text("\n".join([*lines, *(f"f {a + 1}/1 {b + 1}/1 {c + 1}/1" for a, b, c in faces)]))
    return path


def test_pictures_from_elsewhere_stay_out(tmp_path, blender):
    """A picture beside the file comes along in a .glb; one from elsewhere only where the user trusts the file."""
    (tmp_path / "private").mkdir()
    secret = png(tmp_path / "private" / "passport.png", (1, 0, 0))
    curious = textured(tmp_path / "theirs" / "curious.obj", secret)
    own = textured(tmp_path / "theirs" / "own.obj", png(tmp_path / "theirs" / "skin.png", (0, 1, 0)).name)
    _, lines, _ = run(curious, own, "--output", tmp_path / "out", "--format", "glb")
    told = {Path(line["input"]): any("passport.png" in warning for warning in line["warnings"]) for line in lines}
    assert told == {curious: True, own: False}
    held = {path.stem: b"\x89PNG" in path.read_bytes() for path in (tmp_path / "out").glob("*.glb")}
    assert held == {"curious": False, "own": True}
    _, [line], _ = run(curious, "--output", tmp_path / "trusted", "--format", "glb", "--trust-scripts")
    assert b"\x89PNG" in Path(line["output"]).read_bytes()


def test_no_pictures_are_copied_beside_usd(tmp_path, blender):
    """Those of two files may have one name, and a link that lies there would be followed."""
    own = textured(tmp_path / "theirs" / "own.obj", png(tmp_path / "theirs" / "skin.png", (0, 1, 0)).name)
    _, [line], _ = run(own, "--output", tmp_path / "out", "--format", "usdc")
    assert [path.name for path in (tmp_path / "out").iterdir()] == [Path(line["output"]).name]


def test_files_from_elsewhere_are_not_read_as_numbers(tmp_path, sound):
    (tmp_path / "theirs").mkdir()
    vertices, faces = shapes.figure(12)
    arrays = np.float32(vertices).tobytes() + np.uint32(faces).tobytes()
    (tmp_path / "own.bin").write_bytes(arrays)
    size = 12 * len(vertices)
    described = {
        "asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "scene": 0, "nodes": [{"mesh": 0}],
        **primitive(indices=1), "buffers": [{"byteLength": len(arrays), "uri": "%2e%2e/own.bin"}],
        "bufferViews": [{"buffer": 0, "byteLength": size},
                        {"buffer": 0, "byteOffset": size, "byteLength": len(arrays) - size}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(vertices), "type": "VEC3",
                       "min": vertices.min(axis=0).tolist(), "max": vertices.max(axis=0).tolist()},
                      {"bufferView": 1, "componentType": 5125, "count": faces.size, "type": "SCALAR"}],
    }  # fmt: skip
    path = tmp_path / "theirs" / "curious.gltf"
    path.write_text(json.dumps(described))
    code, lines, _ = run(path, sound, "--output", tmp_path / "out", *OBJ)
    assert code == 1
    assert "outside its folder" in lines[0]["error"]
    code, [line], _ = run(path, "--output", tmp_path / "out", *OBJ, "--trust-scripts")
    assert code == 0, line


def test_saving_takes_in_no_other_file(tmp_path, blender):
    """A .blend may ask to be saved with every file that it names."""
    secret = png(tmp_path / "passport.png", (1, 0, 0))
    mesh = bpy.data.meshes.new("Figure")
    vertices, faces = shapes.figure(12)
    mesh.from_pydata(vertices.tolist(), [], faces.tolist())
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Figure", mesh))
    picture = bpy.data.images.load(str(secret))
    picture.use_fake_user, picture.filepath = True, str(tmp_path / "later.png")
    bpy.data.use_autopack = True
    (tmp_path / "theirs").mkdir()
    path = tmp_path / "theirs" / "packing.blend"
    with suppress(RuntimeError):  # there is nothing to pack yet
        bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    bpy.data.use_autopack = False
    secret.rename(tmp_path / "later.png")
    _, [line], _ = run(path, "--output", tmp_path / "out", "--format", "blend")
    bpy.ops.wm.open_mainfile(filepath=line["output"])
    assert [image.packed_file for image in bpy.data.images if image.filepath] == [None]


def test_materials_that_were_read_are_not_written_over(tmp_path):
    folder = tmp_path / "sub"
    path = textured(folder / "figure.obj", "skin.png")
    path.write_text(path.read_text().replace("mtllib figure.mtl", "mtllib ../figure.mtl"))
    precious = tmp_path / "figure.mtl"
    (folder / "figure.mtl").rename(precious)
    before = precious.read_text()
    for _ in range(2):
        _, [line], _ = run(path, "--output", tmp_path, *OBJ)
        assert precious.read_text() == before
        assert "mtllib figure-2.mtl" in Path(line["output"]).read_text()
    assert not (tmp_path / "figure-3.mtl").exists()


@pytest.mark.skipif(os.name != "posix", reason="needs symbolic links")
def test_a_link_at_the_place_of_an_unfinished_file_is_not_followed(tmp_path):
    treasure = tmp_path / "treasure"
    treasure.write_text("mine")
    (tmp_path / ".a.mark.partial.obj").symlink_to(treasure)
    replaced(tmp_path / "a.obj", lambda partial: partial.write_text("ours"), "mark")
    assert treasure.read_text() == "mine"
    assert (tmp_path / "a.obj").read_text() == "ours"


def test_names_do_not_command_the_terminal(capsys):
    complain("A\x1b]0;title\x07\x1b[2J\rfake\nline\u202eleg: no.")
    assert capsys.readouterr().err == "canonical_form: A?]0;title??[2J?fake line?leg: no.\n"


def test_arrays_that_are_not_what_they_seem_are_refused_by_the_plain_readers(tmp_path):
    from addon.blender.files.plain_files import read_plain

    head = "ply\nformat {} 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face "
    lists, points = "property list char int vertex_indices\nend_header\n", "0 0 0 1 0 0 0 1 0\n"
    odd = {
        "bare": head.format("ascii") + "4000000000000\nend_header\n" + points,
        "negative": head.format("ascii") + "1\n" + lists + points + "-3 0 1 2\n",
        "infinite": head.format("ascii") + "1\n" + lists + points + "3 0 inf 2\n",
        "single": head.format("ascii") + "1\nproperty int vertex_indices\nend_header\n" + points + "3\n",
        "many": head.format("binary_little_endian") + "4000000000000\n" + lists + "\0" * 36 + "\x7f" * 1000,
    }
    for name, text in odd.items():
        (tmp_path / f"{name}.ply").write_bytes(text.encode())
    for path in (*bombs(tmp_path), *(tmp_path / f"{name}.ply" for name in odd)):
        if path.suffix in (".off", ".ply", ".obj"):
            with pytest.raises(Exception, match=path.name) as caught:
                read_plain(path)
            assert not isinstance(caught.value, MemoryError)
