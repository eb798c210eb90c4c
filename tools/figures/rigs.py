"""Bones as solids, and a pose that waves, for pictures of rigs."""

import numpy as np

WAVE = {  # degrees about the axes of the body
    "upper_arm.R": (0, -20, 0), "forearm.R": (0, 100, 0), "upper_arm.L": (0, 55, 0), "forearm.L": (0, 30, -30),
    "thigh.L": (-25, 0, 0), "shin.L": (60, 0, 0), "spine.006": (0, -10, 15),
}  # fmt: skip
BEFORE = 3.0  # towards the eye, so that the skin does not hide the bones


def spindles(skeleton):
    """Make an octahedron of each bone."""
    corners: list[np.ndarray] = []
    triangles: list[list[int]] = []
    for head, tail in zip(skeleton.heads, skeleton.tails, strict=True):
        way = tail - head
        across = np.cross(way, np.eye(3)[np.argmin(np.abs(way))])
        across *= 0.1 * np.linalg.norm(way) / np.linalg.norm(across)
        other = np.cross(way, across) / np.linalg.norm(way)
        ring = head + 0.15 * way + np.array([across, other, -across, -other])
        start = 6 * len(corners)
        corners.append(np.vstack([head, ring, tail]))
        for one in range(4):
            two = (one + 1) % 4
            triangles += [[start, start + 1 + two, start + 1 + one], [start + 5, start + 1 + one, start + 1 + two]]
    return np.concatenate(corners), np.array(triangles)
