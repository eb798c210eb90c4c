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
from contextlib import suppress
from pathlib import Path

import psutil
import pytest

from addon.evaluation.command import main
from addon.scheduling.attempts import Failure
from addon.scheduling.crews import crew
from tests.meshes import shapes

METHODS = "fast,classical"
KILLS = 2  # of the run; a worker dies once: the batch tests kill one twice
PATIENCE = 120  # seconds


@pytest.fixture(scope="module")
def undisturbed(dataset, tmp_path_factory):
    """Folder of a run that nothing happened to."""
    folder = tmp_path_factory.mktemp("undisturbed")
    assert main([str(dataset), "--output", str(folder), "--methods", METHODS, "--workers", "2"], io.StringIO()) == 0
    return folder


class Evaluation(subprocess.Popen):
    """An evaluation in a process of its own; its messages go to a file, since a full pipe would stop it."""

    def __init__(self, dataset, folder, *more):
        words = [sys.executable, "-m", "addon", "evaluate", str(dataset), "--output", str(folder), "--methods", METHODS]
        self.messages = folder.with_name(f"{folder.name}.stderr")
        with self.messages.open("w") as stream:
            super().__init__([*words, *more], cwd=Path(__file__).parents[2], stdout=subprocess.DEVNULL, stderr=stream)

    def state(self):
        """Tell whether it runs, and all that it has told."""
        runs = "it runs" if self.poll() is None else f"it ended with {self.returncode}"
        return f"{runs}; it told:\n{self.messages.read_text()}"


def results(folder):
    return {path: path.stat().st_mtime_ns for path in (folder / "results").rglob("*.npz")}


def wait_for(condition, evaluation=None):
    """Wait for a condition, and return what made it true; if it is for an evaluation to meet, that must not end before.

    What comes and goes, such as processes, is to be taken from here: asked for again, it may have gone.
    """
    until = time.monotonic() + PATIENCE
    while not (met := condition()):
        assert evaluation is None or evaluation.poll() is None, f"waited for an evaluation: {evaluation.state()}"
        assert time.monotonic() < until, f"waited in vain{f': {evaluation.state()}' if evaluation else ''}"
        time.sleep(0.01)
    return met


def workers_of(process):
    """Processes that compute: children alive that have not only to do with keeping track of resources."""
    workers = []
    for child in psutil.Process(process.pid).children():
        with suppress(psutil.NoSuchProcess):  # killed before, and its parent has not taken note yet
            if "spawn_main" in " ".join(child.cmdline()):
                workers.append(child)
    return workers


def finished(evaluation):
    with suppress(subprocess.TimeoutExpired):
        evaluation.wait(PATIENCE)
    assert evaluation.poll() == 0, evaluation.state()


