"""The driver of the benchmarks: what it measures is kept, recorded and shown, and what differs is told."""

import json
from pathlib import Path
from unittest import mock

import numpy as np
import pytest

from addon.core import canonical_form
from tests.meshes import shapes
from tools.benchmarks import results
from tools.benchmarks.__main__ import main
from tools.benchmarks.experiment import Experiment, agrees, shown
from tools.benchmarks.experiments import EXPERIMENTS
from tools.benchmarks.experiments.ablation import VARIANTS, against_default
from tools.benchmarks.experiments.forms import quality
from tools.benchmarks.mesh_sets import chosen, folders, generated, together

ROOT = Path(__file__).resolve().parents[1]
RECORDS = results.read_records(ROOT / "docs")
PAGE = (ROOT / "docs" / results.PAGE).read_text(encoding="utf-8")


@pytest.fixture
def data(tmp_path):
    """A folder with two poses of an arm."""
    for degrees in (0, 60):
        shapes.write_obj(tmp_path / "meshes" / "arm" / f"bent{degrees}.obj", *shapes.joint(degrees, 20, 8))
    return tmp_path / "meshes"


class Counted:
    """A measure that counts its calls, and fails if there are none left."""

    def __init__(self, calls):
        self.left, self.factor = calls, 1.0

    def __call__(self, body, setting):
        """Half the number of vertices."""
        assert self.left, "measured once too often"
        self.left -= 1
        for pose, vertices in zip(body.poses.names, body.poses.vertices, strict=True):
            yield {"pose": pose, "half": self.factor * len(vertices) / 2, "seconds": self.factor, "none": np.nan}


def run(measure, data, folder, *words, code=0):
    """Run the driver with one experiment in a folder of documents of its own."""
    measure.__module__ = quality.__module__
    experiments = {"halves": Experiment("halves", folders, measure, first=True)}
    given = [str(data), "--output", str(folder / "docs"), *words]
    assert main(given, experiments, folder / "kept") == code
    page = folder / "docs" / results.PAGE
    return page.read_text(encoding="utf-8") if page.is_file() else ""


def test_one_experiment_from_meshes_to_the_page(data, tmp_path):
    experiments = {"quality": EXPERIMENTS["quality"]}
    assert main([str(data), "--output", str(tmp_path / "docs")], experiments, tmp_path / "kept") == 0
    row, other = json.loads((tmp_path / "docs" / results.RAW).read_text())["quality"]["rows"]
    page = (tmp_path / "docs" / results.PAGE).read_text(encoding="utf-8")
    _, poses, faces = folders(data)[0].poses
    feet = len(canonical_form(poses[1], faces).feature_points)
    assert (row["mesh"], row["poses"], row["features"]) == ("arm", 2, f"{feet}")
    assert 0 < row["pose ratio"] < 0.5  # the bend goes
    assert row["time / potpourri3d"] > 0
    assert (row["setting"], other["setting"]) == ("straight", "local_features")
    assert f"| arm | straight | 2 | {feet} | {shown(row['pose ratio'])} |" in page
    told = f"straight **{row['pose ratio']:.3f}**, local_features **{other['pose ratio']:.3f}**"
    assert f"Pose ratio overall, sum over sum: {told}." in page
    assert "make bench ONLY=quality DATA=folder" in page
    assert page == results.page(results.read_records(tmp_path / "docs"), experiments)


def test_what_was_measured_is_kept(data, tmp_path):
    page = run(Counted(1), data, tmp_path)
    assert run(Counted(0), data, tmp_path) == page
    (data / "arm" / "bent0.obj").touch()
    run(Counted(0), data, tmp_path)  # the same meshes, copied anew
    shapes.write_obj(data / "arm" / "bent0.obj", *shapes.joint(1, 20, 8))
    run(Counted(0), data, tmp_path, code=2)  # others have other results, and a failure is told
    run(Counted(1), data, tmp_path)


def test_a_stopped_run_goes_on_where_it_was(data, tmp_path):
    shapes.write_obj(data / "ball" / "round.obj", *shapes.sphere(2))
    assert run(Counted(1), data, tmp_path, code=2) == ""
    assert "| ball |" in run(Counted(1), data, tmp_path)  # the arm was kept


@pytest.mark.parametrize(
    ("factor", "code", "told"),
    [
        (1.0, 0, ""),
        (1.0001, 0, ""),
        (1.01, 1, "halves, arm, bent0, half: the page has 81.00, measured 81.81."),
        (1.9, 1, "half"),
        (2.1, 1, "seconds: the page has 1.000, measured 2.100."),
    ],
)
def test_a_measured_figure_that_differs_is_told(data, tmp_path, capsys, factor, code, told):
    page = run(Counted(1), data, tmp_path)
    again = Counted(1)
    again.factor = factor
    for path in (tmp_path / "kept").rglob("*.json"):
        path.unlink()
    assert run(again, data, tmp_path, "--check", code=code) == page
    errors = capsys.readouterr().err
    assert told in errors
    assert factor > 2 or "seconds: " not in errors  # of another machine


def test_a_figure_changed_by_hand_is_told(data, tmp_path, capsys):
    page = run(Counted(1), data, tmp_path)
    (tmp_path / "docs" / results.PAGE).write_text(page.replace("81.00", "80.00", 1), encoding="utf-8")
    run(Counted(0), data, tmp_path, "--check", code=1)
    assert "80.00" in capsys.readouterr().err


