"""Meshes in and out without Blender."""

import struct
from pathlib import Path

import numpy as np
import pytest

from addon.batch import opening
from addon.batch.lines import FileCount, stage_line
from addon.blender.files.kinds_of_files import PLAIN
from addon.blender.files.plain_files import read_plain, write_plain
from addon.blender.files.polygon_mesh import PolygonMesh, fans
from addon.core import InvalidMeshError, Settings, pose_like
from tests import commands
from tests.meshes import shapes

POINTS = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 2, 1]])
POLYGONS = [[0, 1, 2, 3], [2, 4, 3]]


@pytest.mark.parametrize("kind", PLAIN)
def test_what_is_written_is_read_again(kind, tmp_path):
    path = tmp_path / f"mesh{kind}"
    write_plain(path, PolygonMesh(POINTS / 3, POLYGONS))
    points, polygons = read_plain(path)[:2]
    np.testing.assert_allclose(points, POINTS / 3, atol=1e-9)
    assert polygons == POLYGONS
    assert [each.name for each in tmp_path.iterdir()] == [path.name]


@pytest.mark.parametrize(("name", "order"), [("binary_little_endian", "<"), ("binary_big_endian", ">")])
def test_binary_ply_with_more_properties_is_read(name, order, tmp_path):
    header = f"ply\nformat {name} 1.0\ncomment made\nelement vertex 5\nproperty float x\nproperty float y\n"
    header += (
        "property float z\nproperty uchar red\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
    )
    body = b"".join(struct.pack(f"{order}fffB", *point, 7) for point in POINTS)
    body += b"".join(struct.pack(f"{order}B{len(each)}i", len(each), *each) for each in POLYGONS)
    (tmp_path / "mesh.ply").write_bytes(header.encode() + body)
    points, polygons = read_plain(tmp_path / "mesh.ply")[:2]
    np.testing.assert_array_equal(points, POINTS)
    assert polygons == POLYGONS


def test_obj_with_normals_uvs_and_negative_numbers_is_read(tmp_path):
    lines = [f"v {x} {y} {z}" for x, y, z in POINTS] + ["vt 0 0", "vn 0 0 1", "f 1/1/1 2/1/1 3//1 4", "f -3 -1 -2"]
    (tmp_path / "mesh.obj").write_text("\n".join(lines))
    assert read_plain(tmp_path / "mesh.obj").polygons == [[0, 1, 2, 3], [2, 4, 3]]


def test_polygons_are_cut_into_triangles():
    assert fans(POLYGONS).tolist() == [[0, 1, 2], [0, 2, 3], [2, 4, 3]]
    assert fans([]).shape == (0, 3)


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("a.stl", "solid", "only be read by Blender"),
        ("a.obj", "v 1 x 2\nf 1 1 1", "damaged"),
        ("a.obj", "v 1 2 3\nf 1 2 9", "not there"),
        ("a.obj", "v 1 2 3", "no mesh with faces"),
        ("a.obj", "v 1 2 3\nf", "no mesh with faces"),
        ("a.ply", "ply\nformat ascii 1.0\nelement vertex 9\nproperty float x\nend_header\n1 2", "damaged"),
        ("a.ply", "nothing", "damaged"),
        ("a.ply", "ply\nend_header\n", "damaged"),
        ("nowhere.obj", None, "is not a file"),
    ],
)
def test_damaged_files_are_told_in_a_sentence(name, text, words, tmp_path):
    if text is not None:
        (tmp_path / name).write_text(text)
    with pytest.raises(InvalidMeshError, match=words):
        read_plain(tmp_path / name)


def run(*words, about="compute"):
    return commands.run(*words, about=about)[:2]


