import csv
import io
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import psutil
import pytest

from addon.evaluation.command import main
from addon.evaluation.methods import KNOWN
from addon.evaluation.report import FIGURES
from addon.evaluation.store import code_version
from addon.evaluation.tables import evenly
from addon.evaluation.work import hausdorff_row, measured
from addon.scheduling import crews
from addon.scheduling.attempts import Failure
from addon.scheduling.crews import LocalCrew
from addon.scheduling.workers import Task
from tests.meshes import shapes
from tests.meshes.shapes import write_off

METHODS = "ours,fast"


@pytest.fixture(scope="module")
def run(dataset, tmp_path_factory):
    """A finished evaluation."""
    folder = tmp_path_factory.mktemp("evaluation")
    written = io.StringIO()
    code = main([str(dataset), "--output", str(folder), "--methods", METHODS, "--workers", "2"], written)
    return folder, code, written.getvalue().splitlines()


def rows_of(path):
    return list(csv.DictReader(path.read_text().splitlines()))


def test_everything_is_written_and_named(run):
    folder, code, written = run
    assert code == 0
    names = {path.rsplit("/", 1)[1] for path in written}
    assert names >= {
        "results.csv", "classes.csv", "methods.csv", "costs.csv", "report.md", "costs.md", "precision-recall.png",
        "compactness-error.png", "gallery.png", "descriptor-distances-ours.csv", "hausdorff-fast@egg.csv",
    }  # fmt: skip
    assert names == {path.name for path in folder.iterdir() if path.is_file()}
    for line in written:
        assert line.startswith(str(folder))


def test_every_form_has_a_row(run):
    rows = rows_of(run[0] / "results.csv")
    assert len(rows) == 3 * 9
    assert list(rows[0]) == ["class", "shape", "method", *FIGURES, "error"]
    for row in rows:
        assert row["error"] == ""
        assert float(row["compactness"]) > 0
        assert float(row["compactness_error"]) >= 0
        assert float(row["hausdorff"]) >= 0
        if row["method"] == "input":
            assert float(row["compactness_error"]) == 0
        else:
            assert int(row["features"]) >= 1
    costs = rows_of(run[0] / "costs.csv")
    assert all(float(row["seconds"]) > 0 for row in costs if row["method"] != "input")


def test_tables_are_what_the_forms_say(run, dataset):
    folder = run[0]
    rows = [row for row in rows_of(folder / "results.csv") if row["method"] == "fast"]
    error = 1e4 * np.array([float(row["compactness_error"]) for row in rows])
    line = next(row for row in rows_of(folder / "methods.csv") if row["method"] == "fast")
    assert float(line["compactness_error_mean_e4"]) == pytest.approx(error.mean())
    assert float(line["compactness_error_deviation_e4"]) == pytest.approx(error.std(ddof=1))
    ours = next(row for row in rows_of(folder / "methods.csv") if row["method"] == "ours")
    given = next(row for row in rows_of(folder / "methods.csv") if row["method"] == "input")
    assert float(given["pose_ratio"]) == pytest.approx(1)
    assert float(ours["pose_ratio"]) > 0
    assert float(ours["nearest_neighbour"]) > 0.8
    matrix = np.array(
        [row[1:] for row in csv.reader((folder / "hausdorff-ours@bell.csv").read_text().splitlines())][1:]
    )
    matrix = matrix.astype(float)
    np.testing.assert_array_equal(matrix, matrix.T)
    assert (matrix[np.triu_indices(3, 1)] > 0).all()
    report = (folder / "report.md").read_text()
    assert "bell (3), egg (3), figure (3)" in report
    assert "| ours |" in report


def test_a_second_run_does_nothing_and_writes_the_same(run, dataset, tables_of):
    folder = run[0]
    before, times = tables_of(folder), {p: p.stat().st_mtime_ns for p in (folder / "results").rglob("*.npz")}
    assert len(times) == 3 * 9 + 3 * 3 * 2
    assert main([str(dataset), "--output", str(folder), "--methods", METHODS, "--workers", "1"], io.StringIO()) == 0
    assert tables_of(folder) == before
    assert times == {p: p.stat().st_mtime_ns for p in (folder / "results").rglob("*.npz")}


def test_what_changed_is_done_again(run, dataset, tmp_path, tables_of):
    folder, data = tmp_path / "out", tmp_path / "data"
    shutil.copytree(run[0], folder)
    shutil.copytree(dataset, data)
    vertices, faces = shapes.sphere(2)
    write_off(data / "egg" / "egg1.off", vertices * [1, 2, 3], faces)
    os.truncate(folder / "results" / "fast" / "bell" / "bell0.npz", 3000)
    (folder / "results" / "fast" / "bell" / "bell2.npz").write_bytes(b"half a fi")
    old, new = (folder / "results" / "fast" / "bell" / f".bell1.npz.{k}.partial" for k in (77, 78))
    old.write_bytes(b"x")
    new.write_bytes(b"of a run that is at work")
    os.utime(old, (0, 0))
    times = {p: p.stat().st_mtime_ns for p in (folder / "results").rglob("*.npz")}
    assert main([str(data), "--output", str(folder), "--methods", METHODS, "--workers", "1"], io.StringIO()) == 0
    again = {p for p in times if p.stat().st_mtime_ns != times[p]}
    forms = {p for p in again if "hausdorff" not in p.parts}
    assert forms == {folder / "results" / m / "egg" / "egg1.npz" for m in ("input", "ours", "fast")} | {
        folder / "results" / "fast" / "bell" / f"bell{k}.npz" for k in (0, 2)
    }
    assert {p.parent.name for p in again - forms} <= {"egg", "bell"}
    assert list((folder / "results").rglob("*.partial")) == [new]


