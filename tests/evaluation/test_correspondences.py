import csv
import io

import numpy as np
import potpourri3d
import pytest

from addon.core import InvalidSettingsError
from addon.core.mesh.edges import is_closed
from addon.core.mesh.geometry import surface_area
from addon.evaluation import arguments
from addon.evaluation.correspondences import command
from addon.evaluation.correspondences.command import main
from addon.evaluation.correspondences.matchers import MATCHERS, Mesh, chosen_matchers
from addon.evaluation.correspondences.work import geodesic_errors, matched, remeshed
from tests.meshes import shapes
from tests.meshes.shapes import write_off


@pytest.fixture(scope="module")
def poses():
    """A figure and the same bent."""
    vertices, faces = shapes.figure(11)
    return Mesh(vertices, faces), Mesh(vertices + 0.2 * np.sin(vertices[:, 2:]) * [1.0, 0.5, 0.0], faces)


@pytest.fixture(scope="module")
def run(poses, tmp_path_factory):
    """A finished run: a class of two poses, one whose triangles differ, and one of a single pose."""
    data, folder = tmp_path_factory.mktemp("data"), tmp_path_factory.mktemp("matches")
    for number, pose in enumerate(poses):
        write_off(data / "figure" / f"pose{number}.off", *pose)
        write_off(data / "balls" / f"ball{number}.off", *shapes.sphere(number + 1))
    write_off(data / "single" / "one.off", *shapes.sphere(1))
    written = io.StringIO()
    words = [str(data), "--output", str(folder), "--methods", "ours,nearest", "--workers", "2"]
    return folder, main(words, written), written.getvalue().splitlines(), words


def rows_of(path):
    return list(csv.DictReader(path.read_text().splitlines()))


def test_everything_is_written_and_named(run):
    folder, code, written, _ = run
    assert code == 0
    names = {"matches.csv", "matches.md", "matches-costs.csv", "matches-costs.md", "matches.png"}
    assert {path.rsplit("/", 1)[1] for path in written} == names
    assert {path.name for path in folder.iterdir() if path.is_file()} == names


def test_every_pair_has_a_row_and_the_classes_without_pairs_a_reason(run):
    folder = run[0]
    rows = rows_of(folder / "matches.csv")
    assert [(row["mesh"], row["other"], row["method"]) for row in rows] == [
        ("pose1", "pose0", "ours"), ("pose1", "pose0", "nearest"),
        ("pose0", "pose1", "ours"), ("pose0", "pose1", "nearest"),
    ]  # fmt: skip
    for row in rows:
        assert 0 < float(row["error"]) < (0.05 if row["method"] == "ours" else 0.3)
        assert bool(row["edges"]) == (row["method"] == "ours")
        assert row["crossings_true"] == ("0" if row["method"] == "ours" else "")
        assert row["failure"] == ""
    assert all(float(row["seconds"]) > 0 for row in rows_of(folder / "matches-costs.csv"))
    report = (folder / "matches.md").read_text()
    assert "- balls: Its meshes have different triangles" in report
    assert "- single: It has one pose." in report
    ours = next(line for line in report.splitlines() if line.startswith("| figure | ours | 2 |"))
    mean = 100 * np.mean([float(row["error"]) for row in rows if row["method"] == "ours"])
    assert f"| {mean:.2f} |" in ours


def test_a_second_run_does_nothing_and_writes_the_same(run):
    folder, *_, words = run
    before = {path: path.read_bytes() for path in folder.glob("*.*") if "costs" not in path.name}
    times = {path: path.stat().st_mtime_ns for path in (folder / "results").rglob("*.npz")}
    assert len(times) == 4
    assert main(words, io.StringIO()) == 0
    assert before == {path: path.read_bytes() for path in before}
    assert times == {path: path.stat().st_mtime_ns for path in (folder / "results").rglob("*.npz")}


def test_a_pair_that_fails_is_a_row_with_its_reason(tmp_path):
    vertices, faces = shapes.sphere(1)
    two = np.concatenate([vertices, vertices + 9.0]), np.concatenate([faces, faces + len(vertices)])
    for number in range(2):
        write_off(tmp_path / "data" / "pieces" / f"pose{number}.off", two[0] * [1, 1, 1 + number], two[1])
    words = [str(tmp_path / "data"), "--output", str(tmp_path / "out"), "--methods", "nearest", "--workers", "1"]
    assert main(words, io.StringIO()) == 1
    assert all("loose parts" in row["failure"] for row in rows_of(tmp_path / "out" / "matches.csv"))
    assert "## Not done" in (tmp_path / "out" / "matches.md").read_text()


def test_the_remeshed_twin_is_the_same_surface_of_other_triangles(poses):
    twin, again = remeshed(poses[0]), remeshed(poses[0])
    for one, two in zip(twin, again, strict=True):
        np.testing.assert_array_equal(one, two)
    assert len(twin.vertices) == pytest.approx(0.7 * len(poses[0].vertices), rel=0.05)
    assert is_closed(twin.faces)
    assert surface_area(*twin) == pytest.approx(surface_area(*poses[0]), rel=0.05)


def test_errors_are_geodesic_distances(poses):
    mesh = poses[1]
    shuffled = np.random.default_rng(0).permutation(len(mesh.vertices))
    samples = np.random.default_rng(1).choice(len(mesh.vertices), 20, replace=False)
    solver = potpourri3d.MeshHeatMethodDistanceSolver(*mesh)
    truth = np.array([solver.compute_distance(int(each))[shuffled[each]] for each in samples])
    found = geodesic_errors(mesh.vertices[shuffled], mesh, 20)
    np.testing.assert_allclose(found, truth / np.sqrt(surface_area(*mesh)), rtol=0.1)
    assert found.sum() == pytest.approx(truth.sum() / np.sqrt(surface_area(*mesh)), rel=0.02)
    np.testing.assert_allclose(geodesic_errors(mesh.vertices, mesh, 20), 0.0, atol=1e-9)


def test_functional_maps_are_measured_on_the_same_meshes(poses):
    pytest.importorskip("pyFM")
    row = matched(poses[0], poses[1], "pyfm", True).row
    assert 0 < row["error"] < 0.05
    assert row["pose"] is None


def test_what_cannot_be_done_is_a_sentence(run, tmp_path, capsys, monkeypatch):
    words = run[3]
    for more, sentence in [
        (["--methods", "magic"], "There is no way to match 'magic'"),
        (["--poses", "0"], "--poses must be at least 1"),
        (["--poses", "1"], "No class has two poses"),
        (["--workers", "0"], "--workers must be at least 1"),
    ]:
        assert main([*words, *more], io.StringIO()) == 2
        assert sentence in capsys.readouterr().err
    monkeypatch.setattr(arguments, "find_spec", lambda name: None if name == "pyFM" else object())
    assert main([*words, "--methods", "ours,pyfm"], io.StringIO()) == 2
    assert "pip install pyfmaps" in capsys.readouterr().err
    assert "evaluate-matches" in command._parser().format_help()


def test_each_way_is_named_once():
    assert [each.name for each in chosen_matchers(["nearest", "ours", "nearest"])] == ["nearest", "ours"]
    with pytest.raises(InvalidSettingsError, match="nothing"):
        chosen_matchers([])
    assert list(MATCHERS) == ["ours", "nearest", "pyfm"]