def test_the_command_works_without_blender(tmp_path, monkeypatch):
    monkeypatch.setattr(opening, "has_blender", lambda: False)
    vertices, faces = shapes.figure(14)
    for kind in ("off", "obj", "ply"):
        write_plain(tmp_path / f"{kind}.{kind}", PolygonMesh(vertices, faces.tolist()))
    code, lines = run(tmp_path, "--output", tmp_path / "out", "--format", "off", "--reference", "first")
    assert code == 0
    forms = [read_plain(tmp_path / "out" / f"{kind}.off").vertices for kind in ("obj", "off", "ply")]
    for form in forms[1:]:
        np.testing.assert_allclose(form, forms[0], atol=1e-5)
    assert {line["vertices"] for line in lines} == {len(vertices)}
    code, [turned, *_] = run(tmp_path / "obj.obj", "--output", tmp_path / "turned", "--format", "off", "--axes", "Y,Z")
    code, [plain, *_] = run(tmp_path / "obj.obj", "--output", tmp_path / "plain", "--format", "off")
    one, two = (read_plain(tmp_path / name / "obj.off").vertices for name in ("turned", "plain"))
    np.testing.assert_allclose(one[:, 1], two[:, 2], atol=1e-6)  # Z is up in the scene, Y in the file
    np.testing.assert_allclose(one[:, 2], -two[:, 1], atol=1e-6)
    assert turned["feature_points"] == plain["feature_points"]


@pytest.fixture
def two_files(tmp_path, monkeypatch):
    """A figure, and the same with other triangles, turned."""
    monkeypatch.setattr(opening, "has_blender", lambda: False)
    vertices, faces = shapes.figure(12)
    write_plain(tmp_path / "here.ply", PolygonMesh(vertices, faces.tolist()))
    others, other_faces = shapes.figure(13)
    write_plain(tmp_path / "there.off", PolygonMesh(others[:, [1, 2, 0]], other_faces.tolist()))
    return tmp_path / "here.ply", tmp_path / "there.off"


def test_a_mesh_is_posed_like_another_without_blender(two_files, tmp_path):
    here, there = two_files
    words = (here, "--reference", there, "--output", tmp_path / "out", "--format", "obj")
    code, [line] = run(*words, about="pose-like")
    assert code == 0
    posed, polygons = read_plain(tmp_path / "out" / "here.obj")[:2]
    (vertices, faces), (others, other_faces) = (read_plain(path)[:2] for path in two_files)
    settings = Settings(max_iterations=2, landmark_count=12)
    found = pose_like(vertices, np.array(faces), others, np.array(other_faces), settings)
    np.testing.assert_allclose(posed[:, [0, 2, 1]] * [1, -1, 1], found.vertices, atol=1e-5)  # Y is up in .obj
    assert polygons == faces
    assert line["like"]["name"] == "there"
    assert line["like"]["sides"] == found.match.sides
    assert "stress" not in line


def test_another_side_is_taken_where_it_is_asked_for(two_files, tmp_path):
    here, there = two_files
    words = (here, "--reference", there, "--output", tmp_path / "out", "--format", "obj", "--side")
    code, [line] = run(*words, "1", about="pose-like")
    assert (code, line["like"]["side"]) == (0, 1)
    code, [line] = run(*words, "50", about="pose-like")
    assert code == 1
    assert "ways to match" in line["error"]


def test_two_files_are_matched_without_blender(two_files, tmp_path):
    here, there = two_files
    code, [line] = run(here, there, "--output", tmp_path / "out", about="match")
    assert code == 0
    assert Path(line["output"]) == tmp_path / "out" / "here-there.npz"
    with np.load(line["output"]) as found:
        count = len(read_plain(here).vertices)
        assert found["vertices"].shape == found["confidence"].shape == (count,)
        assert found["corners"].shape == found["weights"].shape == (count, 3)
        np.testing.assert_allclose(found["weights"].sum(axis=1), 1.0)
        assert 0 <= found["corners"].min() <= found["corners"].max() < len(read_plain(there).vertices)
        assert len(found["sides"]) == len(line["sides"])
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["here-there.npz"]