def test_a_mesh_that_got_lost_is_in_no_table(run, dataset, tmp_path, tables_of):
    folder, data = tmp_path / "out", tmp_path / "data"
    shutil.copytree(run[0], folder)
    shutil.copytree(dataset, data)
    text = (data / "egg" / "egg1.off").read_text().splitlines()
    (data / "egg" / "egg1.off").write_text("\n".join([*text[:2], "nan nan nan", *text[3:]]))
    shutil.rmtree(data / "bell")
    words = ["--methods", METHODS, "--workers", "1"]
    assert main([str(data), "--output", str(folder), *words], io.StringIO()) == 1
    assert main([str(data), "--output", str(tmp_path / "fresh"), *words], io.StringIO()) == 1
    assert tables_of(folder) == tables_of(tmp_path / "fresh")
    assert "egg1" not in (folder / "hausdorff-input@egg.csv").read_text()


def test_what_this_machine_could_not_read_is_tried_again(dataset, tmp_path):
    data = tmp_path / "data"
    shutil.copytree(dataset / "egg", data / "egg")
    (data / "egg" / "egg1.off").rename(data / "egg" / "egg1.stl")
    words = [str(data), "--output", str(tmp_path / "out"), "--methods", "fast", "--workers", "1", "--hausdorff", "0"]
    assert main(words, io.StringIO()) == 1
    (data / "egg" / "egg1.stl").rename(data / "egg" / "egg1.off")
    (data / "egg" / "egg2.off").unlink()
    (data / "egg" / "egg2.off").symlink_to("/proc/self/mem")
    assert main(words, io.StringIO()) == 1
    rows = {(row["shape"], row["method"]): row["error"] for row in rows_of(tmp_path / "out" / "results.csv")}
    assert rows["egg1", "fast"] == ""
    assert "cannot be read" in rows["egg2", "fast"]


def test_a_mesh_that_fails_is_a_row_with_its_reason(dataset, tmp_path):
    data = tmp_path / "data"
    shutil.copytree(dataset / "egg", data / "egg")
    write_off(data / "odd" / "line.off", np.outer(np.arange(3), np.ones(3)), np.array([[0, 1, 2]]))
    (data / "odd" / "cut.off").write_text("OFF\n9 9 0\n0 0 0\n")
    code = main([str(data), "--output", str(tmp_path / "out"), "--methods", "fast", "--workers", "1"], io.StringIO())
    assert code == 1
    rows = {(row["shape"], row["method"]): row["error"] for row in rows_of(tmp_path / "out" / "results.csv")}
    assert "cut short" in rows["cut", "fast"]
    assert "no area" in rows["line", "fast"]
    assert rows["egg0", "fast"] == ""
    assert "## Not done" in (tmp_path / "out" / "report.md").read_text()


@pytest.mark.parametrize(
    ("words", "message"),
    [(["none"], "is not a folder"), (["--methods", "hers"], "There is no method 'hers'"),
     (["--workers", "0"], "--workers must be at least 1"),
     (["--scheduler", "127.0.0.1:9"], "No Dask scheduler answers"),
     (["--scheduler", "host:abc"], "No Dask scheduler answers")],
)  # fmt: skip
def test_words_that_make_no_sense(dataset, tmp_path, capsys, monkeypatch, words, message):
    monkeypatch.setattr(crews, "_PATIENCE", "2s")
    where = [] if words == ["none"] else [str(dataset)]
    assert main([*where, *words, "--output", str(tmp_path / "out")], io.StringIO()) == 2
    assert message in capsys.readouterr().err


