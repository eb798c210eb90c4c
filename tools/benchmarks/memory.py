"""Compares the memory estimate with the measured peak: ``memory.py DATA``; one process per mesh; Linux only."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from tests.meshes import shapes
from tests.meshes.families import torus


def made(name, data):
    """Create one of the meshes."""
    first = {animal: sorted((data / animal).glob("*.obj"))[1] for animal in ("bear", "man", "horse")}
    finer = shapes.midpoints
    return {
        "joint": lambda: shapes.joint(80, 40, 25),
        "figure": lambda: shapes.figure(24),
        "horse": lambda: shapes.read_obj(first["horse"]),
        "bear": lambda: shapes.read_obj(first["bear"]),
        "figure, fine": lambda: shapes.figure(48),
        "man": lambda: shapes.read_obj(first["man"]),
        "bear, finer": lambda: finer(*shapes.read_obj(first["bear"])),
        "man, finer": lambda: finer(*shapes.read_obj(first["man"])),
        "torus": lambda: torus(400, 250),
        "man, finer twice": lambda: finer(*finer(*shapes.read_obj(first["man"]))),
        "sphere": lambda: shapes.sphere(8),
        "sheet": lambda: shapes.grid(1000, 1000),
    }[name]()


NAMES = ("joint", "figure", "horse", "bear", "figure, fine", "man", "bear, finer", "man, finer", "torus",
         "man, finer twice", "sphere", "sheet")  # fmt: skip


def measure(name, data, quality):
    """Run one mesh and print its peak in gigabytes, beyond the memory of the process with the mesh loaded."""
    import threading
    import time

    import psutil

    from addon.core import Settings, canonical_form
    from addon.core.method_api.costs import memory_estimate

    vertices, faces = made(name, data)
    settings = Settings(quality=quality, memory_limit=100)
    process, over, peak = psutil.Process(), threading.Event(), [0]

    def watch():
        while not over.is_set():
            peak[0] = max(peak[0], process.memory_info().rss)
            time.sleep(0.002)

    before = process.memory_info().rss
    Path("/proc/self/clear_refs").write_text("5")
    watcher = threading.Thread(target=watch)
    watcher.start()
    canonical_form(vertices, faces, settings)
    over.set()
    watcher.join()
    status = Path("/proc/self/status").read_text()
    highest = int(next(line.split()[1] for line in status.splitlines() if line.startswith("VmHWM"))) * 1024
    peak = (max(peak[0], highest) - before) / 1e9
    print(json.dumps([len(vertices), peak, memory_estimate(len(vertices), settings)]))


def main(data, quality="normal"):
    print("| mesh | vertices | estimate, GB | peak, GB | estimate / peak |\n| --- | ---: | ---: | ---: | ---: |")
    for name in NAMES:
        words = [sys.executable, __file__, "one", name, str(data), quality]
        done = subprocess.run(words, capture_output=True, text=True, check=True)
        count, peak, estimate = json.loads(done.stdout.splitlines()[-1])
        print(f"| {name} | {count:,} | {estimate:.2f} | {peak:.2f} | {estimate / peak:.2f} |", flush=True)


if __name__ == "__main__":
    np.seterr(all="ignore")
    if sys.argv[1] == "one":
        measure(sys.argv[2], Path(sys.argv[3]), sys.argv[4])
    else:
        main(Path(sys.argv[1]), *sys.argv[2:])
