"""Published benchmarks as they come: true vertices, lists of pairs, and figures whose values are known."""

import csv
import io

import numpy as np
import pytest

from addon.core import InvalidMeshError
from addon.core.mesh.geometry import surface_area
from addon.evaluation.correspondences.command import main
from addon.evaluation.correspondences.matchers import MATCHERS, Found, Matcher, Mesh
from addon.evaluation.correspondences.published import landmarked_meshes, listed_pairs
from addon.evaluation.correspondences.published_work import (
    coverage,
    dirichlet_energy,
    distances_to,
    measured,
    nearest_corners,
)
from tests.meshes import shapes
from tests.meshes.shapes import write_off


@pytest.fixture(scope="module")
def figure():
    return Mesh(*shapes.figure(11))


@pytest.fixture(scope="module", params=[0, 1])
def benchmark(request, figure, tmp_path_factory):
    """Three poses, the last with its vertices shuffled, and the true vertices of some of them, counted from 0 or 1."""
    folder = tmp_path_factory.mktemp(f"benchmark{request.param}")
    (folder / "truth").mkdir()
    points = np.arange(0, len(figure.vertices), 3)
    order = np.random.default_rng(2).permutation(len(figure.vertices))
    for number in range(3):
        vertices = figure.vertices + 0.1 * number * np.sin(figure.vertices[:, 2:]) * [1.0, 0.5, 0.0]
        faces, truth = figure.faces, points
        if number == 2:
            faces, truth = order[faces], order[points]
            vertices = vertices[np.argsort(order)]
        write_off(folder / f"pose{number}.off", vertices, faces)
        lines = "\n".join(map(str, truth + request.param))
        (folder / "truth" / f"pose{number}.vts").write_text(lines + "\n", encoding="utf-8")
    (folder / "notes.txt").write_text("not a mesh", encoding="utf-8")
    return folder


def test_truth_is_read_from_0_or_1(benchmark, figure):
    meshes = landmarked_meshes(benchmark, benchmark / "truth")
    assert [each.name for each in meshes] == ["pose0", "pose1", "pose2"]
    assert meshes[0].truth.tolist() == list(range(0, len(figure.vertices), 3))
    assert all(each.mirrored is None for each in meshes)


def test_pairs_are_those_of_the_list_or_all(benchmark, tmp_path):
    meshes = landmarked_meshes(benchmark, benchmark / "truth")
    assert len(listed_pairs(meshes, None)) == 6
    listed = tmp_path / "pairs.txt"
    listed.write_text("pose0\tpose2\npose1.off,pose0\nelsewhere pose0\n\n", encoding="utf-8")
    assert [(one.name, other.name) for one, other in listed_pairs(meshes, listed)] == [
        ("pose0", "pose2"),
        ("pose1", "pose0"),
    ]
    listed.write_text("a b\n", encoding="utf-8")
    with pytest.raises(InvalidMeshError, match="names no pair"):
        listed_pairs(meshes, listed)


def test_what_is_no_truth_is_told(benchmark, tmp_path):
    with pytest.raises(InvalidMeshError, match=r"no \.vts file"):
        landmarked_meshes(benchmark, tmp_path)
    (tmp_path / "pose0.vts").write_text("one\ntwo\n", encoding="utf-8")
    with pytest.raises(InvalidMeshError, match="number of a vertex"):
        landmarked_meshes(benchmark, tmp_path)


def test_the_identity_is_perfect(figure):
    every = np.arange(len(figure.vertices))
    assert coverage(figure, every) == 1.0
    assert dirichlet_energy(figure, figure, figure.vertices) == pytest.approx(1.0)
    assert dirichlet_energy(figure, figure, figure.vertices + 5.0) == pytest.approx(1.0)
    rough = figure.vertices + np.random.default_rng(0).normal(scale=0.05, size=figure.vertices.shape)
    assert dirichlet_energy(figure, figure, rough) > 1.3
    assert 0.3 < coverage(figure, every[figure.vertices[:, 0] > 0]) < 0.7


