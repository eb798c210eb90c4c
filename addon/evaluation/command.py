"""The command line: ``python -m addon evaluate DATASET --output DIR``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from time import perf_counter
from typing import TextIO

from ..scheduling.crews import crew
from .arguments import (
    add_dataset,
    add_workers,
    bar_style,
    exit_code,
    own_folder,
    require_packages,
    require_workers,
)
from .dataset import Shape, shapes_in
from .methods import DEFAULT, KNOWN, Method, chosen_methods
from .running import Lost, Rows, compute_forms, compute_hausdorff, hausdorff_rows, pending_forms
from .store import Store
from .tables import method_table


def main(arguments: list[str], output: TextIO | None = None) -> int:
    """Evaluate methods on a dataset.

    Parameters
    ----------
    arguments : list of str
        The arguments after ``evaluate``.
    output : TextIO, optional
        Stream for the names of the written files; standard output if omitted.

    Returns
    -------
    int
        0 if every form was computed, 1 if one failed, 2 if nothing could be computed, 130 after a keyboard interrupt.
    """
    return exit_code(_parser(), arguments, lambda options: _evaluate(options, output or sys.stdout))


def _evaluate(options: argparse.Namespace, output: TextIO) -> bool:
    """Run the evaluation, and return whether every form was computed."""
    require_packages(["matplotlib", "tqdm", "threadpoolctl", *(["distributed"] if options.scheduler else [])])
    require_workers(options.workers)
    methods = chosen_methods(_words(options.methods))
    shapes = shapes_in(options.dataset, options.classes)
    own_folder(options.output, [*(shape.path for shape in shapes), *filter(None, [options.classes])])
    return _evaluated(Store(options.output), shapes, methods, options, output) == 0


def _words(text: str) -> list[str]:
    """Split at commas, but not inside the settings of a method: ``ours:quality=draft,landmark_count=50,fast``."""
    words: list[str] = []
    for part in text.split(","):
        if "=" in part and ":" not in part and words:
            words[-1] += f",{part}"
        elif part:
            words.append(part)
    return words


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="canonical_form evaluate",
        description="Compute forms of all shapes of a dataset by several methods, and make tables, a report and "
        "figures. A run that was stopped or killed goes on where it was when it is started again.",
        epilog=f"Methods: {', '.join(KNOWN)}. Settings may follow a method: ours:quality=draft,landmark_count=50.",
    )
    add_dataset(parser)
    parser.add_argument(
        "--methods", default=",".join(DEFAULT), help="names, separated by commas (default: %(default)s)"
    )
    add_workers(parser)
    parser.add_argument(
        "--hausdorff", type=int, default=10, metavar="N",
        help="shapes of a class that are compared by Hausdorff distance; 0 for none (default: %(default)s)",
    )  # fmt: skip
    return parser


def _evaluated(
    store: Store, shapes: list[Shape], methods: list[Method], options: argparse.Namespace, output: TextIO
) -> int:
    """Compute what is missing, write everything, and return the number of failures."""
    from tqdm import tqdm

    pending, lost = pending_forms(store, shapes, methods)
    missing, whole = sum(map(len, pending.values())), len(shapes) * len(methods)
    pace: list[float] = []
    began = perf_counter()
    style = bar_style()
    with crew(options.workers, options.scheduler) as hired:
        with tqdm(total=whole, initial=whole - missing, unit="form", desc="Forms", **style) as bar:
            if missing:
                lost |= compute_forms(store, pending, hired, lambda _: bar.update(), pace)
        rows = hausdorff_rows(store, shapes, methods, options.hausdorff)
        todo = {name: row for name, row in rows.items() if not store.has(name, row[2])}
        lost_rows: dict[str, str] = {}
        if rows:
            with tqdm(total=len(rows), initial=len(rows) - len(todo), unit="row", desc="Hausdorff", **style) as bar:
                lost_rows = compute_hausdorff(store, todo, hired, lambda _: bar.update(), pace)
    spent = perf_counter() - began
    if pace and options.scheduler is None:
        print(
            f"{missing} forms and {len(todo)} rows in {spent:.0f} s; the {options.workers} workers were at work for "
            f"{sum(pace) / (options.workers * spent):.0%} of the time.",
            file=sys.stderr,
        )
    return len(lost_rows) + _reported(store, shapes, methods, lost, rows, lost_rows, output)


def _reported(
    store: Store,
    shapes: Sequence[Shape],
    methods: Sequence[Method],
    lost: Lost,
    rows: Rows,
    lost_rows: dict[str, str],
    output: TextIO,
) -> int:
    """Write tables and figures, print their names, and return how many forms failed."""
    from .figures import write_figures
    from .report import write_report

    tables = [
        method_table(store, shapes, method, {s: why for (s, m), why in lost.items() if m == method})
        for method in methods
    ]
    for path in [*write_report(store, shapes, tables, rows, lost_rows), *write_figures(store, tables)]:
        print(path, file=output, flush=True)
    return sum(len(table.failures) for table in tables)
