"""Files from strangers, each a line of docs/security.md: what they could do, and do not."""

import gzip
import http.server
import json
import os
import struct
import subprocess
import sys
import threading
from pathlib import Path

import bpy
import pytest

from tests.meshes import shapes

ROOT = Path(__file__).resolve().parents[2]
QUICK = ["--max-iterations", "2", "--eigenpairs", "20", "--landmark-count", "12", "--format", "obj"]


def run(*words):
    """Run the command; its exit code, its lines, and what it complained of."""
    done = subprocess.run(
        [sys.executable, "-m", "addon", "compute", *map(str, words), *QUICK],
        capture_output=True, text=True, check=False, cwd=ROOT, timeout=120,
    )  # fmt: skip
    assert "Traceback" not in done.stderr, done.stderr
    return done.returncode, [json.loads(line) for line in done.stdout.splitlines()], done.stderr


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
    code, [line], _ = run(scripted, "--output", tmp_path / "out")
    assert code == 0
    assert not (tmp_path / "by-script").exists()
    assert not (tmp_path / "by-driver").exists()
    assert any("left off" in warning and "--trust-scripts" in warning for warning in line["warnings"])


def test_scripts_run_where_the_user_trusts_them(scripted, tmp_path):
    code, [line], _ = run(scripted, "--output", tmp_path / "out", "--trust-scripts")
    assert code == 0
    assert (tmp_path / "by-script").exists()
    assert not any("left off" in warning for warning in line["warnings"])


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
    code, lines, _ = run(*paths, sound, "--output", tmp_path / "out")
    assert code == 1
    told = {Path(line["input"]).name: line for line in lines}
    assert "error" not in told[sound.name]
    assert all(told[path.name]["error"] for path in paths)
    assert len(list((tmp_path / "out").glob("*.obj"))) == 1


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
    run(path, tmp_path / "away.obj", sound, "--output", tmp_path / "out")
    server.shutdown()
    assert asked == []


@pytest.mark.skipif(os.name != "posix", reason="needs symbolic links")
def test_a_link_among_the_results_is_replaced_and_not_followed(tmp_path, sound):
    treasure = tmp_path / "treasure"
    treasure.write_text("mine")
    out = tmp_path / "out"
    out.mkdir()
    _, [line], _ = run(sound, "--output", out)
    target = Path(line["output"])
    target.unlink()
    target.symlink_to(treasure)
    code, _, _ = run(sound, "--output", out)
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
    run(tmp_path / "curious.obj", "--output", tmp_path / "out")
    written = b"".join(path.read_bytes() for path in (tmp_path / "out").iterdir())
    assert written
    assert b"root:" not in written
    assert b"topsecretword" not in written


def test_arrays_that_are_not_what_they_seem_are_refused_by_the_plain_readers(tmp_path):
    from addon.batch.plain_files import read_plain

    for path in bombs(tmp_path):
        if path.suffix in (".off", ".ply", ".obj"):
            with pytest.raises(Exception, match=path.name) as caught:
                read_plain(path)
            assert not isinstance(caught.value, MemoryError)