def test_the_nearest_vertex_is_of_the_skin_that_was_matched_and_not_of_what_touches_it():
    vertices = np.array([[0.0, 0, 0], [4, 0, 0], [0, 4, 0], [1.2, 1.2, -1], [1.2, 1.2, 0.1], [1.3, 1.2, 1]])
    mesh = Mesh(vertices, np.array([[0, 1, 2], [3, 4, 5]]))  # the second passes through the first
    places = np.einsum("ij,ijk->ik", [[0.4, 0.3, 0.3], [0.1, 0.8, 0.1]], vertices[mesh.faces])
    assert nearest_corners(mesh, mesh.faces, places).tolist() == [0, 4]


@pytest.mark.parametrize("exact", [False, True])
def test_distances_are_over_the_root_of_the_area(exact):
    if exact:
        pytest.importorskip("pygeodesic")
    ball = Mesh(*shapes.sphere(4))
    quarter = (np.pi / 2) / np.sqrt(surface_area(*ball))
    top, side = ball.vertices[:, 2].argmax(), ball.vertices[:, 0].argmax()
    (apart,) = distances_to(ball, np.array([top, top]), [ball.vertices[[side, top]]], exact)
    assert apart[0] == pytest.approx(quarter, rel=0.02)
    assert apart[1] == pytest.approx(0.0, abs=1e-6 if exact else 0.02)


def test_a_match_of_the_other_side_is_a_flip(monkeypatch):
    vertices, faces = shapes.figure(11)
    other = Mesh(vertices, faces)
    mirror = vertices * [-1.0, 1.0, 1.0]
    partner = np.linalg.norm(vertices[:, None] - mirror[None], axis=2).argmin(axis=1)

    def flipped(one, _):
        return Found(np.repeat(partner[:, None], 3, axis=1), np.full((len(one.vertices), 3), 1 / 3))

    monkeypatch.setitem(MATCHERS, "flipped", Matcher("flipped", "", flipped))
    every = np.arange(len(vertices))
    found = measured(other, other, every, every, partner, "flipped", 40, False)
    assert found.row["flip"]
    assert found.row["mirrored"] < 0.02 < found.row["error"]
    assert (np.diff(found.arrays["curve"]) >= 0).all()


@pytest.mark.parametrize("benchmark", [1], indirect=True)
def test_the_command_writes_tables_and_curves(benchmark, tmp_path):
    words = [
        str(benchmark),
        "--truth",
        "truth",
        "--methods",
        "ours",
        "--points",
        "40",
        "--workers",
        "2",
        "--first",
        "3",
    ]
    written = io.StringIO()
    assert main([*words, "--output", str(tmp_path)], written) == 0
    rows = list(csv.DictReader((tmp_path / "published.csv").read_text(encoding="utf-8").splitlines()))
    assert len(rows) == 3
    for row in rows:
        assert float(row["error"]) < 0.05
        assert float(row["points"]) < 0.05
        assert row["flip"] == row["failure"] == ""
        assert 0.7 < float(row["coverage"]) <= 1.0
    (curve,) = list(csv.DictReader((tmp_path / "published-curves.csv").read_text(encoding="utf-8").splitlines()))
    assert curve.pop("method") == "ours"
    shares = [float(each) for each in curve.values()]
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
    assert "| ours | 3 |" in (tmp_path / "published.md").read_text(encoding="utf-8")
    again = io.StringIO()
    before = (tmp_path / "published.csv").stat().st_mtime_ns
    assert main([*words, "--output", str(tmp_path)], again) == 0  # goes on where it was: nothing is left to do
    assert again.getvalue() == written.getvalue()
    assert (tmp_path / "published.csv").stat().st_mtime_ns >= before


@pytest.mark.parametrize("benchmark", [1], indirect=True)
def test_files_of_different_lengths_are_a_failure_of_their_pair(benchmark, tmp_path, figure):
    truth = tmp_path / "truth"
    truth.mkdir()
    for number in range(2):
        (truth / f"pose{number}.vts").write_text("1\n2\n3\n"[: 4 + 2 * number], encoding="utf-8")
    words = [str(benchmark), "--truth", str(truth), "--methods", "ours", "--workers", "1", "--first", "1"]
    assert main([*words, "--output", str(tmp_path / "out")], io.StringIO()) == 1
    assert "have 2 and 3 lines" in (tmp_path / "out" / "published.md").read_text(encoding="utf-8")