def test_a_match_with_a_broken_file_is_told(two_files, tmp_path):
    here, _ = two_files
    (tmp_path / "broken.off").write_text("OFF\n1")
    code, [line] = run(here, tmp_path / "broken.off", "--output", tmp_path / "out", about="match")
    assert code == 1
    assert "broken.off" in line["error"]
    assert list((tmp_path / "out").iterdir()) == []


@pytest.mark.parametrize("words", [[], ["--pose", "x"], ["--pose", "t", "--reference", "a.off"]])
def test_whose_pose_it_is_must_be_said(words, two_files, tmp_path):
    assert run(two_files[0], "--output", tmp_path / "out", *words, about="pose-like") == (2, [])


@pytest.mark.parametrize("words", [["--format", "blend"], ["--format", "obj", "--frames", "1:3"]])
def test_what_needs_blender_is_told(words, tmp_path, monkeypatch):
    monkeypatch.setattr(opening, "has_blender", lambda: False)
    shapes.write_off(tmp_path / "figure.off", *shapes.figure(12))
    code, [line] = run(tmp_path / "figure.off", "--output", tmp_path / "out", *words)
    assert code == 1
    assert "needs Blender as a module" in line["error"]
    assert list((tmp_path / "out").iterdir()) == []


def test_progress_tells_which_file_it_is_and_how_long_the_rest_takes():
    clock = iter([0.0, 6.0, 600.0])
    count = FileCount(3, lambda: next(clock))
    assert count.text() == "file 1 of 3"
    count.done()
    assert count.text() == "file 2 of 3 · 12 s left"
    count.done()
    assert count.text() == "file 3 of 3 · 5 min left"


def test_a_stage_is_shown_where_it_is_wanted_and_wiped_away(capsys):
    with stage_line("mesh", True) as show:
        show(0.5, "Spectrum")
    with stage_line("mesh", False) as show:
        assert show is None
    told = capsys.readouterr().err
    assert "mesh:  50 % Spectrum" in told
    assert told.endswith("\r\x1b[K")


def test_two_files_of_one_name_can_be_matched(two_files, tmp_path):
    here, _ = two_files
    other = tmp_path / f"{here.stem}.ply"
    write_plain(other, read_plain(here))
    one = tmp_path / here.name
    one.write_bytes(here.read_bytes())
    code, [line] = run(one, other, "--output", tmp_path / "out", about="match")
    assert (code, Path(line["output"]).name) == (0, f"{here.stem}-{here.stem}.npz")


def test_colours_of_any_range_and_a_body_that_begins_with_a_line_feed(tmp_path):
    head = (
        "ply\rformat binary_little_endian 1.0\relement vertex 3\rproperty float x\rproperty float y\rproperty float z\r"
    )
    head += "property ushort red\rproperty ushort green\rproperty ushort blue\relement face 1\r"
    head += "property list uchar int vertex_indices\rend_header\r"
    first = struct.unpack("<f", b"\n\0\0\x3f")[0]
    rows = [(first, 0, 0), (1, 0, 0), (0, 1, 0)]
    body = b"".join(struct.pack("<3f3H", *row, 65535, 0, 0) for row in rows) + struct.pack("<B3i", 3, 0, 1, 2)
    (tmp_path / "a.ply").write_bytes(head.encode() + body)
    mesh = read_plain(tmp_path / "a.ply")
    np.testing.assert_allclose(mesh.vertices, rows)
    assert mesh.colours is not None
    np.testing.assert_allclose(mesh.colours[0], [1, 0, 0, 1])
    (tmp_path / "a.obj").write_text("v 0 0 0 255 0 0\nv 1 0 0 0 255 0\nv 0 1 0 0 0 255\nf 1 2 3\n")
    colours = read_plain(tmp_path / "a.obj").colours
    assert colours is not None
    np.testing.assert_allclose(colours[:, :3], np.eye(3))
