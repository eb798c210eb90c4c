import os
import time
from contextlib import closing
from threading import Timer

import numpy as np
import pytest

from addon.core import InvalidMeshError, InvalidSettingsError, Settings
from addon.evaluation import reading
from addon.evaluation.command import _words
from addon.evaluation.dataset import shapes_in
from addon.evaluation.methods import DEFAULT, chosen_methods
from tests.meshes import shapes
from tests.meshes.shapes import write_off


def touched(folder, *names):
    for name in names:
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()


def test_a_folder_is_a_class(tmp_path):
    touched(tmp_path, "dog/a.off", "dog/b.OBJ", "cat/a.ply", "cat/notes.txt", ".git/x.off", "cat/a b.off")
    found = shapes_in(tmp_path)
    assert [(shape.label, shape.name, shape.path.name) for shape in found] == [
        ("cat", "a_b", "a b.off"), ("cat", "a", "a.ply"), ("dog", "a", "a.off"), ("dog", "b", "b.OBJ"),
    ]  # fmt: skip


def test_files_of_one_name_keep_their_endings_in_the_tables(tmp_path):
    touched(tmp_path, "dog/a.off", "dog/a.ply")
    assert [shape.name for shape in shapes_in(tmp_path)] == ["a", "a.ply"]


def test_shrec_puts_meshes_side_by_side_and_classes_in_a_file(tmp_path):
    touched(tmp_path, "T0.off", "T1.off", "T2.off", "T10.off", "T11.off")
    classes = tmp_path / "test.cla"
    classes.write_text("PSB 1\n2 4\n\nman 0 2\n0\n10\n\nhorse 0 2\n1\n2\n")
    found = shapes_in(tmp_path)
    assert [(shape.label, shape.name) for shape in found] == [
        ("horse", "T1"), ("horse", "T2"), ("man", "T0"), ("man", "T10"),
    ]  # fmt: skip
    listed = tmp_path / "list.csv"
    listed.write_text("file,class\nT0.off,man\nT11,horse\n")
    assert [(shape.label, shape.name) for shape in shapes_in(tmp_path, listed)] == [("horse", "T11"), ("man", "T0")]


@pytest.mark.parametrize(
    ("text", "message"),
    [("PSB 1\n1 2\nman 0 2\n0\n7\n", "names 1 shapes that are not there, the first with number 7"),
     ("PSB 1\n2 4\nman 0 3\n0\n", "well-formed"), ("T0.off,a b\nT1.off,a_b\n", "the same name in the tables"),
     ("x" * 200_000, "neither a .cla file"), ("T9.off,man\n", "does not name a mesh")],
)  # fmt: skip
def test_a_file_of_classes_that_does_not_fit_is_refused(tmp_path, text, message):
    touched(tmp_path, "T0.off", "T1.off")
    (tmp_path / "test.cla").write_text(text)
    with pytest.raises(InvalidMeshError, match=message):
        shapes_in(tmp_path)


def test_what_is_no_dataset_is_refused(tmp_path):
    with pytest.raises(InvalidMeshError, match="is not a folder"):
        shapes_in(tmp_path / "none")
    with pytest.raises(InvalidMeshError, match="holds no mesh"):
        shapes_in(tmp_path)
    touched(tmp_path, "a.off")
    with pytest.raises(InvalidMeshError, match="--classes"):
        shapes_in(tmp_path)


def test_meshes_are_read_as_they_are(tmp_path):
    vertices, faces = shapes.sphere(1)
    write_off(tmp_path / "a.off", vertices, faces)
    lines = [f"v {x} {y} {z}" for x, y, z in vertices] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]
    (tmp_path / "a.obj").write_text("\n".join(lines))
    (tmp_path / "two.obj").write_text(
        "\n".join(["o one", *lines, "o two", "v 0 0 9", "v 1 0 9", "v 0 1 9", "f -1 -2 -3"])
    )
    with closing(reading.Reader()) as reader:
        read, read_faces = reader.triangles(tmp_path / "a.off")
        np.testing.assert_allclose(read, vertices, atol=1e-8)
        np.testing.assert_array_equal(read_faces, faces)
        read, read_faces = reader.triangles(tmp_path / "a.obj")
        assert read.shape == vertices.shape
        assert read_faces.shape == faces.shape
        with pytest.raises(InvalidMeshError, match="holds 2 meshes"):
            reader.triangles(tmp_path / "two.obj")


real_read = reading._read_by_blender


def read_or_crash(path):
    if path.stem == "bad":
        os._exit(11)
    return real_read(path)


def test_a_crash_of_blender_costs_one_file(tmp_path, monkeypatch):
    monkeypatch.setattr(reading, "_read_by_blender", read_or_crash)
    vertices, faces = shapes.sphere(1)
    lines = [f"v {x} {y} {z}" for x, y, z in vertices] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]
    for name in ("bad.obj", "good.obj"):
        (tmp_path / name).write_text("\n".join(lines))
    with closing(reading.Reader()) as reader:
        with pytest.raises(InvalidMeshError, match=r"Blender crashed on bad\.obj"):
            reader.triangles(tmp_path / "bad.obj")
        read, read_faces = reader.triangles(tmp_path / "good.obj")
    assert read.shape == vertices.shape
    np.testing.assert_array_equal(read_faces, faces)


def leave_after(path):
    found = real_read(path)
    Timer(0.2, os._exit, [9]).start()
    return found


def test_a_reader_that_dies_between_two_files_costs_none(tmp_path, monkeypatch):
    monkeypatch.setattr(reading, "_read_by_blender", leave_after)
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    with closing(reading.Reader()) as reader:
        for _ in range(3):
            assert len(reader.triangles(tmp_path / "a.obj")[0]) == 3
            time.sleep(0.5)


def test_what_blender_refuses_is_told_from_the_other_process(tmp_path):
    (tmp_path / "empty.obj").touch()
    (tmp_path / "no.blend").write_text("no")
    with closing(reading.Reader()) as reader:
        for name in ("empty.obj", "no.blend", "missing.ply"):
            with pytest.raises(InvalidMeshError) as refused:
                reader.triangles(tmp_path / name)
            assert not str(refused.value).split()[0].endswith("Error:")
            assert "pip install" not in str(refused.value)
            assert name in str(refused.value)


def test_methods_take_settings_on_the_command_line():
    words = _words("ours:quality=draft,landmark_count=50,fast,classical:landmark_count=20")
    assert words == ["ours:quality=draft,landmark_count=50", "fast", "classical:landmark_count=20"]
    chosen = chosen_methods(words)
    assert [method.name for method in chosen] == [
        "input", "ours-quality-draft-landmark_count-50", "fast", "classical-landmark_count-20",
    ]  # fmt: skip
    assert chosen[1].settings == Settings(quality="draft", landmark_count=50)
    assert chosen[3].settings is not None
    assert chosen[3].settings.landmark_count == 20
    assert chosen[3].rival
    assert not chosen[1].rival
    assert len(chosen_methods(list(DEFAULT))) == 1 + len(DEFAULT)
    wrong = [("hers", "There is no method 'hers'"), ("ours:quality=best", "quality must be"),
             ("ours:speed=9", "not a setting"), ("ours:whole=true", "not a setting"),
             ("ours:landmark_count=x", "landmark_count cannot be 'x'")]  # fmt: skip
    for word, message in wrong:
        with pytest.raises(InvalidSettingsError, match=message):
            chosen_methods([word])
