"""Figures 5 and 6: poses and their forms, and one pose by every method; and the contact sheet of the README."""

import numpy as np
from matplotlib.figure import Figure

from addon.core import canonical_form
from addon.core.measures.alignment import rigid_fit
from addon.core.measures.form_measures import compactness_error
from addon.evaluation.methods import DEFAULT, INPUT, KNOWN
from tools.figures.drawing import show
from tools.figures.models import SIDE, facing

POSES = 6


def draw_poses(models):
    """Draw poses of every shape, and their forms, aligned to the first."""
    return _sheet({label: poses[:POSES] for label, poses in models.items()}, sides=1), {}


def draw_contact_sheet(models):
    """Draw all poses of every shape, and their forms from two sides."""
    return _sheet(models, sides=2), {}


def _sheet(models, sides):
    rows, columns = 1 + sides, max(map(len, models.values()))
    figure = Figure(figsize=(1.7 * columns, 1.7 * rows * len(models)), layout="constrained")
    grid = figure.subplots(rows * len(models), columns, squeeze=False)
    for axes in grid.ravel():
        axes.set_axis_off()
    for row, (label, poses) in enumerate(models.items()):
        first, turns = None, [facing(label), SIDE if facing(label) is not SIDE else np.eye(3)]
        for (pose, vertices, faces), (top, *below) in zip(poses, grid[rows * row : rows * (row + 1)].T, strict=False):
            found = canonical_form(vertices, faces)
            first = found.vertices if first is None else first
            rotation, shift = rigid_fit(found.vertices, first)
            show(top, vertices, faces, turns[0], title=pose)
            for axes, turn in zip(below, turns, strict=False):
                show(axes, found.vertices @ rotation + shift, faces, turn, patches=found.patches)
    return figure


def draw_methods(models):
    names = [INPUT, *DEFAULT]
    labels = list(models)
    figure = Figure(figsize=(1.7 * len(labels) + 1.5, 1.75 * len(names)), layout="constrained")
    grid = figure.subplots(len(names), len(labels), squeeze=False)
    figures = {}
    for column, label in enumerate(labels):
        _, vertices, faces = models[label][-1]
        for row, name in enumerate(names):
            settings = KNOWN[name].settings
            if name.startswith("as-published") and len(vertices) > 8000:
                grid[row, column].text(0.5, 0.5, "(too large)", ha="center", fontsize=8)
                grid[row, column].set_axis_off()
                continue
            form = vertices if settings is None else canonical_form(vertices, faces, settings).vertices
            error = 1e4 * compactness_error(vertices, form, faces)
            figures[f"{label}, {name}"] = error
            show(grid[row, column], form, faces, facing(label), title=f"error {error:.2f}")
    for row, name in zip(grid, names, strict=True):
        row[0].text(-0.08, 0.5, name, transform=row[0].transAxes, ha="right", va="center", fontsize=9)
    return figure, figures
