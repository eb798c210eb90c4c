"""Kills runs that overwrite their output at random moments: ``python -m tests.stress.kills COUNT``.

The output must be the whole old or the whole new file, with nothing but partial files beside it.
"""

import collections
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from tests.meshes import shapes

ROOT = Path(__file__).resolve().parents[2]
COMPUTE = (sys.executable, "-m", "addon", "compute")
QUICK = ("--quality", "draft", "--max-iterations", "5")


def main(count: int) -> None:
    for kind in ("obj", "blend"):
        chance, came = random.Random(0), collections.Counter[str]()
        with tempfile.TemporaryDirectory() as folder:
            mesh, output = Path(folder, "mesh.off"), Path(folder, "out")
            target = output / f"mesh.{kind}"
            shapes.write_off(mesh, *shapes.figure(24))
            words = [*COMPUTE, str(mesh), "--output", str(output), "--format", kind, *QUICK]
            new = {value: [*words, "--value", value, "--preserve-detail", value] for value in ("0.25", "0.75")}
            known = {}
            for value, command in new.items():
                began = time.monotonic()
                subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
                seconds = time.monotonic() - began
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
        print(f"{kind}: {count} kills; the old file {came['old']} times, the new one {came['new']} times", flush=True)


def content(path: Path) -> Any:
    """Return what a file holds: its bytes, or the shape key of a .blend."""
    if path.suffix == ".obj":
        return path.read_bytes()
    import bpy

    bpy.ops.wm.open_mainfile(filepath=str(path), load_ui=False)
    key = next(each for each in bpy.data.objects if each.type == "MESH").data.shape_keys.key_blocks["Canonical Form"]
    return round(key.value, 4), len(key.data)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 100)
