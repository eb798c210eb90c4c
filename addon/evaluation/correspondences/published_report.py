"""Writes the results on a published benchmark: a table, all pairs, and the Princeton curves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..store import Store
from ..writing import csv_text, markdown_table, number
from .matchers import MATCHERS
from .published_work import CURVE

Outcomes = Mapping[tuple[str, str, str], tuple[dict[str, Any], dict[str, np.ndarray]] | str]
_FIGURES = ("error", "points", "mirrored", "flip", "coverage", "dirichlet")


def write_published(store: Store, outcomes: Outcomes, matchers: Sequence[str], *, exact: bool) -> list[Path]:
    """Write all results. Seconds are in a separate file; everything else is identical in every run.

    Parameters
    ----------
    store : Store
        Where to write.
    outcomes : mapping
        Figures and arrays, or the reason for failure, by names of mesh, other mesh and method.
    matchers : sequence of str
        Names of the methods.
    exact : bool
        Whether distances are exact.

    Returns
    -------
    list of Path
        The written files.
    """
    done = {key: each for key, each in outcomes.items() if not isinstance(each, str)}
    rows, curves = [], []
    for matcher in matchers:
        own = [each for key, each in done.items() if key[2] == matcher]
        if not own:
            continue
        figures = [row for row, _ in own]
        flips = [row["flip"] for row in figures if row["flip"] is not None]
        error = 100 * np.array([row["error"] for row in figures])
        right = error[[not row["flip"] for row in figures]]
        rows.append(
            [
                matcher,
                str(len(own)),
                f"{error.mean():.2f}",
                f"{right.mean():.2f}" if len(right) else "",
                f"{error.max():.2f}",
                f"{100 * np.mean([row['points'] for row in figures]):.2f}",
                f"{sum(flips)} of {len(flips)}" if flips else "",
                *(
                    f"{np.mean([row[name] for row in figures]):.{digits}f}"
                    for name, digits in (("coverage", 2), ("dirichlet", 2))
                ),
                f"{np.median([row['seconds'] for row in figures]):.1f} s",
            ]
        )
        curves.append([matcher, *(number(each) for each in np.mean([arrays["curve"] for _, arrays in own], axis=0))])
    head = [
        "method",
        "pairs",
        "error × 100",
        "without flips",
        "most",
        "of points",
        "flips",
        "coverage",
        "Dirichlet",
        "median time",
    ]
    failed = [f"- {key[2]}, {key[0]} onto {key[1]}: {each}" for key, each in outcomes.items() if isinstance(each, str)]
    how = "exactly" if exact else "by the heat method"
    text = [
        "# Matches on a published benchmark",
        "",
        "Meshes and pairs as they come. The error is the geodesic distance from the truth, over sqrt(area), of the "
        "nearest corner of the triangle that was matched, as published ones are, and *of points* that of the match "
        f"itself, measured {how}; a pair is flipped where it is nearer to the truth of the other side. Coverage: share "
        "of the other's area that is hit. Dirichlet: 1 for an isometry.",
        "",
        markdown_table(head, rows),
        "",
        *(f"- *{name}*: {MATCHERS[name].source}" for name in matchers),
        *(["", "## Not done", "", *failed] if failed else []),
    ]
    files = {
        "published.md": "\n".join(text) + "\n",
        "published.csv": csv_text(
            ["mesh", "other", "method", *_FIGURES, "failure"],
            (
                [*key, *([*[""] * len(_FIGURES), each] if isinstance(each, str) else [*_numbers(each[0]), ""])]
                for key, each in outcomes.items()
            ),
        ),
        "published-curves.csv": csv_text(["method", *(number(float(each)) for each in CURVE)], curves),
        "published-costs.csv": csv_text(
            ["mesh", "other", "method", "seconds"], ([*key, number(each[0]["seconds"])] for key, each in done.items())
        ),
    }
    return [store.write_text(name, content) for name, content in files.items()]


def _numbers(row: dict[str, Any]) -> list[str]:
    """Format the figures of a pair; what is not known is empty."""
    return ["" if row[name] is None else number(row[name]) for name in _FIGURES]
