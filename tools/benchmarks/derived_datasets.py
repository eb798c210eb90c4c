"""Derives datasets from one of posed meshes: ``derived_datasets.py KIND FOLDER TARGET COUNT``.

coarse: every pose with about COUNT vertices, the same in all poses of a shape, so that slow methods can run in full.
perturbed: COUNT meshes, the poses in turn with different noise, size and position, in ten classes of the same
mixture, for long runs: any growth is then not caused by the meshes.
creatures: a class for each rigged, animated .glb of the folder, with its largest piece in COUNT poses: the rest pose,
if there is one, and the middle of its other clips, as far as there are any; .obj files with the same vertex order.
classes: the poses of FOLDER next to the creatures of its subfolder of that name, as derived above.
"""

import shutil
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from addon.core.mesh.coarsening import coarsened
from tests.meshes.shapes import poses_of, write_obj, write_off


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


def creatures(source, target, count):
    from addon.core.assembly.pieces import connected_pieces
    from tools.benchmarks.characters import posed

    for file in sorted(source.glob("*-animations.glb")):
        name = file.stem.removesuffix("-animations")
        poses, faces = posed(file, count)
        poses = [pose for k, pose in enumerate(poses) if not any(np.array_equal(pose, other) for other in poses[:k])]
        largest = max(connected_pieces(poses[0], faces).pieces, key=lambda piece: len(piece.vertices))
        for number, vertices in enumerate(poses):
            write_obj(target / name / f"{'rest' if number == 0 else f'clip-{number}'}.obj",
                      vertices[largest.vertices], largest.faces)  # fmt: skip


def classes(source, target, count):
    for folder in sorted(path for path in source.iterdir() if any(path.glob("*.obj"))):
        shutil.copytree(folder, target / folder.name, dirs_exist_ok=True)
    creatures(source / "creatures", target, count)


KINDS = {"coarse": coarse, "perturbed": perturbed, "creatures": creatures, "classes": classes}

if __name__ == "__main__":
    kind, source, target, count = sys.argv[1:]
    KINDS[kind](Path(source), Path(target), int(count))
