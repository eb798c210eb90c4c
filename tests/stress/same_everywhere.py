"""Compares forms between Pythons and numbers of threads: ``python -m tests.stress.same_everywhere DATA PYTHON …``.

Every Python computes the forms of one mesh of each folder with one thread and with two, twice at a time; printed are
the largest differences from the first, over the size.
"""

import itertools
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
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


def main(data: Path, *pythons: str) -> None:
    files = [paths[min(2, len(paths) - 1)] for each in sorted(data.iterdir()) if (paths := sorted(each.glob("*.obj")))]
    first = None
    for python, threads in itertools.product(pythons or (sys.executable,), ("1", "2")):
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
                told = f"{found['versions']}, {threads} threads: {max(apart):.0e}"
                print(told if same else f"{told}, other feature points", flush=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]), *sys.argv[2:])
