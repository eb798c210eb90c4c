"""Figure 2: a Swiss roll unrolled by classical scaling, and the convergence of the minimisation."""

import time
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from addon.core.distances.fast_marching import fast_marching
from addon.core.distances.heat import FEWEST, HeatMethod
from addon.core.embedding.classical_scaling import classical_scaling
from addon.core.embedding.smacof import smacof
from addon.core.measures.alignment import rigid_fit
from addon.core.surface.delaunay import intrinsic_delaunay, refined
from addon.core.surface.triangulation import triangulated
from tests.meshes import shapes

TURNS = 1.5
COLOURS = {"fast marching": "tab:orange", "heat": "tab:blue"}


def rolled(columns=46, rows=24):
    """Return a rolled-up rectangle, and the flat rectangle."""
    flat, faces = shapes.grid(columns, rows, 2.0, 1.0)
    radius, growth = 0.12, 0.05
    angle = np.linspace(0, 2 * np.pi * TURNS, 4000)
    reach = radius + growth * angle
    length = np.concatenate([[0], np.cumsum(np.hypot(np.diff(reach * np.cos(angle)), np.diff(reach * np.sin(angle))))])
    flat = flat * [length[-1] / 2.0, 1.0, 1.0]
    at = np.interp(flat[:, 0], length, angle)
    roll = np.column_stack([(radius + growth * at) * np.cos(at), flat[:, 1], (radius + growth * at) * np.sin(at)])
    return roll, flat, faces


def distances(roll, faces, kind):
    surface = triangulated(roll, faces)
    everything = np.arange(len(roll))
    began = time.perf_counter()
    if kind == "fast marching":
        table = np.column_stack([fast_marching(surface, np.array([k])) for k in everything])
    else:
        table = HeatMethod(refined(intrinsic_delaunay(surface), FEWEST), count=len(roll)).distances(everything)
    return (table + table.T) / 2, time.perf_counter() - began


def draw(_models):
    roll, flat, faces = rolled()
    true = np.linalg.norm(flat[:, None] - flat, axis=2)
    figure = Figure(figsize=(11, 6.6), layout="constrained")
    grid: dict[str, Any] = figure.subplot_mosaic([["roll", "fast marching", "heat"], ["steps", "steps", "error"]])
    grid["roll"].remove()
    axes = figure.add_subplot(2, 3, 1, projection="3d")
    axes.plot_trisurf(*roll[:, [0, 2, 1]].T, triangles=faces, cmap="viridis", linewidth=0.1, antialiased=True)
    axes.set_title("Swiss roll", fontsize=9)
    axes.set_axis_off()
    figures, curves = {}, {}
    for kind in ("fast marching", "heat"):
        table, seconds = distances(roll, faces, kind)
        off = ~np.eye(len(table), dtype=bool)
        error = np.abs(table[off] / true[off] - 1)
        plane = np.column_stack([classical_scaling(table, 2)[0], np.zeros(len(table))])
        turn, shift = rigid_fit(plane, flat, mirror=True)
        plane = plane @ turn + shift
        apart = float(np.sqrt(((plane - flat) ** 2).sum(axis=1).mean()))
        grid[kind].triplot(plane[:, 0], plane[:, 1], faces, linewidth=0.3, color="0.3")
        grid[kind].set_aspect("equal")
        off_by = f"distances {error.mean():.1%} off, places {apart:.1%} of the width"
        grid[kind].set_title(f"classical scaling, {kind}\n{off_by}", fontsize=9)
        figures[kind] = {"distance_error": float(error.mean()), "apart": apart, "seconds": seconds}
        curves[kind] = np.sort(error)
        start = np.column_stack([plane[:, :2], 0.3 * np.random.default_rng(0).normal(size=len(plane))])
        for momentum, style in ((False, "--"), (True, "-")):
            history = smacof(table, start, max_iterations=300, tolerance=0.0, momentum=momentum)[1]
            how = "with momentum" if momentum else "plain steps"
            grid["steps"].plot(
                np.arange(1, len(history) + 1), history / history[0], style, label=f"{kind}, {how}", color=COLOURS[kind]
            )
            figures[kind][how] = int(np.argmax(history < 1.01 * history.min()))
    grid["steps"].set(xlabel="steps of SMACOF + 1", ylabel="stress, of the first", yscale="log", xscale="log")
    grid["steps"].legend(fontsize=8)
    for kind, curve in curves.items():
        share = np.linspace(0, 1, 400)
        grid["error"].plot(np.quantile(curve, share), share, label=kind, color=COLOURS[kind])
    grid["error"].set(xlabel="relative error of a distance", ylabel="share of the pairs", xlim=(0, 0.1))
    grid["error"].legend(fontsize=8)
    return figure, figures
