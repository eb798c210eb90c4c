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
    figure = Figure(figsize=(1.7 * POSES, 3.4 * len(models)), layout="constrained")
    grid = figure.subplots(2 * len(models), POSES)
    for row, (label, poses) in enumerate(models.items()):
        first = None
        for column, (pose, vertices, faces) in enumerate(poses[:POSES]):
            found = canonical_form(vertices, faces)
            form = found.vertices
            if first is None:
                first = form
            turn, shift = rigid_fit(form, first)
            show(grid[2 * row, column], vertices, faces, facing(label), title=pose)
            show(grid[2 * row + 1, column], form @ turn + shift, faces, facing(label), patches=found.patches)
    for axes in grid.ravel():
        axes.set_axis_off()
    return figure, {}


def draw_contact_sheet(models):
    """Draw the poses of every shape, and their forms, aligned to the first, from two sides."""
    columns = max(map(len, models.values()))
    figure = Figure(figsize=(1.6 * columns, 4.8 * len(models)), layout="constrained")
    grid = figure.subplots(3 * len(models), columns, squeeze=False)
    for row, (label, poses) in enumerate(models.items()):
        first, turn = None, facing(label)
        other = np.eye(3) if (turn != np.eye(3)).any() else SIDE
        for (_, vertices, faces), (top, middle, low) in zip(poses, grid[3 * row : 3 * row + 3].T, strict=False):
            form = canonical_form(vertices, faces).vertices
            first = form if first is None else first
            rotation, shift = rigid_fit(form, first)
            show(top, vertices, faces, turn)
            show(middle, form @ rotation + shift, faces, turn)
            show(low, form @ rotation + shift, faces, other)
    for axes in grid.ravel():
        axes.set_axis_off()
    return figure, {}


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
