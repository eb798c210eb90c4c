"""Figure 3: geodesic and biharmonic distance on a plane."""

import numpy as np
from matplotlib.figure import Figure

from addon.core.distance_fields import distance_field
from tests.meshes import shapes


def draw(_models):
    vertices, faces = shapes.grid(61, 61)
    sources = {"the middle": 30 * 61 + 30, "a corner": 0}
    figure = Figure(figsize=(9, 6.4), layout="constrained")
    grid = figure.subplots(2, 3)
    figures = {}
    for row, (where, source) in zip(grid, sources.items(), strict=True):
        true = np.linalg.norm(vertices - vertices[source], axis=1)
        fields = {
            "geodesic, exact": true,
            "geodesic, heat method": distance_field(vertices, faces, [source], "heat"),
            "biharmonic": distance_field(vertices, faces, [source], "biharmonic"),
        }
        for axes, (name, field) in zip(row, fields.items(), strict=True):
            axes.tricontourf(*vertices[:, :2].T, faces, field / field.max(), 20, cmap="viridis")
            axes.tricontour(*vertices[:, :2].T, faces, field / field.max(), 20, colors="white", linewidths=0.4)
            axes.set_aspect("equal")
            axes.set_axis_off()
            axes.set_title(f"{name}, from {where}", fontsize=9)
        away = true > 0
        figures[where] = float(np.abs(fields["geodesic, heat method"][away] / true[away] - 1).mean())
    return figure, figures
