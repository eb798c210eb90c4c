"""Draws a contact sheet of poses and forms: ``contact_sheet.py gallery.npz sheet.png``.

Points are drawn at random on the surface, and the one nearest to the viewer is kept for each pixel; the inside of the
surface is red, to reveal inverted parts. Three rows per shape: the poses, the forms aligned to the first of them, and
the same forms seen from another side.
"""

import sys
from pathlib import Path

import matplotlib.image
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from addon.core.measures.alignment import rigid_fit
from addon.evaluation.pictures import drawn

SIDE = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])


def turned_onto(form, first):
    """Align a form to another by a rigid transform."""
    turn, shift = rigid_fit(form, first)
    return form @ turn + shift


def main(gallery, target):
    data = np.load(gallery)
    shapes = sorted({int(name.split("_")[0]) for name in data})
    rows = []
    for shape in shapes:
        poses = sorted({int(name.split("_")[1]) for name in data if name.startswith(f"{shape}_")})
        meshes = [tuple(data[f"{shape}_{pose}_{part}"] for part in "vfx") for pose in poses]
        stands = shape < 2  # the animals of the shared data face along the third axis: show them from the side
        first, second = (SIDE, np.eye(3)) if stands else (np.eye(3), SIDE)
        rows.append(np.hstack([drawn(v, f, first) for v, f, _ in meshes]))
        forms = [(turned_onto(x, meshes[0][2]), f) for _, f, x in meshes]
        rows.append(np.hstack([drawn(x, f, first) for x, f in forms]))
        rows.append(np.hstack([drawn(x, f, second) for x, f in forms]))
    width = max(row.shape[1] for row in rows)
    padded = [np.pad(row, ((0, 0), (0, width - row.shape[1]), (0, 0)), constant_values=255) for row in rows]
    matplotlib.image.imsave(target, np.vstack(padded))


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
