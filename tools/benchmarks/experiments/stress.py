"""Stress runs, measured by name only: damaged files, kills, random walks, other interpreters. AMOUNT=: how many."""

import collections
import contextlib
import itertools
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from tests.meshes import shapes
from tests.meshes.damaged_files import damaged, write_every_kind
from tools.benchmarks.experiment import Row, experiment
from tools.benchmarks.measuring import timed
from tools.benchmarks.mesh_sets import Body, folders, generated, together
from tools.benchmarks.results import KEPT, ROOT

BATCH, PATIENCE = 40, 60.0  # files in one run; seconds for one of them
QUICK = ("--quality", "draft", "--max-iterations", "5", "--landmark-count", "10")
COMPUTE = (sys.executable, "-m", "addon", "compute")


NOTHING = generated(figure=lambda: shapes.figure(12))


@experiment("fuzz", NOTHING, settings={"1000": 1000}, kind="stress")
def fuzz(_: Body, files: int) -> Iterator[Row]:
    """The command line on damaged copies of small files of every kind. A problem is a crash, a traceback, more
    than 60 s for a file, or a file written elsewhere; what made it is kept in build/benchmarks.
    """
    rng, problems = random.Random(files), collections.Counter[str]()
    keep = KEPT / "fuzz-failures"
    with tempfile.TemporaryDirectory() as folder:
        sound = write_every_kind(Path(folder, "sound"))
        for first in range(0, files, BATCH):
            box = Path(folder, f"{first}")
            box.mkdir()
            left = []
            for number in range(first, min(first + BATCH, files)):
                source = rng.choice(sound)
                left.append(box / f"f{number}{source.suffix}")
                left[-1].write_bytes(damaged(source, rng))
            there = sorted(box.iterdir())
            while left:
                code, told, done, slowest = run_of(left, box.with_name("out"))
                found = [kind for kind, here in (("traceback", "Traceback" in told), ("slow", slowest > PATIENCE),
                                                 (f"exit {code}", code not in (0, 1))) if here]  # fmt: skip
                problems.update(found)
                if found:  # kept to be looked at: the files of the run, and what it said
                    keep.mkdir(parents=True, exist_ok=True)
                    (keep / f"{first}-{'-'.join(found)}.txt").write_text(told)
                    for path in left:
                        (keep / path.name).write_bytes(path.read_bytes())
                left = left[done + 1 :] if code not in (0, 1) else []
            problems["written elsewhere"] += sorted(box.iterdir()) != there
    yield {"files": files, "problems": ", ".join(f"{count} {kind}" for kind, count in (+problems).items()) or "none"}


def run_of(files: list[Path], output: Path) -> tuple[int, str, int, float]:
    """Run the command line on files; return its exit code, errors, files done, and the longest time between two."""
    words = [*COMPUTE, *map(str, files), "--output", str(output), *QUICK, "--format", "obj"]
    began, slowest, done = time.monotonic(), 0.0, 0
    with tempfile.TemporaryFile("w+", errors="replace") as errors:
        process = subprocess.Popen(words, cwd=ROOT, stdout=subprocess.PIPE, stderr=errors, text=True,
                                   start_new_session=True)  # fmt: skip
        with contextlib.closing(process.stdout) as lines:  # type: ignore[type-var]
            for _ in lines:  # type: ignore[union-attr]
                now = time.monotonic()
                slowest, began, done = max(slowest, now - began if done else 0.0), now, done + 1
        code = process.wait(PATIENCE * len(files))
        errors.seek(0)
        return code, errors.read(), done, slowest


