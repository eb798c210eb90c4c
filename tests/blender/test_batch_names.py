"""Which files a run reads, and the names of their results."""

import pytest

from addon.batch.inputs import found_files
from addon.core import CanonicalFormError
from tests.commands import run
from tests.meshes import shapes


@pytest.fixture
def folder(tmp_path):
    """Meshes in folders, two of them alike but for their ending, and results of an earlier run among them."""
    vertices, faces = shapes.figure(13)
    for name in ("cat.off", "a/cat.off", "a/b/cat.off", "out/cat.off"):
        path = tmp_path / "in" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        shapes.write_off(path, vertices, faces)
    shapes.write_obj(tmp_path / "in" / "cat.obj", vertices, faces)
    return tmp_path / "in"


def results(folder):
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())


def test_files_that_differ_by_their_ending_both_have_a_result(folder):
    code, lines, _ = run(folder, "--output", folder / "out2", "--format", "off")
    assert code == 0
    assert len(lines) == 2
    assert results(folder / "out2") == ["cat.obj.off", "cat.off.off"]


def test_a_tree_of_results_is_like_that_of_the_files(folder, tmp_path):
    words = ("--output", tmp_path / "tree", "--format", "off", "--output-tree")
    code, lines, _ = run(folder, *words, "--recursive")
    assert code == 0
    assert results(tmp_path / "tree") == [
        "a/b/cat.off.off", "a/cat.off.off", "cat.obj.off", "cat.off.off", "out/cat.off.off"
    ]  # fmt: skip
    alone, _, _ = run(folder / "a", "--output", tmp_path / "alone", "--format", "off", "--output-tree")
    assert alone == 0
    assert results(tmp_path / "alone") == ["cat.off.off"]
    code, again, _ = run(folder, *words, "--recursive", "--skip-existing")
    assert [line["output"] for line in again] == [line["output"] for line in lines]
    assert all(line["skipped"] for line in again)


def test_folders_are_taken_with_their_subfolders_where_that_is_asked_for(folder):
    assert [each.path.name for each in found_files([folder], folder / "out")] == ["cat.obj", "cat.off"]
    found = found_files([folder], folder / "out", recursive=True)
    assert [each.place.as_posix() for each in found] == ["a/b", "a", ".", "."]
    assert len(found_files([folder / "**" / "*.off"], folder / "out")) == 3


def test_a_list_names_files_from_its_folder(folder, tmp_path):
    (folder / "list.txt").write_text("# two\ncat.off\n\na/cat.off\n", encoding="utf-8-sig")
    code, lines, _ = run("--files-from", folder / "list.txt", "--output", tmp_path / "out", "--dry-run")
    assert code == 0
    assert [line["dry_run"] for line in lines] == [True, True]
    assert not (tmp_path / "out").exists()
    code, lines, told = run("--output", tmp_path / "out")
    assert (code, lines) == (2, [])
    assert "Name the meshes" in told


def test_the_folder_for_results_is_no_folder_of_meshes(folder):
    with pytest.raises(CanonicalFormError, match="folder for the results"):
        found_files([folder], folder)
