"""Writes the tables of an evaluation as CSV and Markdown."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from .dataset import Shape
from .descriptor import DEGREES, SHELLS
from .methods import INPUT, Method
from .pair_descriptor import COSINES, DISTANCES, POINTS
from .retrieval import Retrieval, tier_lead
from .running import Rows, row_name
from .store import Store
from .tables import MethodTable
from .writing import csv_text, markdown_table, number, short

FIGURES = (
    "vertices", "faces", "features", "pair_count", "compactness", "compactness_error", "edge_distortion_median",
    "edge_distortion_95", "edge_distortion_999", "area_distortion_median", "area_distortion_95", "thickness_median",
    "thickness_95", "crossings_added", "jags", "border_jags", "hausdorff", "scale", "warnings", "unfinished",
)  # fmt: skip


def write_report(
    store: Store, shapes: Sequence[Shape], tables: Sequence[MethodTable], rows: Rows, lost_rows: dict[str, str]
) -> list[Path]:
    """Write all tables. Times and memory are in separate files; everything else is identical in every run.

    Parameters
    ----------
    store : Store
        Where to write, and where the Hausdorff distances are.
    shapes : sequence of Shape
        The dataset.
    tables : sequence of MethodTable
        The results by method.
    rows : dict
        Rows of the Hausdorff matrices, from `hausdorff_rows`.
    lost_rows : dict of str to str
        Reasons for missing rows.

    Returns
    -------
    list of Path
        The written files.
    """
    labels = sorted({shape.label for shape in shapes})
    matrices = {
        (table.method.name, label): _hausdorff_matrix(store, rows, table.method, label)
        for table in tables
        for label in labels
    }
    files = {
        "results.csv": csv_text(
            ["class", "shape", "method", *FIGURES, "error"],
            (
                [shape.label, shape.name, table.method.name]
                + [number(table.rows.get(shape, {}).get(figure)) for figure in FIGURES]
                + [table.failures.get(shape, "")]
                for table in tables
                for shape in shapes
            ),
        ),
        "classes.csv": csv_text(
            _CLASS_HEAD,
            (_class_line(table, matrices[table.method.name, label][1], label) for table in tables for label in labels),
        ),
        "methods.csv": csv_text(_METHOD_HEAD, (_method_line(table, matrices, labels) for table in tables)),
        "costs.csv": csv_text(
            ["class", "shape", "method", "vertices", "seconds", "all_seconds", "memory_megabytes"],
            (
                [shape.label, shape.name, table.method.name, table.rows[shape]["vertices"]]
                + [number(cost.get(name)) for name in ("seconds", "all_seconds", "memory")]
                for table in tables
                for shape, cost in table.costs.items()
            ),
        ),
        "report.md": report_text(shapes, tables, matrices, lost_rows),
        "costs.md": costs_text(tables),
    }
    for table in tables:
        names = [f"{shape.label}/{shape.name}" for shape in table.rows]
        for kind, matrix in (("descriptor", table.distances), ("pair", table.pair_distances)):
            files[f"{kind}-distances-{table.method.name}.csv"] = csv_text(
                ["", *names], ([name, *map(number, row)] for name, row in zip(names, matrix, strict=True))
            )
    for (name, label), (some, matrix) in matrices.items():
        if len(some) > 1:
            files[f"hausdorff-{name}@{label}.csv"] = csv_text(
                ["", *(shape.name for shape in some)],
                ([shape.name, *map(number, row)] for shape, row in zip(some, matrix, strict=True)),
            )
    written = [store.write_text(name, text) for name, text in files.items()]
    for kind in ("hausdorff-*.csv", "descriptor-distances-*.csv", "pair-distances-*.csv"):
        for old in set(store.folder.glob(kind)) - set(written):  # from a run with other methods or classes
            old.unlink()
    return written


_DETAIL = {  # in addition to the median and 95th percentile of the edges; with column headings
    "edge_distortion_999": "99.9 %",
    "area_distortion_median": "areas, median",
    "area_distortion_95": "95 %",
    "thickness_median": "thickness, median",
    "thickness_95": "95 %",
    "crossings_added": "crossings added",
    "jags": "jags",
    "border_jags": "at borders",
}
_CLASS_HEAD = (
    "method", "class", "shapes", "compactness_error_mean_e4", "compactness_error_deviation_e4",
    "edge_distortion_median_mean", "edge_distortion_95_mean", "hausdorff_mean", "hausdorff_within_class",
    "pose_ratio", "pose_ratio_mirrored", *(f"{name}_mean" for name in _DETAIL), "scale_mean", "not_converged",
)  # fmt: skip
_METHOD_HEAD = (
    "method", "done", "failed", "compactness_error_mean_e4", "compactness_error_deviation_e4",
    "edge_distortion_median_mean", "edge_distortion_95_mean", "hausdorff_mean", "hausdorff_within_classes",
    "pose_ratio", "pose_ratio_mirrored", "nearest_neighbour", "first_tier", "second_tier", "discounted_gain",
    "pair_nearest_neighbour", "pair_first_tier", "pair_second_tier", "pair_discounted_gain",
    *(f"{name}_mean" for name in _DETAIL), "scale_mean", "not_converged",
)  # fmt: skip


def _class_line(table: MethodTable, within: np.ndarray, label: str) -> list[str]:
    error = 1e4 * table.values("compactness_error", label)
    pose = table.poses.get(label)
    return [
        table.method.name,
        label,
        str(len(table.values("vertices", label))),
        *map(number, [_mean(error), _deviation(error)]),
        *(number(_mean(table.values(name, label))) for name in _MEANS),
        number(_mean(_upper(within))),
        *map(number, [pose.ratio, pose.ratio_mirrored] if pose else [None, None]),
        *(number(_mean(table.values(name, label))) for name in (*_DETAIL, "scale")),
        number(table.values("unfinished", label).sum()),
    ]


_MEANS = ("edge_distortion_median", "edge_distortion_95", "hausdorff")


def _method_line(table: MethodTable, matrices: dict[tuple[str, str], Any], labels: list[str]) -> list[str]:
    error = 1e4 * table.values("compactness_error")
    within = [_mean(_upper(matrices[table.method.name, label][1])) for label in labels]
    return [
        table.method.name,
        str(len(table.rows)),
        str(len(table.failures)),
        *map(number, [_mean(error), _deviation(error)]),
        *(number(_mean(table.values(name))) for name in _MEANS),
        number(_mean(np.array([each for each in within if np.isfinite(each)]))),
        *map(number, [table.pose_ratio(), table.pose_ratio(mirrored=True)]),
        *_found(table.found),
        *_found(table.found_by_pairs),
        *(number(_mean(table.values(name))) for name in (*_DETAIL, "scale")),
        number(table.values("unfinished").sum()),
    ]


def _found(found: Retrieval) -> list[str]:
    return list(map(number, [found.nearest_neighbour, found.first_tier, found.second_tier, found.discounted_gain]))


def _retrieval_line(table: MethodTable, first: MethodTable) -> list[str]:
    """Format retrieval by both descriptors, and how far the first method is ahead."""
    line = [table.method.name]
    for found, ahead in ((table.found_by_pairs, first.found_by_pairs), (table.found, first.found)):
        lead = "" if table is first else " ± ".join(short(number(each)) for each in tier_lead(ahead, found))
        line += [*map(short, _found(found)), lead]
    return line


def _detail_line(table: MethodTable) -> list[str]:
    """Format how much of the surface a method preserves, in hundredths."""
    names = ["edge_distortion_median", "edge_distortion_95", *_DETAIL]
    means = [_mean(table.values(name)) for name in names]
    return [table.method.name, *("" if np.isnan(mean) else f"{100 * mean:.2f}" for mean in means)]


def report_text(
    shapes: Sequence[Shape],
    tables: Sequence[MethodTable],
    matrices: dict[tuple[str, str], Any],
    lost_rows: dict[str, str],
) -> str:
    """Write the report in Markdown.

    Parameters
    ----------
    shapes : sequence of Shape
        The dataset.
    tables : sequence of MethodTable
        The results by method.
    matrices : dict
        Hausdorff matrices by method and class.
    lost_rows : dict of str to str
        Reasons for missing rows of these matrices.

    Returns
    -------
    str
        The report.
    """
    labels = sorted({shape.label for shape in shapes})
    sizes = [len([shape for shape in shapes if shape.label == label]) for label in labels]
    first = next((table for table in tables if table.method.name != INPUT), tables[0])
    lines = [
        "# Evaluation",
        "",
        f"{len(shapes)} shapes in {len(labels)} classes: "
        + ", ".join(f"{label} ({size})" for label, size in zip(labels, sizes, strict=True))
        + ".",
        "",
        "Compactness errors are times 10⁻⁴; Hausdorff distances in units of sqrt(area), after rigid alignment; edge "
        "distortion is |stretch − 1|; the pose ratio is the distance between the forms of a class over that between "
        "its poses; *input* is the meshes as they are. Forms keep the scale that their method has given them, in units "
        "of the pose: *scale* is the median length of an edge over that in the pose. *Not converged*: forms whose "
        "stress was still falling after the last step. Times and memory: [costs](costs.md).",
        "",
        "## Detail kept",
        "",
        "Means over the meshes, in %: change of the lengths of edges, of the areas of triangles, and of the thickness "
        "(diameters of the largest balls that touch the surface from inside); pairs of triangles that cross more than "
        "before, over the number of triangles; edges whose fold changes by more than 45° (*jags*), and the same of the "
        "edges between patches. Nothing restores these by construction, as a pressure does the compactness.",
        "",
        markdown_table(
            ["method", "edges, median", "95 %", *_DETAIL.values()], (_detail_line(table) for table in tables)
        ),
        "",
        "## All classes",
        "",
        markdown_table(
            ["method", "compactness error", "deviation", "edges, median", "95 %", "Hausdorff to input",
             "within classes", "pose ratio", "mirrored", "scale", "not converged", "failed"],
            ([line[0], *map(short, (*line[3 : _METHOD_HEAD.index("nearest_neighbour")], *line[-2:])), line[2]]
             for line in (_method_line(table, matrices, labels) for table in tables)),
        ),
        "",
        "## Retrieval",
        "",
        f"First by pairs of points and normals ({POINTS} points; intervals: {DISTANCES} of distance, {COSINES} of each "
        f"cosine), which keep detail, then by harmonics ({SHELLS} shells, {DEGREES} degrees). *Behind*: by how "
        f"much the first tier is below that of *{first.method.name}*, mean over the classes and its standard error.",
        "",
        markdown_table(
            ["method", *("NN", "1st tier", "2nd tier", "DCG", "behind") * 2],
            (_retrieval_line(table, first) for table in tables),
        ),
    ]  # fmt: skip
    lines += ["", "## Compactness error by class, mean ± deviation", "", _by_class(tables, labels, _error_text)]
    lines += ["", "## Pose ratio by class (mirror images allowed)", "", _by_class(tables, labels, _pose_text)]
    lines += ["", "## Hausdorff distance within the classes, mean", ""]
    lines += [
        _by_class(tables, labels, lambda t, label: short(number(_mean(_upper(matrices[t.method.name, label][1])))))
    ]
    lines += ["", "## Methods", ""]
    lines += [f"- *{table.method.name}*: {table.method.source}" for table in tables]
    failed = [(table.method.name, shape, why) for table in tables for shape, why in table.failures.items()]
    if failed or lost_rows:
        lines += ["", "## Not done", ""]
        lines += [f"- {name}, {shape.label}/{shape.name}: {why}" for name, shape, why in failed]
        lines += [f"- {name}: {why}" for name, why in lost_rows.items()]
    return "\n".join(lines) + "\n"


def costs_text(tables: Sequence[MethodTable]) -> str:
    """Write computation times and memory in Markdown, by number of vertices.

    Parameters
    ----------
    tables : sequence of MethodTable
        The results by method.

    Returns
    -------
    str
        The page.
    """
    sizes = sorted({round(float(row["vertices"]), -3) for table in tables for row in table.rows.values()})
    head = ["method", *(f"{int(size):,} vertices" for size in sizes), "peak memory"]

    def line(table: MethodTable) -> list[str]:
        words = [table.method.name]
        for size in sizes:
            seconds = [cost["seconds"] for shape, cost in table.costs.items()
                       if round(float(table.rows[shape]["vertices"]), -3) == size]  # fmt: skip
            words.append(f"{np.median(seconds):.2f} s" if seconds else "")
        memory = [cost["memory"] for cost in table.costs.values() if cost.get("memory") is not None]
        return [*words, f"{max(memory):,.0f} MB" if memory else ""]

    shown = [table for table in tables if table.method.name != INPUT]
    return (
        "# What it cost\n\nMedian seconds a mesh on one thread, without reading and measuring, by thousands of "
        "vertices; for rivals without the search for feature points, which is for show only. Peak memory beyond what "
        f"the process had before.\n\n{markdown_table(head, map(line, shown))}\n"
    )


def _error_text(table: MethodTable, label: str) -> str:
    error = 1e4 * table.values("compactness_error", label)
    return f"{short(number(_mean(error)))} ± {short(number(_deviation(error)))}" if len(error) else ""


def _pose_text(table: MethodTable, label: str) -> str:
    pose = table.poses.get(label)
    if pose is None or not np.isfinite(pose.apart):
        return ""
    return f"{short(number(pose.ratio))} ({short(number(pose.ratio_mirrored))})"


def _by_class(tables: Sequence[MethodTable], labels: list[str], text: Any) -> str:
    return markdown_table(
        ["method", *labels], ([table.method.name, *(text(table, label) for label in labels)] for table in tables)
    )


def _hausdorff_matrix(store: Store, rows: Rows, method: Method, label: str) -> tuple[list[Shape], np.ndarray]:
    whole = rows.get(row_name(method, label, 0))
    some = [] if whole is None else whole[1]
    matrix = np.full((len(some),) * 2, np.nan)
    np.fill_diagonal(matrix, 0.0)
    for first in range(len(some) - 1):
        name = row_name(method, label, first)
        row = store.comparison(name, rows[name][2])
        if row is not None:
            matrix[first, first + 1 :] = matrix[first + 1 :, first] = row[1]["distances"]
    return some, matrix


def _upper(matrix: np.ndarray) -> np.ndarray:
    values = matrix[np.triu_indices(len(matrix), 1)]
    return values[np.isfinite(values)]


def _mean(values: np.ndarray) -> float:
    return float(values.mean()) if len(values) else float("nan")


def _deviation(values: np.ndarray) -> float:
    return float(values.std(ddof=1)) if len(values) > 1 else float("nan")