def test_the_run_is_killed(dataset, undisturbed, tmp_path, tables_of):
    chance = random.Random(1)
    total = len(results(undisturbed))
    for kill in range(KILLS):
        before = results(tmp_path)
        process = Evaluation(dataset, tmp_path, "--workers", "2")
        wanted = len(before) + chance.randrange(1, total // (KILLS + 1))
        wait_for(lambda wanted=wanted: len(results(tmp_path)) >= wanted, process)
        time.sleep(chance.uniform(0, 0.3))
        workers = workers_of(process)
        assert process.poll() is None, f"kill {kill} came too late"
        process.send_signal(signal.SIGKILL)
        process.wait()
        wait_for(lambda workers=workers: not any(each.is_running() for each in workers))  # they do not stay behind
        assert {path: stamp for path, stamp in results(tmp_path).items() if path in before} == before
    finished(Evaluation(dataset, tmp_path, "--workers", "2"))
    assert tables_of(tmp_path) == tables_of(undisturbed)


def test_a_local_worker_is_killed(dataset, undisturbed, tmp_path, tables_of):
    chance = random.Random(2)
    total = len(results(undisturbed))
    process = Evaluation(dataset, tmp_path, "--workers", "2")
    wait_for(lambda: len(results(tmp_path)) >= total // 3 and workers_of(process), process)
    time.sleep(chance.uniform(0, 0.2))
    chance.choice(wait_for(lambda: workers_of(process), process)).kill()
    finished(process)
    assert tables_of(tmp_path) == tables_of(undisturbed)


@pytest.fixture
def cluster(tmp_path):
    """Address of a real Dask scheduler, and the nannies of its two workers, which are up."""
    pytest.importorskip("distributed")
    file = tmp_path / "scheduler.json"
    logs = {name: tmp_path / f"{name}.log" for name in ("scheduler", "nanny 0", "nanny 1")}
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}  # they get the code sent
    words = ["--scheduler-file", str(file), "--dashboard-address", "127.0.0.1:0"]

    def dask(name, *more):
        command = shutil.which("dask", path=str(Path(sys.executable).parent)) or "dask"
        with logs[name].open("w") as log:
            return subprocess.Popen([command, *more, *words], stdout=log, stderr=log, env=environment, cwd=tmp_path)

    scheduler = dask("scheduler", "scheduler", "--host", "127.0.0.1", "--port", "0")
    nannies = [
        dask(f"nanny {k}", "worker", "--nthreads", "1", "--local-directory", str(tmp_path / f"w{k}")) for k in range(2)
    ]
    try:
        wait_for(lambda: file.exists() and file.read_text().endswith("}"))  # whole
        address = json.loads(file.read_text())["address"]
        wait_for_nannies(address, len(nannies))
        yield address.removeprefix("tcp://"), nannies
    finally:
        for process in (*nannies, scheduler):
            for child in psutil.Process(process.pid).children(recursive=True):
                child.kill()
            process.kill()
            process.wait()
        for name, log in logs.items():  # shown if the test fails
            print(f"--- {name}\n{log.read_text()}")


def wait_for_nannies(address, count):
    """Wait until the nannies have started, not only their workers.

    A nanny gives up, and its worker with it, if that dies before: "Nanny failed to start worker process".
    """
    from distributed import Client

    with Client(address, timeout=PATIENCE) as client:
        client.wait_for_workers(count, timeout=PATIENCE)
        client.run(os.getpid, nanny=True)  # a nanny answers when it has started


def test_a_dask_worker_is_killed(dataset, undisturbed, tmp_path, tables_of, cluster):
    address, nannies = cluster
    chance = random.Random(3)
    total = len(results(undisturbed))
    folder = tmp_path / "out"
    process = Evaluation(dataset, folder, "--scheduler", address)
    for _ in range(KILLS):
        wanted = len(results(folder)) + chance.randrange(1, total // (KILLS + 2))
        wait_for(lambda wanted=wanted: len(results(folder)) >= wanted, process)
        time.sleep(chance.uniform(0, 0.2))
        workers = wait_for(lambda: [worker for nanny in nannies for worker in workers_of(nanny)], process)
        assert len(results(folder)) < total, "the kill came too late"
        chance.choice(workers).kill()
    finished(process)
    assert tables_of(folder) == tables_of(undisturbed)


def test_a_result_that_is_lost_with_its_worker_may_fail_when_computed_again(tmp_path, cluster, monkeypatch):
    from distributed import Future

    address, nannies = cluster
    done = tmp_path / "done"
    code = f"import os, pathlib; p = pathlib.Path({str(done)!r}); p.exists() and os._exit(1); p.touch()"
    fetch = Future.result

    def fetch_too_late(future, *arguments, **more):
        if not killed:
            killed.extend(worker for nanny in nannies for worker in workers_of(nanny))
            for worker in killed:
                worker.kill()
            wait_for(lambda: not any(worker.is_running() for worker in killed))
        return fetch(future, *arguments, **more)

    killed: list[psutil.Process] = []
    monkeypatch.setattr(Future, "result", fetch_too_late)
    with crew(0, address) as hired:
        [(name, result)] = hired.results(iter([("piece", (exec, (code,)))]))
    assert killed
    assert name == "piece"
    assert isinstance(result, Failure)
    assert result.died


@pytest.mark.parametrize("moment", [0.0, 0.5])
def test_nothing_lives_on_when_the_run_is_killed(moment, tmp_path):
    vertices, faces = shapes.sphere(2)
    for name in ("a.obj", "b.obj"):
        shapes.write_obj(tmp_path / "in" / "ball" / name, vertices, faces)
    process = Evaluation(tmp_path / "in", tmp_path / "out", "--workers", "2")
    wait_for(lambda: workers_of(process), process)
    time.sleep(moment)
    children = psutil.Process(process.pid).children(recursive=True)
    process.kill()
    process.wait()
    assert not psutil.wait_procs(children, timeout=10)[1]
