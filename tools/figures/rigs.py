"""Draws a rig: a figure in stride with the bones that were found, at rest in a T-pose, and in another pose."""

import numpy as np
from matplotlib.figure import Figure

from addon.core import rig
from addon.core.rigging.skeleton import moved_skeleton, skinned
from tests.meshes.bent_rigs import posed
from tools.figures.drawing import BALL, show
from tools.figures.t_poses import FRONT, figure_in_stride

WAVE = {  # degrees about the axes of the body
    "upper_arm.R": (0, -20, 0), "forearm.R": (0, 100, 0), "upper_arm.L": (0, 55, 0), "forearm.L": (0, 30, -30),
    "thigh.L": (-25, 0, 0), "shin.L": (60, 0, 0), "spine.006": (0, -10, 15),
}  # fmt: skip
_BEFORE = 3.0  # towards the eye, so that the skin does not hide the bones


def draw(_models):
    """Draw a figure in stride with the bones that were found, the same at rest, and waving."""
    vertices, faces = figure_in_stride()
    found = rig(vertices, faces, pose="T")
    there = moved_skeleton(found.skeleton, found.to_given)
    wave = posed(found, WAVE)
    columns = [
        (vertices, there, "the scan, and its bones"),
        (found.vertices, found.skeleton, "at rest"),
        (skinned(found.vertices, found.weights, wave), moved_skeleton(found.skeleton, wave), "posed by its rig"),
    ]
    figure = Figure(figsize=(2.6 * len(columns), 3.0), layout="constrained")
    for axes, (points, skeleton, title) in zip(figure.subplots(1, len(columns)), columns, strict=True):
        bones, triangles = spindles(skeleton)
        colours = np.repeat([[205.0, 205.0, 212.0], BALL], [len(points), len(bones)], axis=0)
        whole = np.concatenate([points, bones + _BEFORE * FRONT[:, 2]])
        show(axes, whole, np.concatenate([faces, triangles + len(points)]), FRONT, colours=colours, title=title)
    return figure, {"bones": len(found.skeleton.names), "least sure": float(found.confidence.min().round(2))}


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