def test_it_runs_as_a_command_without_blender(dataset, tmp_path):
    (tmp_path / "bpy.py").write_text("raise ImportError('no Blender here')")
    environment = {**os.environ, "PYTHONPATH": str(tmp_path)}
    done = subprocess.run(
        [sys.executable, "-m", "addon", "evaluate", str(dataset), "--output", str(tmp_path / "out"),
         "--methods", "fast", "--workers", "1", "--hausdorff", "0"],
        capture_output=True, text=True, env=environment, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert str(tmp_path / "out" / "report.md") in done.stdout.splitlines()
    assert "Forms: 100%" in done.stderr
    assert not list((tmp_path / "out").glob("hausdorff*"))


def test_the_code_is_read_alike_whatever_the_language_of_the_machine():
    plain = {**os.environ, "LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    words = [sys.executable, "-c", "from addon.evaluation.store import code_version; print(code_version())"]
    done = subprocess.run(words, capture_output=True, text=True, env=plain, check=False)
    assert done.stdout.split() == [code_version()], done.stderr


def test_tables_are_not_written_among_what_is_read(dataset, tmp_path, capsys):
    classes = tmp_path / "classes.csv"
    classes.write_text("a.off,one\n")
    (tmp_path / "in").mkdir()
    shapes.write_off(tmp_path / "in" / "a.off", *shapes.sphere(1))
    words = [str(tmp_path / "in"), "--classes", str(classes), "--methods", "fast", "--output"]
    for output in (tmp_path, tmp_path / "in"):
        assert main([*words, str(output)]) == 2
        assert "Choose another --output" in capsys.readouterr().err
    assert classes.read_text() == "a.off,one\n"


def died():
    os._exit(9)


class UnsendableError(Exception):
    """Pickles, but does not unpickle."""

    def __init__(self, one, two):
        super().__init__(f"{one}{two}")


def raising():
    raise UnsendableError(1, 2)


def test_work_that_kills_its_worker_is_given_up_and_harms_no_other():
    crew = LocalCrew(2)
    pieces: list[tuple[object, tuple[Callable[..., Any], tuple[Any, ...]]]] = [
        ("good", (len, ([1, 2],))), ("bad", (died, ())), ("worse", (len, (3,))), ("odd", (raising, ())),
        ("fine", (len, ([],))),
    ]  # fmt: skip
    results = dict(crew.results(iter(pieces)))
    crew.close()
    assert results["good"] == 2
    assert results["fine"] == 0
    assert isinstance(results["bad"], Failure)
    assert "died 3 times" in results["bad"].reason
    assert results["worse"].reason.startswith("TypeError: ")
    assert "Unsendable" in results["odd"].reason


def test_work_that_only_waited_is_not_held_to_blame():
    crew = LocalCrew(1, attempts=1)
    results = dict(crew.results(iter([("bad", (died, ())), ("fine", (len, ([1],))), ("last", (len, ([],)))])))
    crew.close()
    assert results.pop("bad").died
    assert results == {"fine": 1, "last": 0}


def counted(file, last):
    """Yield numbers; die once before the last."""
    yield from range(last)
    if not file.exists():
        file.touch()
        os._exit(9)
    yield last


def test_results_come_as_they_are_made_and_again_if_the_worker_dies_among_them(tmp_path):
    crew = LocalCrew(2)
    pieces = [(name, (counted, (tmp_path / name, last))) for name, last in (("one", 3), ("other", 0), ("third", 5))]
    results = list(crew.results(iter(pieces)))
    crew.close()
    for name, last in (("one", 3), ("other", 0), ("third", 5)):
        assert [number for each, number in results if each == name] == [*range(last), *range(last + 1)]


def test_work_that_takes_too_long_is_ended_and_harms_no_other():
    crew = LocalCrew(2, timeout=6.0)
    results = dict(
        crew.results(iter([("long", (time.sleep, (600,))), ("fine", (len, ([1],))), ("last", (len, ([],)))]))
    )
    crew.close()
    assert results.pop("long").reason == "It took longer than 6 s."
    assert results == {"fine": 1, "last": 0}


def test_a_second_interrupt_kills_the_workers_without_a_traceback(monkeypatch):
    crew = LocalCrew(1)
    worker = crew._idle().begin(Task("long", (time.sleep, (60,))), None).process
    process = psutil.Process(worker.pid)

    def interrupted():
        raise KeyboardInterrupt

    monkeypatch.setattr(worker, "terminate", lambda: None)  # a worker that is slow to end
    monkeypatch.setattr(worker, "join", interrupted)
    crew.close()
    monkeypatch.undo()
    gone, _ = psutil.wait_procs([process], timeout=30)
    assert gone  # it did not end by itself, which takes a minute


def test_forms_measured_by_a_worker_are_on_one_thread_and_named():
    vertices, faces = shapes.figure(11)
    outcome = measured(vertices, faces, KNOWN["fast"])
    assert outcome.form is not None
    assert outcome.form.shape == vertices.shape
    seconds, all_seconds, memory = (outcome.cost[name] for name in ("seconds", "all_seconds", "memory"))
    assert seconds is not None
    assert all_seconds is not None
    assert seconds <= all_seconds
    assert memory is None or memory >= 0
    broken = measured(vertices, faces[:0], KNOWN["fast"])
    assert broken.form is None
    assert broken.row["error"]


def test_hausdorff_rows_do_not_know_place_or_side(rotation):
    vertices, _ = shapes.figure(11)
    distances, _ = hausdorff_row([vertices, vertices @ rotation + 2.0, vertices * [-1.0, 1.0, 1.0]])
    np.testing.assert_allclose(distances, 0, atol=1e-6)


def test_some_are_chosen_evenly():
    shapes: Any = "abcdefghij"  # of any kind
    assert evenly(shapes, 4) == ["a", "d", "g", "j"]
    assert evenly(shapes[:3], 9) == ["a", "b", "c"]
    assert evenly(shapes[:3], 1) == ["a"]
