"""Draws meshes into matplotlib axes: coloured by a field or by patch, with balls at feature points."""

import matplotlib as mpl
import numpy as np

from addon.evaluation.pictures import drawn
from tests.meshes import shapes

BALL = np.array([200.0, 20.0, 20.0])
FRONT = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])  # a view of what stands along the third axis


def colours_by_patch(patches):
    """Return a colour for each vertex, 0 to 255."""
    return 255 * mpl.colormaps["tab10"](np.asarray(patches) % 10)[:, :3]


def show(
    axes, vertices, faces, turn=None, field=None, patches=None, colours=None, points=(), size=320, title="", under=""
):
    """Draw one mesh and hide the axes."""
    if colours is None:
        colours = np.tile([205.0, 205.0, 212.0], (len(vertices), 1))
    if field is not None:
        low, high = np.quantile(field, [0.01, 0.99])
        colours = 255 * mpl.colormaps["viridis"]((field - low) / max(high - low, 1e-300))[:, :3]
    if patches is not None:
        colours = colours_by_patch(patches)
    parts, triangles, paints, count = [vertices], [faces], [colours], len(vertices)
    ball, ball_faces = shapes.sphere(2)
    radius = 0.022 * np.linalg.norm(np.ptp(vertices, axis=0))
    for point in points:
        parts.append(vertices[point] + radius * ball)
        triangles.append(ball_faces + count)
        paints.append(np.tile(BALL, (len(ball), 1)))
        count += len(ball)
    image = drawn(np.concatenate(parts), np.concatenate(triangles), turn, size, np.concatenate(paints))
    axes.imshow(image)
    axes.set_axis_off()
    if title:
        axes.set_title(title, fontsize=8)
    if under:
        axes.text(0.5, -0.02, under, transform=axes.transAxes, ha="center", va="top", fontsize=8)