@experiment("kills", NOTHING, settings={"100": 100}, kind="stress")
def kills(_: Body, count: int) -> Iterator[Row]:
    """Runs that overwrite their output, killed at random moments: the output is the whole old or the whole new
    file.
    """
    for kind in ("obj", "blend"):
        chance, came = random.Random(0), collections.Counter[str]()
        with tempfile.TemporaryDirectory() as folder:
            mesh, output = Path(folder, "mesh.off"), Path(folder, "out")
            target = output / f"mesh.{kind}"
            shapes.write_off(mesh, *shapes.figure(24))
            words = [*COMPUTE, str(mesh), "--output", str(output), "--format", kind, *QUICK[:4]]
            new = {value: [*words, "--value", value, "--preserve-detail", value] for value in ("0.25", "0.75")}
            known = {}
            for value, command in new.items():
                _, seconds = timed(subprocess.run, command, cwd=ROOT, check=True, capture_output=True)
                known[value] = content(target)
            now = "0.75"
            for number in range(count):
                value = "0.25" if now == "0.75" else "0.75"
                process = subprocess.Popen(new[value], cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                           start_new_session=True)  # fmt: skip
                late = chance.random() < 0.7  # most near the end, when it writes
                time.sleep(seconds * (chance.uniform(0.75, 1.1) if late else chance.uniform(0, 0.75)))
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()
                found = content(target)
                if found not in known.values():
                    raise AssertionError(f"Kill {number}: {target.name} is neither the old file nor the new one.")
                now = next(each for each, whole in known.items() if whole == found)
                came["new" if now == value else "old"] += 1
                for path in set(output.iterdir()) - {target}:
                    if ".partial" not in path.name:
                        raise AssertionError(f"Kill {number}: {path.name} was left behind.")
                    path.unlink()
        yield {"kind": kind, "kills": count, "old file": came["old"], "new file": came["new"]}


def content(path: Path) -> Any:
    """Return what a file holds: its bytes, or the shape key of a .blend."""
    if path.suffix == ".obj":
        return path.read_bytes()
    import bpy

    bpy.ops.wm.open_mainfile(filepath=str(path), load_ui=False)
    key = next(each for each in bpy.data.objects if each.type == "MESH").data.shape_keys.key_blocks["Canonical Form"]
    return round(key.value, 4), len(key.data)


@experiment("walks", NOTHING, settings={"20": 20}, kind="stress")
def walks(_: Body, count: int) -> Iterator[Row]:
    """Random walks of 500 steps in Blender: after every step of ours, all user data are unchanged."""
    import bpy
    import psutil

    import addon
    from tests.blender.walks import Walk

    memory = []
    for seed in range(count):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        bpy.context.preferences.filepaths.save_version = 0
        addon.register()
        Walk("addon", shapes.figure(12), seed).run(500)
        addon.unregister()
        memory.append(psutil.Process().memory_info().rss)
    yield {"walks": count, "steps": 500 * count, "memory, last / second": memory[-1] / memory[min(1, count - 1)]}


@experiment("interpreters", lambda data: together(folders(data)), kind="stress")
def interpreters(collection: Body, _: Any) -> Iterator[Row]:
    """Forms by several Pythons (CANONICAL_FORM_PYTHONS, separated by spaces), one and two threads, two runs at a
    time: largest difference from the first, over the size.
    """
    files = [body.files[min(2, len(body.files) - 1)] for body in collection.bodies]  # type: ignore[attr-defined]
    pythons = [sys.executable, *os.environ.get("CANONICAL_FORM_PYTHONS", "").split()]
    first = None
    for python, threads in itertools.product(pythons, ("1", "2")):
        environment = os.environ | {"OPENBLAS_NUM_THREADS": threads, "PYTHONPATH": str(ROOT)}
        with tempfile.TemporaryDirectory() as folder:
            targets = [Path(folder, f"{number}.npz") for number in range(2)]
            both = [subprocess.Popen([python, "-c", FORMS_OF, str(target), *map(str, files)], cwd=ROOT, env=environment)
                    for target in targets]  # fmt: skip
            if sum(process.wait() for process in both):
                raise RuntimeError(f"{python} could not compute forms: it needs numpy and scipy.")
            for target in targets:
                found = dict(np.load(target))
                first = first or found
                apart = [np.abs(found[name] - first[name]).max() / np.ptp(first[name], axis=0).max()
                         for name in first if name.endswith(".obj")]  # fmt: skip
                same = all(np.array_equal(found[name], first[name]) for name in first if name.endswith("features"))
                yield {
                    "Python": str(found["versions"]),
                    "threads": threads,
                    "largest difference": max(apart),
                    "feature points": "the same" if same else "others",
                }


FORMS_OF = """
import sys, numpy, scipy
from pathlib import Path
from addon.core import canonical_form
from tests.meshes.shapes import read_obj
found = {"versions": f"{sys.version.split()[0]}, numpy {numpy.__version__}, scipy {scipy.__version__}"}
for path in sys.argv[2:]:
    form = canonical_form(*read_obj(Path(path)))
    found |= {path: form.vertices, f"{path} features": form.feature_points}
numpy.savez(sys.argv[1], **found)
"""