def test_a_table_that_is_missing_and_other_meshes_are_told(data, tmp_path, capsys):
    run(Counted(1), data, tmp_path, "--check", code=1)
    assert "halves is not on the page: make bench ONLY=halves DATA=folder" in capsys.readouterr().err
    run(Counted(0), data, tmp_path)
    shapes.write_obj(data / "ball" / "round.obj", *shapes.sphere(2))
    run(Counted(1), data, tmp_path, "--check", code=1)
    assert "halves was measured on arm, now on arm, ball" in capsys.readouterr().err


def test_what_cannot_be_measured_is_told(data, tmp_path, capsys):
    assert main([str(data), "--only", "nothing"]) == 2
    assert "No such experiment: nothing. There are: quality" in capsys.readouterr().err
    empty = tmp_path / "empty"
    empty.mkdir()
    assert main([str(empty), "--only", "quality", "--output", str(tmp_path)]) == 2
    assert "quality: no meshes for it in" in capsys.readouterr().err


def test_the_page_is_made_from_the_records():
    assert results.page(RECORDS, EXPERIMENTS) == PAGE
    assert results.differences(RECORDS, {}, PAGE, EXPERIMENTS) == []


@pytest.mark.parametrize("name", RECORDS)
def test_any_figure_of_the_page_that_is_changed_by_hand_is_told(name):
    table = EXPERIMENTS[name].markdown(RECORDS[name]["rows"]).splitlines()
    for line in table[2:]:
        assert line in PAGE or not line.startswith("|")
    last = [line for line in table if line.startswith("|")][-1]
    changed = last.replace(last.split("|")[-2], " 7,654 ")
    told = results.differences(RECORDS, {}, PAGE.replace(last, changed), EXPERIMENTS)
    assert f"{results.PAGE} has by hand: {changed}" in told


@pytest.mark.parametrize(
    ("column", "told", "measured", "wanted"),
    [
        ("ratio", 0.143, 0.142, True),
        ("ratio", 0.143, 0.141, False),
        ("vertices", 1200, 1201, False),
        ("moved outside (rounding)", 2e-16, 9e-17, True),
        ("ratio", 2e-16, 9e-17, False),
        ("seconds", 2.0, 1.0, True),
        ("seconds", 2.1, 1.0, False),
        ("time / potpourri3d", 1.0, 0.5, False),
        ("ratio", -1.0, 1.0, False),
        ("ratio", None, 1.0, False),
        ("features", "5", "5, 6", False),
    ],
)
def test_a_figure_agrees_to_its_last_digit_or_its_tolerance(column, told, measured, wanted):
    assert agrees(column, told, measured) is wanted


def test_every_experiment_says_what_its_columns_mean():
    for name, each in EXPERIMENTS.items():
        assert len(each.about) > 40, name
    assert "all" not in EXPERIMENTS
    assert [name for name, each in EXPERIMENTS.items() if each.most == 1] == ["speed", "scale"]  # hours otherwise


def test_the_code_that_figures_depend_on_is_there():
    assert all((results.ROOT / each).exists() for each in results.MEASURED)
    found = results.code_of("tools.benchmarks.experiments.pieces")
    assert {"canonical.py", "shapes.py", "tables.py"} <= {path.name for path in found}
    own = {path.stem for path in found if "benchmarks" in path.parts}
    assert own == {"pieces", "forms", "experiment", "mesh_sets", "measuring"}


def test_bodies_are_chosen_by_name_in_collections_too():
    bodies = generated(a=lambda: shapes.sphere(0), b=lambda: shapes.sphere(0))(None)
    assert [body.name for body in chosen(bodies, ["b"])] == ["b"]
    assert [body.name for body in chosen(together(bodies), ["b"])] == ["b"]
    assert [body.name for body in chosen(together(bodies), [])] == ["a, b"]


def test_poses_of_one_folder_share_their_triangles(data):
    shapes.write_obj(data / "arm" / "ball.obj", *shapes.sphere(1))
    with pytest.raises(ValueError, match=r"have other triangles: one folder per mesh"):
        _ = folders(data)[0].poses


def test_every_row_of_the_ablation_changes_something_that_exists(data):
    for name, variant in VARIANTS.items():
        for target in variant.patches:
            with mock.patch(target):  # a name that is not there raises an error
                pass
        assert variant.settings or variant.patches or name in ("default", "jitter: single precision")
    (row,) = EXPERIMENTS["ablation"].measure(folders(data)[0], VARIANTS["no push"])
    (default,) = EXPERIMENTS["ablation"].measure(folders(data)[0], VARIANTS["default"])
    assert row["ratio"] != default["ratio"]


def test_the_ablation_tells_factors_and_differences():
    def row(setting, ratio, median):
        numbers = dict.fromkeys(("edges, 95 %", "edges, 99.9 %", "compactness error"), 0.5)
        return {"mesh": "a", "setting": setting, "ratio": ratio, "edges, median": median, "time": 2.0} | numbers

    first, second = against_default([row("default", 0.2, 0.1), row("no push", 0.3, 0.2)])
    assert (first["step"], first["ratio"]) == ("default", 0.2)
    assert (second["ratio"], second["time"]) == pytest.approx((1.5, 1.0))
    assert second["edges, median"] == pytest.approx(0.1)
