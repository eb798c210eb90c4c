"""The models of the figures: posed meshes from a folder or, without one, the figures of the tests."""

from pathlib import Path

import numpy as np

from tests.meshes import shapes
from tests.meshes.shapes import unit
from tools.benchmarks.mesh_sets import folders

SIDE = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])


def models(folder: Path | None):
    """Return the poses of every shape as ``{shape: [(pose, vertices, faces)]}``, the rest pose first, of unit area."""
    if folder is None:
        return own_models()
    found = {body.name: body.poses for body in folders(folder)}
    return {name: [(pose, unit(vertices, faces), faces) for pose, vertices in zip(names, poses, strict=True)]
            for name, (names, poses, faces) in found.items()}  # fmt: skip


def own_models():
    """Return bent figures and arms of the tests, all from this project."""
    vertices, faces = shapes.figure(24)
    bent = [vertices + 0.2 * k * np.sin(vertices[:, 2:]) * [1.0, 0.6, 0.0] for k in range(4)]
    arms = [shapes.joint(angle) for angle in (0.0, 45.0, 90.0, 120.0)]
    return {
        "figure": [(f"bent {k}", unit(each, faces), faces) for k, each in enumerate(bent)],
        "arm": [(f"bent {k}", unit(*arm[:2]), arm[1]) for k, arm in enumerate(arms)],
    }


def facing(shape):
    """Return a rotation that shows the animals of the shared data, which face along the third axis, from the side."""
    return SIDE if shape in ("bear", "horse") else np.eye(3)
