"""Runs the command line on damaged copies of small files of every kind: ``python -m tests.stress.fuzz_files COUNT``.

A problem is a crash, a traceback, more than a minute for a file, or a file written elsewhere; what made it is kept in
build/fuzz-failures. The number is the seed, too.
"""

import collections
import contextlib
import random
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tests.stress.damaged_files import damaged, write_every_kind

ROOT = Path(__file__).resolve().parents[2]
BATCH, PATIENCE = 40, 60.0  # files in one run; seconds for one of them
COMPUTE = (sys.executable, "-m", "addon", "compute")
QUICK = ("--quality", "draft", "--max-iterations", "5", "--landmark-count", "10", "--format", "obj")


def main(files: int) -> int:
    rng, problems = random.Random(files), collections.Counter[str]()
    keep = ROOT / "build" / "fuzz-failures"
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
    print(f"{files} files; problems: {dict(+problems) or 'none'}")
    return int(bool(+problems))


def run_of(files: list[Path], output: Path) -> tuple[int, str, int, float]:
    """Run the command line on files; return its exit code, errors, files done, and the longest time between two."""
    words = [*COMPUTE, *map(str, files), "--output", str(output), *QUICK]
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


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else 1000))
