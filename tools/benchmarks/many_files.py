"""Two hundred files in one run, with accidents: ``many_files.py CRASHING.blend``, a file that crashes Blender's reader.

198 small meshes, a broken file and the crashing one are computed with ``--jobs 2 --skip-existing``; a worker is killed
on the way, once. Expected: 198 files done, a sentence for each of the other two, nothing half-written. Then three
results are deleted, and a second run makes these three only, within the same sentences.
"""

import shutil
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from tests.blender.batch_processes import busy_worker, ended, started  # noqa: E402
from tests.meshes import shapes  # noqa: E402

COUNT = 198
DELETED = ("007.obj", "070.obj", "170.obj")


def main(crashing: Path) -> None:
    with tempfile.TemporaryDirectory() as folder:
        meshes, out = Path(folder, "meshes"), Path(folder, "out")
        meshes.mkdir()
        for number in range(COUNT):
            shapes.write_off(meshes / f"{number:03}.off", *shapes.figure(12 + number % 5))
        (meshes / "broken.off").write_text("OFF\n3 1 0\n0 0 0\n")
        shutil.copy(crashing, meshes / "crashing.blend")
        told("first run", *ran(meshes, out, killed=1), out)
        for name in DELETED:
            (out / name).unlink()
        told("second run", *ran(meshes, out, killed=0), out)


def ran(meshes: Path, out: Path, *, killed: int) -> tuple[int, list[dict[str, object]], list[str], float]:
    began = time.perf_counter()
    process = started([meshes, "--output", out, "--format", "obj", "--skip-existing", "--jobs", "2"])
    for _ in range(killed):
        busy_worker(process).kill()
    code, lines, errors = ended(process)
    return code, lines, errors.splitlines(), time.perf_counter() - began


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
