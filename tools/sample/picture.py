"""Draws the picture of a run: input, Auto Diffusion Function with feature points, patches and form side by side."""

import numpy as np
from matplotlib.figure import Figure

from addon.blender.objects.mesh_reading import read_mesh
from tools.figures.drawing import FRONT, show


def draw(body, path):
    """Draw an object with its results to a .png."""
    pose, faces = read_mesh(body.data)
    form = np.array([point.co for point in body.data.shape_keys.key_blocks["Canonical Form"].data])
    index = body.vertex_groups["Feature Points"].index
    features = [vertex.index for vertex in body.data.vertices if any(part.group == index for part in vertex.groups)]
    adf, patches = (colours_of(body.data.color_attributes[name]) for name in ("Auto Diffusion Function", "Patches"))
    figure = Figure(figsize=(16, 4.6), layout="constrained")
    for axes, (title, points, colours, dots) in zip(
        figure.subplots(1, 4),
        (
            ("Input", pose, None, ()),
            ("Auto Diffusion Function and feature points", pose, adf, features),
            ("Patches", pose, patches, ()),
            ("Canonical form", form, patches, ()),
        ),
        strict=True,
    ):
        show(axes, points, faces, FRONT, colours=colours, points=dots, size=640, title=title)
    figure.savefig(path, dpi=100)


def colours_of(attribute):
    """Return the colours of an attribute of the vertices, (n, 3), as they are seen."""
    return 255 * np.array([item.color_srgb[:3] for item in attribute.data])
