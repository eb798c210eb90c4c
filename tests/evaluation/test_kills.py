"""An evaluation survives SIGKILL of itself, of a local worker and of a Dask worker, at random moments."""

import io
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import psutil
import pytest

from addon.evaluation.command import main
from tests.meshes import shapes

METHODS = "ours,skeleton,fast"
KILLS = 5
PATIENCE = 120  # seconds


@pytest.fixture(scope="module")
def undisturbed(dataset, tmp_path_factory):
    """Folder of a run that nothing happened to."""
    folder = tmp_path_factory.mktemp("undisturbed")
    assert main([str(dataset), "--output", str(folder), "--methods", METHODS, "--workers", "2"], io.StringIO()) == 0
    return folder


def started(dataset, folder, *more):
    words = [sys.executable, "-m", "addon", "evaluate", str(dataset), "--output", str(folder), "--methods", METHODS]
    return subprocess.Popen(
        [*words, *more], cwd=Path(__file__).parents[2], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    )


def results(folder):
    return {path: path.stat().st_mtime_ns for path in (folder / "results").rglob("*.npz")}


def wait_for(condition, process=None):
    until = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < until, "waited in vain"
        if process is not None and process.poll() is not None:
            return
        time.sleep(0.01)


def workers_of(process):
    """Processes that compute: children that have not only to do with keeping track of resources."""
    children = psutil.Process(process.pid).children()
    return [child for child in children if "spawn_main" in " ".join(child.cmdline())]


def finished(process):
    _, told = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0, told


def test_the_run_is_killed(dataset, undisturbed, tmp_path, tables_of):
    chance = random.Random(1)
    total = len(results(undisturbed))
    for kill in range(KILLS):
        before = results(tmp_path)
        process = started(dataset, tmp_path, "--workers", "2")
        wanted = len(before) + chance.randrange(1, total // (KILLS + 1))
        wait_for(lambda wanted=wanted: len(results(tmp_path)) >= wanted, process)
        time.sleep(chance.uniform(0, 0.3))
        workers = workers_of(process)
        assert process.poll() is None, f"kill {kill} came too late"
        process.send_signal(signal.SIGKILL)
        process.wait()
        wait_for(lambda workers=workers: not any(each.is_running() for each in workers))  # they do not stay behind
        assert {path: stamp for path, stamp in results(tmp_path).items() if path in before} == before
    finished(started(dataset, tmp_path, "--workers", "2"))
    assert tables_of(tmp_path) == tables_of(undisturbed)


def test_a_local_worker_is_killed(dataset, undisturbed, tmp_path, tables_of):
    chance = random.Random(2)
    total = len(results(undisturbed))
    process = started(dataset, tmp_path, "--workers", "2")
    for _ in range(KILLS):
        wanted = len(results(tmp_path)) + chance.randrange(1, total // (KILLS + 2))
        wait_for(lambda wanted=wanted: len(results(tmp_path)) >= wanted and workers_of(process))
        time.sleep(chance.uniform(0, 0.2))
        wait_for(lambda: workers_of(process))
        chance.choice(workers_of(process)).kill()
    finished(process)
    assert tables_of(tmp_path) == tables_of(undisturbed)


@pytest.fixture
def cluster(tmp_path):
    """Address of a real Dask scheduler, and the nannies of its two workers."""
    pytest.importorskip("distributed")
    file = tmp_path / "scheduler.json"
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}  # they get the code sent
    quiet: dict[str, Any] = {
        "stdout": subprocess.DEVNULL,
        "stderr": subprocess.DEVNULL,
        "env": environment,
        "cwd": tmp_path,
    }
    dask = [shutil.which("dask", path=str(Path(sys.executable).parent)) or "dask"]
    scheduler = subprocess.Popen(
        [*dask, "scheduler", "--host", "127.0.0.1", "--port", "0", "--dashboard-address", "127.0.0.1:0",
         "--scheduler-file", str(file)], **quiet,
    )  # fmt: skip
    nannies = [
        subprocess.Popen([*dask, "worker", "--scheduler-file", str(file), "--nthreads", "1", "--dashboard-address",
                          "127.0.0.1:0", "--local-directory", str(tmp_path / f"w{k}")], **quiet)
        for k in range(2)
    ]  # fmt: skip
    try:
        wait_for(file.exists)
        yield json.loads(file.read_text())["address"].removeprefix("tcp://"), nannies
    finally:
        for process in (*nannies, scheduler):
            for child in psutil.Process(process.pid).children(recursive=True):
                child.kill()
            process.kill()
            process.wait()


def test_a_dask_worker_is_killed(dataset, undisturbed, tmp_path, tables_of, cluster):
    address, nannies = cluster
    chance = random.Random(3)
    total = len(results(undisturbed))
    folder = tmp_path / "out"
    process = started(dataset, folder, "--scheduler", address)
    for _ in range(KILLS):
        wanted = len(results(folder)) + chance.randrange(1, total // (KILLS + 2))
        wait_for(lambda wanted=wanted: len(results(folder)) >= wanted)
        time.sleep(chance.uniform(0, 0.2))
        wait_for(lambda: any(map(workers_of, nannies)))
        chance.choice([worker for nanny in nannies for worker in workers_of(nanny)]).kill()
    finished(process)
    assert tables_of(folder) == tables_of(undisturbed)


@pytest.mark.parametrize("moment", [0.0, 0.1, 0.5, 2.0])
def test_nothing_lives_on_when_the_run_is_killed(moment, tmp_path):
    vertices, faces = shapes.sphere(2)
    (tmp_path / "in" / "ball").mkdir(parents=True)
    lines = [f"v {x} {y} {z}" for x, y, z in vertices] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]
    for name in ("a.obj", "b.obj"):  # which Blender reads, in another process
        (tmp_path / "in" / "ball" / name).write_text("\n".join(lines))
    process = started(tmp_path / "in", tmp_path / "out", "--workers", "2")
    wait_for(lambda: workers_of(process), process)
    time.sleep(moment)
    children = psutil.Process(process.pid).children(recursive=True)
    process.kill()
    process.wait()
    process.stderr.close()
    assert not psutil.wait_procs(children, timeout=10)[1]
