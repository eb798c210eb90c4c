"""Measures the method on real posed meshes: one folder per shape, one .obj per pose, the same vertex order in each.

Run ``.venv/bin/python tools/benchmarks/poses.py DATA``. Prints one row per mesh, and one for the worst. Feature points
are compared with those of the first rest or bind pose by name.
"""

import sys
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
    print("| shape | pose | features | farthest | heat error | largest increase |\n" + "| --- " * 6 + "|")
    rows = []
    for folder in sorted(path for path in data.iterdir() if path.is_dir()):
        poses = sorted(folder.glob("*.obj"), key=lambda path: (path.stem not in ("rest", "bind"), path.stem))
        rest = None
        for path in poses:
            vertices, faces = read_obj(path)
            features, error, increase = measured(vertices, faces)
            if rest is None:
                between = heat_geodesics(vertices, faces, features)
                rest = between / between.max()
            rows.append((len(features), rest[features].min(axis=1).max(), error, increase))
            count, farthest, *_ = rows[-1]
            print(
                f"| {folder.name} | {path.stem} | {count} | {farthest:.1%} | {error:.2%} | {increase:.0e} |", flush=True
            )
    counts, farthest, errors, increases = (np.array(column) for column in zip(*rows, strict=True))
    print(
        f"| all | | {counts.min()}-{counts.max()} | {farthest.max():.1%} | mean {errors.mean():.2%},"
        f" worst {errors.max():.2%} | {increases.max():.0e} |"
    )


def measured(vertices, faces):
    """Return feature points, mean relative error of the heat geodesics, largest relative stress increase in a step."""
    sources = np.random.default_rng(7).choice(len(vertices), SOURCES, replace=False)
    solver = pygeodesic.geodesic.PyGeodesicAlgorithmExact(vertices, faces)
    true = np.stack([solver.geodesicDistances(np.array([source]))[0] for source in sources], axis=1)
    heat = heat_geodesics(vertices, faces, sources)
    form = canonical_form(vertices, faces, Settings(method="local_features", max_iterations=STEPS))
    error = (np.abs(heat - true)[true > 0] / true[true > 0]).mean()
    return form.feature_points, float(error), float((np.diff(form.stress) / form.stress[:-1]).max())


if __name__ == "__main__":
    main(Path(sys.argv[1]))
