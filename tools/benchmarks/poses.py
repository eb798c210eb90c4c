"""Measures the method on real posed meshes: one folder a shape, one .obj a pose, the same vertex order in each.

Run ``.venv/bin/python tools/benchmarks/poses.py DATA``. Prints one line a mesh and, at the end, a table a shape. The
first pose by name among rest and bind is the one that feature points are compared with.
"""

import sys
import time
from pathlib import Path

import numpy as np
import pygeodesic.geodesic

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from addon.core import Settings, canonical_form  # noqa: E402
from addon.core.distance_fields import heat_geodesics  # noqa: E402
from tests.meshes.shapes import read_obj  # noqa: E402

SOURCES = 20
STEPS = 300


def main(data: Path) -> None:
    rows = []
    for folder in sorted(path for path in data.iterdir() if path.is_dir()):
        poses = sorted(folder.glob("*.obj"), key=lambda path: (path.stem not in ("rest", "bind"), path.stem))
        rest = None
        for path in poses:
            vertices, faces = read_obj(path)
            row, features = measured(vertices, faces)
            if rest is None:
                between = heat_geodesics(vertices, faces, features)
                rest = between / between.max()
            row["farthest feature"] = float(rest[features].min(axis=1).max())
            rows.append((folder.name, path.stem, row))
            print(folder.name, path.stem, {name: float(f"{value:.4g}") for name, value in row.items()}, flush=True)
    names = list(rows[0][2])
    print(f"\n| shape | pose | {' | '.join(names)} |\n|{' --- |' * (len(names) + 2)}")
    for shape, pose, row in rows:
        print(f"| {shape} | {pose} | {' | '.join(f'{row[name]:.3g}' for name in names)} |")


def measured(vertices, faces):
    """Feature points, error of the heat geodesics, largest rise of the stress and the longest wait of a cancel."""
    sources = np.random.default_rng(7).choice(len(vertices), SOURCES, replace=False)
    solver = pygeodesic.geodesic.PyGeodesicAlgorithmExact(vertices, faces)
    true = np.stack([solver.geodesicDistances(np.array([source]))[0] for source in sources], axis=1)
    heat = heat_geodesics(vertices, faces, sources)
    asked = [time.perf_counter()]

    def never() -> bool:
        asked.append(time.perf_counter())
        return False

    form = canonical_form(
        vertices,
        faces,
        Settings(max_iterations=STEPS, tolerance=0.0),
        cancelled=never,
    )
    return {
        "features": len(form.feature_points),
        "heat error": float((np.abs(heat - true)[true > 0] / true[true > 0]).mean()),
        "steps": len(form.stress) - 1,
        "largest rise": float((np.diff(form.stress) / form.stress[:-1]).max()),
        "longest wait (s)": float(np.diff(asked).max()),
        "seconds": sum(form.timings.values()),
    }, form.feature_points


if __name__ == "__main__":
    main(Path(sys.argv[1]))
