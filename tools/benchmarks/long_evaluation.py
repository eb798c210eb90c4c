"""Runs a long evaluation and measures throughput, overhead and memory: ``long_evaluation.py DATASET OUTPUT``.

Overhead is the share of the workers' time that was not spent on forms. Memory is the resident set size of the run and
all its processes; its growth compares medians of the second and the last tenth of the run.
"""

import re
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import psutil

ROOT = Path(__file__).resolve().parents[2]


def main(dataset, output, *more):
    words = [sys.executable, "-m", "addon", "evaluate", dataset, "--output", output, "--methods", "ours",
             "--workers", "2", "--hausdorff", "0", *more]  # fmt: skip
    process = subprocess.Popen(words, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    watched, samples = psutil.Process(process.pid), []
    began = time.perf_counter()
    while process.poll() is None:
        try:
            each = [one.memory_info().rss / 1e6 for one in [watched, *watched.children(recursive=True)]]
            samples.append((time.perf_counter() - began, sum(each), each[0]))
        except psutil.NoSuchProcess:
            continue
        time.sleep(1)
    told = process.communicate()[1]
    at, whole, driver = np.array(samples).T
    done = len(list((Path(output) / "results" / "ours").rglob("*.npz")))
    busy = re.search(r"forms and \d+ rows in (\d+) s.* (\d+)% of the time", told)
    assert busy, told
    seconds = float(busy[1])
    tenth = seconds / 10
    early, late = ((at > lo * tenth) & (at < hi * tenth) for lo, hi in ((1, 2), (9, 9.9)))
    print(f"{done} meshes in {seconds:.0f} s: {done / seconds:.2f} a second; workers at work {busy[2]} % of the time")
    for name, values in (("all processes", whole), ("the run itself", driver)):
        first, last = np.median(values[early]), np.median(values[late])
        print(f"memory of {name}: {first:.0f} MB early, {last:.0f} MB late, {last / first - 1:+.1%}")


if __name__ == "__main__":
    main(*sys.argv[1:])
