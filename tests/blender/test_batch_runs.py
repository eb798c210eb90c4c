"""Workers that die, keys that stop a run, many files at once, and runs that go on where one ended."""

import os
import re
from pathlib import Path

import pytest

from tests.meshes import shapes

pytest.importorskip("psutil")
pytest.importorskip("bpy")
from tests.commands import busy_worker, ended, started

QUICK = ["--max-iterations", "2", "--landmark-count", "12"]
# what Blender 5.2 says itself: of its colours, and of mounts where there is no list of them
BLENDERS_OWN = re.compile(r"color_management|system\.path +\| WARNING Could not get a list of mounted file-systems")


@pytest.mark.parametrize("times", [1, 2])
def test_a_crash_costs_one_file_at_most(tmp_path, times):
    shapes.write_off(tmp_path / "slow.off", *shapes.figure(72))
    shapes.write_off(tmp_path / "quick.off", *shapes.figure(13))
    out = tmp_path / "out"
    process = started([tmp_path / "slow.off", tmp_path / "quick.off", "--output", out, "--quality", "full", *QUICK])
    killed: list[int] = []
    for _ in range(times):
        worker = busy_worker(process, killed)
        killed.append(worker.pid)
        worker.kill()
    code, lines, errors = ended(process)
    by_name = {Path(line["input"]).name: line for line in lines}
    assert set(by_name) == {"slow.off", "quick.off"}
    assert "error" not in by_name["quick.off"]
    assert ("error" in by_name["slow.off"]) == (times == 2)  # killed once it is tried again: it may not be to blame
    assert code == (times == 2)
    assert ("crashed on this file" in errors) == (times == 2)
    assert len(list(out.iterdir())) == 3 - times


@pytest.mark.skipif(os.name != "posix", reason="needs signals")
def test_the_keyboard_stops_all_processes(tmp_path):
    import signal

    shapes.write_off(tmp_path / "mesh.off", *shapes.figure(72))
    # a job in the background of a shell starts deaf to the keyboard
    process = started([tmp_path / "mesh.off", "--output", tmp_path, "--quality", "full"],
                      preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))  # fmt: skip
    worker = busy_worker(process)
    process.send_signal(signal.SIGINT)
    code, lines, _ = ended(process)
    assert (code, lines) == (130, [])
    assert not worker.is_running()
    assert [path.name for path in tmp_path.iterdir()] == ["mesh.off"]


def test_what_is_missing_is_done_by_the_next_run(tmp_path):
    vertices, faces = shapes.figure(12)
    meshes = tmp_path / "meshes"
    meshes.mkdir()
    for number in range(5):
        shapes.write_off(meshes / f"{number}.off", vertices, faces)
    (meshes / "broken.off").write_text("OFF\n3 1 0\n0 0 0\n")
    words = [meshes, "--output", tmp_path / "out", "--format", "obj", "--skip-existing", "--jobs", "2", *QUICK]
    code, lines, _ = ended(started(words))
    assert code == 1
    assert sorted("error" in line for line in lines) == [False] * 5 + [True]
    (tmp_path / "out" / "3.obj").unlink()
    before = {path.name: path.stat().st_mtime_ns for path in (tmp_path / "out").iterdir()}
    code, lines, errors = ended(started(words))
    assert code == 1
    said = [line for line in errors.splitlines() if not BLENDERS_OWN.search(line)]
    assert len(said) == 1
    assert "broken.off" in said[0]
    done = [line for line in lines if not line.get("skipped") and "error" not in line]
    assert [Path(line["output"]).name for line in done] == ["3.obj"]
    after = {path.name: path.stat().st_mtime_ns for path in (tmp_path / "out").iterdir()}
    assert {name: after[name] for name in before} == before
    assert all(line["schema"] == 1 for line in lines)
