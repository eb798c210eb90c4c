"""Makes datasets out of one of posed meshes: ``derived_datasets.py coarse|perturbed FOLDER TARGET COUNT``.

coarse: every pose with about COUNT vertices, the same in all poses of a shape, so that slow methods can run in full.
perturbed: COUNT meshes, the poses one after the other with other noise, size and place each, in ten classes of the
same mixture, for long runs: what grows then is not the meshes.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from addon.core.mesh.coarsening import coarsened
from tests.meshes.shapes import poses_of, write_off


def coarse(source, target, count):
    for folder in sorted(path for path in source.iterdir() if path.is_dir()):
        poses = poses_of(folder)
        fewer = coarsened(poses[0][1], poses[0][2], count)
        for name, vertices, _ in poses:
            write_off(target / folder.name / f"{name}.off", vertices[fewer.kept], fewer.faces)


def perturbed(source, target, count):
    rng = np.random.default_rng(0)
    shapes = [(folder.name, poses_of(folder)) for folder in sorted(source.iterdir()) if folder.is_dir()]
    poses = [(label, *pose) for label, those in shapes for pose in those]
    for number in range(count):
        label, name, vertices, faces = poses[number % len(poses)]
        edge = np.linalg.norm(vertices[faces[:, 0]] - vertices[faces[:, 1]], axis=1).mean()
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        moved = (vertices + 0.05 * edge * rng.normal(size=vertices.shape)) @ (turn * np.sign(np.linalg.det(turn)))
        part = target / f"part-{10 * number // count}"  # all sizes in every tenth of a run
        write_off(part / f"{number:04d}-{label}-{name}.off", rng.uniform(0.5, 2) * moved, faces)


if __name__ == "__main__":
    kind, source, target, count = sys.argv[1:]
    {"coarse": coarse, "perturbed": perturbed}[kind](Path(source), Path(target), int(count))
