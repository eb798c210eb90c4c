"""Draws the figures of an evaluation."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .methods import INPUT, KNOWN
from .pictures import drawn, upright
from .retrieval import precision_at_recall
from .store import Store
from .tables import MethodTable

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_MOST_CLASSES = 8  # in the gallery


def write_figures(store: Store, tables: Sequence[MethodTable]) -> list[Path]:
    """Draw precision and recall, compactness errors, and a gallery of one form per class and method.

    Parameters
    ----------
    store : Store
        Contains the forms.
    tables : sequence of MethodTable
        The results by method.

    Returns
    -------
    list of Path
        The image files.
    """
    from matplotlib.figure import Figure

    made = []

    def save(figure: Figure, name: str) -> None:
        made.append(store.write_picture(name, figure))

    figure = Figure(figsize=(7, 5), layout="constrained")
    axes = figure.add_subplot(xlabel="recall", ylabel="precision", ylim=(0, 1.03), xlim=(0, 1))
    recall = np.arange(1, 21) / 20
    for table in tables:
        curve = precision_at_recall(table.distances, [shape.label for shape in table.rows])
        axes.plot(recall, curve, label=table.method.name, linestyle="--" if table.method.name == INPUT else "-")
    axes.legend(fontsize="small")
    save(figure, "precision-recall.png")

    methods = [table for table in tables if table.method.name != INPUT and len(table.values("compactness_error"))]
    if methods:
        figure = Figure(figsize=(7, 1 + 0.35 * len(methods)), layout="constrained")
        axes = figure.add_subplot(xlabel="compactness error, × 10⁻⁴", xscale="log")
        names = [table.method.name for table in methods][::-1]
        errors = [1e4 * table.values("compactness_error") for table in methods][::-1]
        axes.barh(names, [float(each.mean()) for each in errors], xerr=[float(each.std()) for each in errors])
        save(figure, "compactness-error.png")
    picture = gallery(store, tables)
    if picture is not None:
        save(picture, "gallery.png")
    return made


def gallery(store: Store, tables: Sequence[MethodTable]) -> Figure | None:
    """Draw the first shape of each class by every method.

    Parameters
    ----------
    store : Store
        Contains the forms.
    tables : sequence of MethodTable
        The results by method.

    Returns
    -------
    matplotlib.figure.Figure or None
        The gallery; None if there is nothing to show.
    """
    from matplotlib.figure import Figure

    labels = sorted({shape.label for table in tables for shape in table.rows})[:_MOST_CLASSES]
    if not labels:
        return None
    figure = Figure(figsize=(1.6 * len(labels) + 1.6, 1.6 * len(tables)), layout="constrained")
    grid = figure.subplots(len(tables), len(labels), squeeze=False)
    for row, table in zip(grid, tables, strict=True):
        for axes, label in zip(row, labels, strict=True):
            axes.set_axis_off()
            shape = next((each for each in table.rows if each.label == label), None)
            form = None if shape is None else store.array(shape, table.method, "form")
            faces = None if shape is None else store.array(shape, KNOWN[INPUT], "faces")
            if form is not None and faces is not None:
                form = form.astype(np.float64)
                axes.imshow(drawn(form, faces, upright(form)))
        row[0].text(-0.05, 0.5, table.method.name, transform=row[0].transAxes, ha="right", va="center", fontsize=9)
    for axes, label in zip(grid[0], labels, strict=True):
        axes.set_title(label, fontsize=9)
    return figure
