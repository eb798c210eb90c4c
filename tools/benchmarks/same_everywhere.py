"""Compares forms between interpreters and thread counts: ``same_everywhere.py DATA PYTHON …``.

Every given Python computes the forms of one mesh of each kind with one thread, with two threads, and twice in
parallel; prints the largest difference from the first result, in diameters.
"""

import itertools
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))


def compute(data, target):
    """Compute and store the forms, in this interpreter."""
    import scipy

    from addon.core import canonical_form
    from tests.meshes import shapes

    found: dict[str, Any] = {"versions": f"{sys.version.split()[0]}, numpy {np.__version__}, scipy {scipy.__version__}"}
    meshes = {folder.name: shapes.read_obj(sorted(folder.glob("*.obj"))[2]) for folder in sorted(Path(data).iterdir())
              if folder.is_dir()}  # fmt: skip
    meshes["figure"], meshes["sphere"] = shapes.figure(), shapes.sphere(4)
    for name, (vertices, faces) in meshes.items():
        form = canonical_form(vertices, faces)
        found[name], found[f"{name} features"] = form.vertices, form.feature_points
    np.savez(target, **found)


def main(data, *pythons):
    with tempfile.TemporaryDirectory() as folder:
        runs = []
        for number, (python, threads) in enumerate(itertools.product(pythons, (1, 2))):
            target = Path(folder) / f"{number}.npz"
            environment = {**os.environ, "OPENBLAS_NUM_THREADS": str(threads)}
            both = [subprocess.Popen([python, __file__, "one", data, str(where)], cwd=ROOT, env=environment)
                    for where in (target, target.with_suffix(".again.npz"))]  # fmt: skip
            assert all(process.wait() == 0 for process in both)
            runs += [(threads, np.load(path)) for path in (target, target.with_suffix(".again.npz"))]
        first = runs[0][1]
        names = [name for name in first.files if name != "versions" and "features" not in name]
        print("| Python | threads | " + " | ".join(names) + " |\n| --- | --- |" + " ---: |" * len(names))
        for threads, run in runs:
            apart = []
            for name in names:
                size = np.linalg.norm(np.ptp(first[name], axis=0))
                same = np.array_equal(run[f"{name} features"], first[f"{name} features"])
                most = np.linalg.norm(run[name] - first[name], axis=1).max() / size
                apart.append(f"{most:.0e}" if same else f"{most:.0e}, other feature points")
            print(f"| {run['versions']} | {threads} | " + " | ".join(apart) + " |")


if __name__ == "__main__":
    if sys.argv[1] == "one":
        compute(*sys.argv[2:])
    else:
        main(*sys.argv[1:])
