"""Writes the results of matching: a table, all pairs, the costs, and a figure."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..remeshing import LEFT
from ..store import Store
from ..writing import csv_text, markdown_table, number
from .matchers import Matcher
from .pairs import Pair, Poses
from .picture import matches_figure
from .work import APART

Outcome = tuple[dict[str, Any], dict[str, np.ndarray]] | str
_CROSSINGS = ("crossings", "crossings_before", "crossings_true")
_FIGURES = ("error", "nearer", "near", "flip", "pose", "edges", *_CROSSINGS)


class Result(NamedTuple):
    """A pair, a method of matching, and the result.

    Attributes
    ----------
    pair : Pair
        The pair.
    matcher : Matcher
        The method of matching.
    outcome : (dict, dict of str to ndarray) or str
        Figures and arrays, from `work.matched`; or the reason for failure.
    """

    pair: Pair
    matcher: Matcher
    outcome: Outcome


def write_report(
    store: Store, results: Sequence[Result], matchers: Sequence[Matcher], left_out: dict[str, str], poses: Poses
) -> list[Path]:
    """Write all results. Seconds are in a separate file; everything else is identical in every run.

    Parameters
    ----------
    store : Store
        Where to write.
    results : sequence of Result
        The result of each pair and method.
    matchers : sequence of Matcher
        The methods of matching.
    left_out : dict of str to str
        Classes that were not matched, and the reasons.
    poses : Poses
        The meshes.

    Returns
    -------
    list of Path
        The written files.
    """
    head = ["pairs of", "mesh", "other", "method"]

    def words(each: Result) -> list[str]:
        return [each.pair.label, each.pair.one.name, each.pair.other.name, each.matcher.name]

    done = [each for each in results if not isinstance(each.outcome, str)]
    seconds = (number(each.outcome[0]["seconds"]) for each in done if not isinstance(each.outcome, str))
    files = {
        "matches.csv": csv_text(
            [*head, *_FIGURES, "failure"],
            (
                [*words(each), *_numbers(each.outcome), each.outcome if isinstance(each.outcome, str) else ""]
                for each in results
            ),
        ),
        "matches.md": report_text(results, matchers, left_out),
        "matches-costs.csv": csv_text(
            [*head, "seconds"], ([*words(each), spent] for each, spent in zip(done, seconds, strict=True))
        ),
        "matches-costs.md": costs_text(results, matchers),
    }
    written = [store.write_text(name, text) for name, text in files.items()]
    figure = matches_figure(done, matchers, poses)
    return [*written, *([] if figure is None else [store.write_picture("matches.png", figure)])]


def report_text(results: Sequence[Result], matchers: Sequence[Matcher], left_out: dict[str, str]) -> str:
    """Write the report in Markdown.

    Parameters
    ----------
    results : sequence of Result
        The result of each pair and method.
    matchers : sequence of Matcher
        The methods of matching.
    left_out : dict of str to str
        Classes that were not matched, and the reasons.

    Returns
    -------
    str
        The report.
    """
    head = ["pairs of", "method", "pairs", "error × 100", "most", "< .05", "< .10", "flips"]
    rows, poses = [], []
    for label in dict.fromkeys(each.pair.label for each in results):
        for matcher in matchers:
            found = _figures(results, label, matcher)
            if found:
                error = 100 * _column(found, "error")
                shares = [f"{_column(found, name).mean():.1%}" for name in ("nearer", "near")]
                flips = str(int(_column(found, "flip").sum()))
                rows.append([label, matcher.name, str(len(found)), *_mean_and_most(error, 2), *shares, flips])
            ratio, edges = (_column(found, name) for name in ("pose", "edges"))
            if len(edges):
                through = [_column(found, name) for name in _CROSSINGS]
                poses.append(
                    [label, matcher.name, str(len(ratio)), *_mean_and_most(ratio, 3), f"{edges.mean():.3f}"]
                    + [f"{each.mean():.0f}" if len(each) else "" for each in through]
                    + [f"{_crossing_more(found)} of {len(found)}"]
                )
    lines = [
        "# Matches",
        "",
        f"Every pose with every other, reduced to {LEFT:.0%} of its vertices and shuffled. The error is the geodesic "
        "distance of a match from the truth, over sqrt(area), mean over 300 vertices; a pair counts as flipped where a "
        "tenth of them is more than .3 away. Seconds: [costs](matches-costs.md).",
        "",
        markdown_table(head, rows),
    ]
    if poses:
        lines += [
            "",
            "## Poses taken over",
            "",
            f"Distance to the true pose over the distance between the two poses, those more than {APART} apart; edges: "
            "median change of their lengths. Pairs of triangles that cross, mean: in the pose taken over, before, and "
            "in the true pose; *more*: pairs of meshes in which they are more than both before and in the true pose.",
            "",
            markdown_table(
                ["pairs of", "method", "pairs", "distance", "most", "edges", "crossings", "before", "true", "more"],
                poses,
            ),
        ]
    lines += ["", "## Methods", "", *(f"- *{each.name}*: {each.source}" for each in matchers)]
    failed = [each for each in results if isinstance(each.outcome, str)]
    if failed or left_out:
        lines += ["", "## Not done", ""]
        lines += [f"- {label}: {why}" for label, why in left_out.items()]
        lines += [f"- {each.matcher.name}, {each.pair.name}: {each.outcome}" for each in failed]
    return "\n".join(lines) + "\n"


def costs_text(results: Sequence[Result], matchers: Sequence[Matcher]) -> str:
    """Write the computation times in Markdown.

    Parameters
    ----------
    results : sequence of Result
        The result of each pair and method.
    matchers : sequence of Matcher
        The methods of matching.

    Returns
    -------
    str
        The page.
    """
    rows = []
    for label in dict.fromkeys(each.pair.label for each in results):
        seconds = [_column(_figures(results, label, matcher), "seconds") for matcher in matchers]
        rows.append([label, *(f"{np.median(each):.1f} s" if len(each) else "" for each in seconds)])
    return (
        "# What it cost\n\nMedian seconds a pair on one thread, forms, spectra and, for ours, the pose included.\n\n"
        f"{markdown_table(['pairs of', *(each.name for each in matchers)], rows)}\n"
    )


def _numbers(outcome: Outcome) -> list[str]:
    """Format the figures of a pair; as many empty strings if there are none."""
    return [""] * len(_FIGURES) if isinstance(outcome, str) else [number(outcome[0][name]) for name in _FIGURES]


def _figures(results: Sequence[Result], label: str, matcher: Matcher) -> list[dict[str, Any]]:
    """Return the figures of the pairs of a class and method."""
    return [
        each.outcome[0]
        for each in results
        if each.pair.label == label and each.matcher == matcher and not isinstance(each.outcome, str)
    ]


def _column(figures: Sequence[dict[str, Any]], name: str) -> np.ndarray:
    """Return one figure of all pairs that have it."""
    return np.array([each[name] for each in figures if each[name] is not None], dtype=np.float64)


def _crossing_more(figures: Sequence[dict[str, Any]]) -> int:
    """Count the results with more self-intersections than the mesh in its own pose and in the true pose."""
    return sum(each["crossings"] > max(each["crossings_before"], each["crossings_true"] or 0) for each in figures)


def _mean_and_most(values: np.ndarray, digits: int) -> list[str]:
    """Format the mean and the largest of some values."""
    return [f"{values.mean():.{digits}f}", f"{values.max():.{digits}f}"] if len(values) else ["", ""]
