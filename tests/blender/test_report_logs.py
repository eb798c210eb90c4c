"""Result lines: each exactly once, whatever ends a run, and told where they cannot be written."""

import errno
import json
import os
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import pytest

from tests.meshes import shapes

pytest.importorskip("bpy")
import bpy

from addon.batch.claims import claimed, remove_left
from addon.batch.report_log import ReportLog
from addon.core import CanonicalFormError
from tests.blender.conftest import add_object
from tests.commands import QUICK, ROOT, ended, run, started

COUNT = 5


@pytest.fixture
def folder(tmp_path):
    """A folder of small meshes."""
    meshes = tmp_path / "meshes"
    meshes.mkdir()
    for number in range(COUNT):
        shapes.write_off(meshes / f"{number}.off", *shapes.figure(11 + number % 2))
    return meshes


def logged(path):
    return [json.loads(line) for line in path.read_text().splitlines()]


def test_a_log_has_each_result_once_after_a_run_that_was_killed_and_another(folder, tmp_path):
    out, log = tmp_path / "out", tmp_path / "run.jsonl"
    words = [folder, "--output", out, "--format", "off", "--log", log, "--skip-existing", "--jobs", "2", *QUICK]
    process = started(words)
    until = time.monotonic() + 120
    while time.monotonic() < until and (not log.exists() or log.read_bytes().count(b"\n") < 2):
        time.sleep(0.02)
    process.kill()
    process.communicate()
    with log.open("ab") as file:
        file.write(b'{"schema": 1, "input": "cut o')  # as a kill may leave it
    (tmp_path / "lost").mkdir()
    told = [line for line in logged_until_cut(log) if Path(line["output"]).exists()]
    Path(told[0]["output"]).replace(tmp_path / "lost" / "one.off")  # a result that is gone is made again
    unlisted = {path.name for path in out.glob("[!.]*.off")} - {Path(line["output"]).name for line in told}
    code, lines, _ = ended(started(words))
    assert code == 0
    assert len(lines) == COUNT
    found = logged(log)
    assert Counter(line["input"] for line in found) == Counter(str(path) for path in folder.iterdir())
    assert all(Path(line["output"]).exists() for line in found)
    assert {Path(line["output"]).name for line in found if line.get("skipped")} <= unlisted  # killed before its line
    assert all("measures" in line for line in found if not line.get("skipped"))
    assert sorted(path.name for path in out.iterdir()) == [f"{number}.off" for number in range(COUNT)]


def logged_until_cut(path):
    return [json.loads(line) for line in path.read_bytes().split(b"\n")[:-1]]


def test_errors_are_logged_once_and_tried_again(folder, tmp_path):
    out, log = tmp_path / "out", tmp_path / "run.jsonl"
    (folder / "0.off").write_text("OFF\n")
    words = (folder, "--output", out, "--format", "off", "--log", log, "--skip-existing")
    assert run(*words)[0] == 1
    assert sum("error" in line for line in logged(log)) == 1
    shapes.write_off(folder / "0.off", *shapes.figure(11))
    assert run(*words)[0] == 0
    assert not any("error" in line for line in logged(log))
    assert len(logged(log)) == COUNT


def test_errors_beside_results_of_one_file_are_kept_as_they_are_not_tried_again(tmp_path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    for name in ("Body", "Bad"):
        obj = add_object(name, *shapes.figure(11))
    obj.shape_key_add(name="Basis")
    obj.data.shape_keys.use_relative = False
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "two.blend"), copy=True)
    log = tmp_path / "run.jsonl"
    words = (tmp_path / "two.blend", "--output", tmp_path / "out", "--log", log, "--skip-existing")
    assert run(*words)[0] == 1
    before = log.read_text()
    assert run(*words)[0] == 0
    assert log.read_text() == before
    assert ["error" in line for line in logged(log)] == [True, False]


@pytest.mark.parametrize("name", ["mesh.off", "list.txt", "out/0.off", ".", "note.jsonl"])
def test_what_is_no_log_is_never_overwritten(name, tmp_path):
    (tmp_path / "out").mkdir()
    shapes.write_off(tmp_path / "mesh.off", *shapes.figure(11))
    (tmp_path / "list.txt").write_text("mesh.off\n")
    (tmp_path / "out" / "0.off").write_text("a result")
    (tmp_path / "note.jsonl").write_text('{"of": "another"}\n')
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    words = ("--files-from", tmp_path / "list.txt", "--output", tmp_path / "out", "--log", tmp_path / name)
    for more in ((), ("--skip-existing",)):
        code, lines, complaints = run(*words, *more)
        assert (code, lines) == (2, []), complaints
        assert "log" in complaints
    assert before == {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}


def test_of_claims_on_one_file_one_is_granted(tmp_path, monkeypatch):
    path = tmp_path / "result.off"
    with claimed(path) as ours:
        assert ours
        with claimed(path) as also:
            assert not also
        remove_left(tmp_path)
        assert list(tmp_path.iterdir())  # it is in use
    assert not list(tmp_path.iterdir())
    (tmp_path / ".killed.off.claim").touch()
    remove_left(tmp_path)
    assert not list(tmp_path.iterdir())
    if os.name == "posix":  # a file system without locks

        def without(*_):
            raise OSError(errno.ENOSYS, "no locks")

        monkeypatch.setattr("fcntl.flock", without)
        with claimed(path) as ours:
            assert ours


def test_of_two_runs_in_one_folder_each_result_is_made_by_one(folder, tmp_path):
    words = [folder, "--output", tmp_path / "out", "--format", "off", "--skip-existing", *QUICK]
    runs = [ended(each) for each in [started(words), started(words)]]
    assert [code for code, _, _ in runs] == [0, 0]
    made = Counter(line["input"] for _, lines, _ in runs for line in lines if not line.get("skipped"))
    assert made == Counter(str(path) for path in folder.iterdir())
    assert len(list((tmp_path / "out").iterdir())) == COUNT  # no claim is left


def test_a_log_belongs_to_one_run(tmp_path):
    log = ReportLog(tmp_path / "run.jsonl", continued=True)
    with pytest.raises(CanonicalFormError, match="Another run writes to"):
        ReportLog(tmp_path / "run.jsonl", continued=True)
    log.add([{"schema": 1}])
    log.close()
    ReportLog(tmp_path / "run.jsonl", continued=True).close()
    assert [path.name for path in tmp_path.iterdir()] == ["run.jsonl"]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is full")
def test_a_full_disk_under_the_lines_ends_the_run_with_a_sentence(folder, tmp_path):
    command = [
        sys.executable,
        "-m",
        "addon",
        "compute",
        folder,
        "--output",
        tmp_path / "out",
        "--format",
        "off",
        *QUICK,
    ]
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [str(word) for word in command], cwd=ROOT, stdout=full, stderr=subprocess.PIPE, text=True, check=False
        )
    assert done.returncode == 1
    assert "The result lines cannot be written" in done.stderr
    assert "Traceback" not in done.stderr
    assert "Exception ignored" not in done.stderr


def test_a_time_limit_needs_workers_to_end(folder, tmp_path):
    code, _, complaints = run(folder, "--output", tmp_path / "out", "--timeout", "5")
    assert code == 2
    assert "--timeout" in complaints
    shapes.write_off(tmp_path / "large.off", *shapes.figure(60))
    words = [tmp_path / "large.off", "--output", tmp_path / "out", "--quality", "full", "--timeout", "3", *QUICK]
    code, [line], _ = ended(started(words))
    assert code == 1
    assert line["error"] == "It took longer than 3 s."
    assert list((tmp_path / "out").iterdir()) == []
