"""Two hundred files in one run, with accidents: ``many_files.py CRASHING.blend``, a file that crashes Blender's reader.

198 small meshes, a broken file and the crashing one are computed with ``--jobs 2 --skip-existing``; a worker is killed
on the way, once. Expected: 198 files done, a sentence for each of the other two, nothing half-written. Then three
results are deleted, and a second run makes these three only, within the same sentences.
"""

import json
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import psutil

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from tests.meshes import shapes  # noqa: E402

COUNT = 198
AT_WORK = 4.0  # seconds of processor time after which a worker is past Blender's start
DELETED = ("007.obj", "070.obj", "170.obj")


def main(crashing: Path) -> None:
    with tempfile.TemporaryDirectory() as folder:
        meshes, out = Path(folder, "meshes"), Path(folder, "out")
        meshes.mkdir()
        for number in range(COUNT):
            shapes.write_off(meshes / f"{number:03}.off", *shapes.figure(12 + number % 5))
        (meshes / "broken.off").write_text("OFF\n3 1 0\n0 0 0\n")
        shutil.copy(crashing, meshes / "crashing.blend")
        told("first run", *ran(meshes, out, kill_a_worker), out)
        for name in DELETED:
            (out / name).unlink()
        told("second run", *ran(meshes, out, lambda process: None), out)


def ran(
    meshes: Path, out: Path, meanwhile: Callable[[subprocess.Popen[str]], None]
) -> tuple[int, list[dict[str, object]], list[str], float]:
    began = time.perf_counter()
    words = ["compute", meshes, "--output", out, "--format", "obj", "--skip-existing", "--jobs", "2"]
    with (meshes.parent / "errors").open("w") as errors, (meshes.parent / "lines").open("w") as lines:
        process = subprocess.Popen(
            [sys.executable, "-m", "addon", *map(str, words)], stdout=lines, stderr=errors, text=True, cwd=ROOT
        )
        meanwhile(process)
        code = process.wait()
    found = [json.loads(line) for line in (meshes.parent / "lines").read_text().splitlines()]
    return code, found, (meshes.parent / "errors").read_text().splitlines(), time.perf_counter() - began


def kill_a_worker(process: subprocess.Popen[str]) -> None:
    while process.poll() is None:
        for child in psutil.Process(process.pid).children():
            if child.cpu_times().user > AT_WORK:
                child.kill()
                return
        time.sleep(0.02)


def told(name: str, code: int, lines: list[dict[str, object]], errors: list[str], seconds: float, out: Path) -> None:
    done = [line for line in lines if "error" not in line and not line.get("skipped")]
    skipped = sum(bool(line.get("skipped")) for line in lines)
    partial = [path.name for path in out.iterdir() if path.suffix != ".obj"]
    print(
        f"{name}: exit {code}; {len(done)} done, {skipped} skipped, {len(lines) - len(done) - skipped} failed;"
        f" {len(list(out.glob('*.obj')))} files, partial: {partial or 'none'}; {seconds:.0f} s"
    )
    for line in errors:
        print("   ", line)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
