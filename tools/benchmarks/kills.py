"""Kills a headless run repeatedly at random moments: ``kills.py [COUNT]``.

The run overwrites an existing output. Expected: the output is the complete old or new file, and only partial files
are next to it. Half of the runs write .obj, compared byte by byte; half write .blend, opened again.
"""

import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import bpy

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from tests.meshes import shapes  # noqa: E402


def command(mesh, output, kind, value):
    return [sys.executable, "-m", "addon", "compute", mesh, "--output", output, "--format", kind, "--value", value,
            "--preserve-detail", value, "--quality", "draft", "--max-iterations", "5"]  # fmt: skip


def told(path, kind):
    """Return the content of a file: its bytes, or the value of its shape key."""
    if kind == "obj":
        return path.read_bytes()
    bpy.ops.wm.open_mainfile(filepath=str(path), load_ui=False)
    obj = next(each for each in bpy.data.objects if each.type == "MESH")
    key = obj.data.shape_keys.key_blocks["Canonical Form"]
    return round(key.value, 4), len(key.data)


def main(count=200):
    chance = random.Random(0)
    came: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as folder:
        mesh, output = Path(folder, "mesh.off"), Path(folder, "out")
        shapes.write_off(mesh, *shapes.figure(24))
        for number in range(count):
            kind = ("obj", "blend")[number % 2]
            target = output / f"mesh.{kind}"
            if number < 2:
                seconds, known = {}, {}
                for value in ("0.25", "0.75"):
                    began = time.perf_counter()
                    subprocess.run(command(mesh, output, kind, value), cwd=ROOT, check=True, capture_output=True)
                    seconds[value] = time.perf_counter() - began
                    known[value] = told(target, kind)
                if number == 0:
                    known_by_kind, now = {}, {}
                known_by_kind[kind], now[kind] = known, "0.75"
            new = "0.25" if now[kind] == "0.75" else "0.75"
            began = time.perf_counter()
            process = subprocess.Popen(command(mesh, output, kind, new), cwd=ROOT, stdout=subprocess.DEVNULL,
                                       stderr=subprocess.DEVNULL, start_new_session=True)  # fmt: skip
            late = chance.random() < 0.7  # most near the end, when it writes
            time.sleep(seconds["0.25"] * (chance.uniform(0.75, 1.1) if late else chance.uniform(0, 0.75)))
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
            found = told(target, kind)
            assert found in known_by_kind[kind].values(), f"kill {number}: {target.name} is neither old nor new"
            which = next(value for value, each in known_by_kind[kind].items() if each == found)
            came["new" if which == new else "old"] += 1
            now[kind] = which
            partial = [path for path in output.iterdir() if path.name not in ("mesh.obj", "mesh.blend")]
            assert all(".partial" in path.name for path in partial), partial
            came["partial files"] += len(partial)
            for path in partial:
                path.unlink()
            if number % 20 == 19:
                print(number + 1, "kills:", dict(came), flush=True)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
