"""Draws a contact sheet of poses and forms: ``contact_sheet.py gallery.npz sheet.png``.

Points are drawn at random on the surface and the nearest one to the eye is kept for each pixel; the inside of the
surface is red, so that nothing that is inside out can hide. Three rows a shape: the poses, the forms turned onto the
first of them, and the same seen from another side.
"""

import struct
import sys
import zlib
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from addon.core.alignment import rigid_fit

SIZE = 190
POINTS = 600_000
SIDE = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])


def drawn(vertices, faces, turn):
    """Draw one mesh, seen along the third axis after a rotation."""
    rng = np.random.default_rng(0)
    corner = (vertices @ turn)[faces]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    area = np.linalg.norm(normal, axis=1)
    normal /= np.maximum(area, 1e-30)[:, None]
    face = rng.choice(len(faces), POINTS, p=area / area.sum())
    u = rng.random((POINTS, 2))
    root = np.sqrt(u[:, :1])
    at = np.concatenate([1 - root, root * (1 - u[:, 1:]), root * u[:, 1:]], axis=1)
    points = np.einsum("ij,ijk->ik", at, corner[face])
    middle = (points.max(axis=0) + points.min(axis=0)) / 2
    extent = (points.max(axis=0) - points.min(axis=0))[:2].max() * 1.08
    pixel = np.clip(((points - middle) / extent * [1, -1, 0] + 0.5)[:, :2] * SIZE, 0, SIZE - 1).astype(int)
    shade = 0.25 + 0.75 * np.abs(normal[face] @ np.array([0.3, 0.4, 0.87]))
    colour = (
        np.where(normal[face][:, 2:] > 0, [[205.0, 205.0, 212.0]], [[220.0, 60.0, 60.0]])
        * np.minimum(shade, 1)[:, None]
    )
    image = np.full((SIZE, SIZE, 3), 255, np.uint8)
    order = np.argsort(points[:, 2])
    image[pixel[order, 1], pixel[order, 0]] = colour[order].astype(np.uint8)
    return image


def turned_onto(form, first):
    """Turn a form so that it lies on another."""
    turn, shift = rigid_fit(form, first)
    return form @ turn + shift


def write_png(path, image):
    height, width, _ = image.shape
    raw = b"".join(b"\0" + row.tobytes() for row in image)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    path.write_bytes(
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(raw, 9)) + chunk(b"IEND", b"")
    )


def main(gallery, target):
    data = np.load(gallery)
    shapes = sorted({int(name.split("_")[0]) for name in data})
    rows = []
    for shape in shapes:
        poses = sorted({int(name.split("_")[1]) for name in data if name.startswith(f"{shape}_")})
        meshes = [tuple(data[f"{shape}_{pose}_{part}"] for part in "vfx") for pose in poses]
        stands = shape < 2  # the animals of the shared data look along the third axis: see them from the side
        first, second = (SIDE, np.eye(3)) if stands else (np.eye(3), SIDE)
        rows.append(np.hstack([drawn(v, f, first) for v, f, _ in meshes]))
        forms = [(turned_onto(x, meshes[0][2]), f) for _, f, x in meshes]
        rows.append(np.hstack([drawn(x, f, first) for x, f in forms]))
        rows.append(np.hstack([drawn(x, f, second) for x, f in forms]))
    width = max(row.shape[1] for row in rows)
    write_png(
        target,
        np.vstack([np.pad(row, ((0, 0), (0, width - row.shape[1]), (0, 0)), constant_values=255) for row in rows]),
    )


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
