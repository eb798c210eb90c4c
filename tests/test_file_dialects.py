"""Files as other programs write them: whatever the dialect, the mesh that is meant, with Blender and without."""

import struct
import tempfile
from pathlib import Path

import bpy
import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given, settings

from addon.blender.files.plain_files import read_plain
from addon.blender.files.reading_files import open_meshes
from addon.core import InvalidMeshError

POINTS = np.array([[0.0, 0, 0], [1.5, 0, 0], [1.25, 1, 0], [0, 1, 0.5], [2, 2.75, 1]])
FACES = [[0, 1, 2], [2, 3, 0], [2, 4, 3]]
ENDS = st.sampled_from(["\n", "\r\n"])
MARKS = st.sampled_from(["utf-8", "utf-8-sig", "utf-16"])


def numbers(points, comma=False):
    lines = [" ".join(f"{value:.6f}" for value in point) for point in points]
    return [line.replace(".", ",") for line in lines] if comma else lines


@st.composite
def off_files(draw):
    """An .off file in some dialect."""
    counts = draw(st.sampled_from(["5 3 0", "5 3", "5\n3\n0"]))
    head = draw(st.sampled_from(["OFF\n", "off\n", "OFF ", "OFF", "# made\nOFF\n", "\nOFF # made\n", ""]))
    lines = numbers(POINTS)
    faces = ["3 " + " ".join(map(str, each)) for each in FACES]
    if head in ("OFF", "") or counts != "5 3 0":
        head, counts = (head, "5 3 0") if head in ("OFF", "") else ("OFF\n", counts)
    elif head.strip().endswith("OFF") and draw(st.booleans()):
        head = draw(st.sampled_from(["COFF\n", "NOFF\n", "STOFF\n"]))
        lines = [line + " 0.5 0.5 0.5" for line in lines]
        faces = [line + " 10 20 30" for line in faces]
    elif draw(st.booleans()):
        lines, faces = [" ".join(lines)], [" ".join(faces)]
    text = f"{head}{counts}\n" + "\n".join([*lines, draw(st.sampled_from(["", "# faces"])), *faces]) + "\n"
    return ".off", text.replace("\n", draw(st.sampled_from(["\n", "\r\n", "\r"]))).encode(draw(MARKS))


@st.composite
def obj_files(draw):
    """An .obj file in some dialect."""
    base = draw(st.sampled_from([0, 1, -len(POINTS)]))
    end = draw(st.sampled_from(["", "  ", " # note"]))
    tail = draw(st.sampled_from(["", "/", "//"])) if base == 1 else ""
    lines = draw(st.sampled_from([[], ["# made"], ["o Thing"]]))
    lines = lines + ["v " + line + end for line in numbers(POINTS, draw(st.booleans()))]
    lines += ["f " + " ".join(f"{corner + base}{tail}" for corner in each) + end for each in FACES]
    return ".obj", (draw(ENDS).join(lines) + "\n").encode(draw(MARKS))


@st.composite
def ply_files(draw):
    """A .ply file in some dialect."""
    comment = draw(st.sampled_from([b"", "comment Jürgen\n".encode("latin-1"), "comment 三\n".encode()]))
    head = b"element vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
    order = draw(st.sampled_from(["ascii", "<", ">"]))
    if order == "ascii":
        body = "\n".join([*numbers(POINTS), *("3 " + " ".join(map(str, each)) for each in FACES)]).encode() + b"\n"
        head += b"element face 3\nproperty list uchar int vertex_indices\nend_header\n"
        whole = b"ply\nformat ascii 1.0\n" + comment + head + body
        return ".ply", whole.replace(b"\n", draw(st.sampled_from([b"\n", b"\r\n", b"\r"])))
    body = b"".join(struct.pack(f"{order}3f", *point) for point in POINTS)
    if draw(st.booleans()):
        strip = [corner for face in FACES for corner in (*face, -1)]
        head += b"element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
        body += struct.pack(f"{order}i{len(strip)}i", len(strip), *strip)
    else:
        head += b"element face 3\nproperty list uchar uint vertex_index\nend_header\n"
        body += b"".join(struct.pack(f"{order}B3I", 3, *face) for face in FACES)
    name = b"little" if order == "<" else b"big"
    return ".ply", b"ply\nformat binary_" + name + b"_endian 1.0\n" + comment + head + body


@st.composite
def stl_files(draw):
    """A binary .stl file, which may begin as a text one does, or go on after its triangles."""
    body = b"".join(struct.pack("<12fH", 0, 0, 0, *POINTS[face].ravel(), 0) for face in np.array(FACES))
    head = draw(st.sampled_from([b"", b"solid made by"])).ljust(80, b" ") + struct.pack("<I", len(FACES))
    return ".stl", head + body + draw(st.sampled_from([b"", b"more", b"\0" * 60]))


def places(points, faces):
    """The triangles as sorted places, whatever the numbers of the vertices."""
    return sorted(sorted(tuple(np.round(points[corner], 4) + 0.0) for corner in face) for face in faces)


@settings(deadline=None, max_examples=120)
@given(st.one_of(off_files(), obj_files(), ply_files(), stl_files()))
def test_what_is_meant_is_read_with_blender_and_without(file):
    kind, data = file
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"mesh{kind}"
        path.write_bytes(data)
        if kind != ".stl":
            mesh = read_plain(path)
            assert places(mesh.vertices, mesh.polygons) == places(POINTS, FACES)
        (obj,) = open_meshes(path)
        points = np.array([vertex.co[:] for vertex in obj.data.vertices])
        assert places(points, [list(each.vertices) for each in obj.data.polygons]) == places(POINTS, FACES)


@pytest.mark.parametrize(
    ("name", "data", "words"),
    [
        ("a.obj", "v 1 2 3\nvt 0 0\nf 1/1 1/1 1/1\n".encode("utf-16"), "encoded as UTF-16"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 0/0 1/0 2/0\n", "counts its vertices from 0"),
        ("a.obj", b"v 0,0 0,0 0,0\nv 1,0 0,0 0,0\nv 0,0 1,5 0,0\nvt 0 0\nf 1/1 2/1 3/1\n", "decimal commas"),
        ("a.off", b"4OFF\n1 1 0\n", "a kind that is not read"),
        ("a.off", b"OFF BINARY\n\0\0", "a kind that is not read"),
        ("a.off", b"OFF\n3 1 0\n0 0 0 1 1 1\n", "cut short"),
        ("a.off", b"hello\n", "does not start with OFF"),
    ],
)
def test_what_cannot_be_read_right_is_refused_by_name(name, data, words, tmp_path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    (tmp_path / name).write_bytes(data)
    with pytest.raises(InvalidMeshError, match=words) as refused:
        open_meshes(tmp_path / name)
    assert name in str(refused.value)
