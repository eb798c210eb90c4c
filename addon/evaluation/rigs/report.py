"""Writes the results of rigging: a table by reference, and a row for each character and pose."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..store import Store
from ..writing import csv_text, markdown_table, number

_OURS = ("joints", "joint_most", "axes", "weights", "mean", "most", "aligned")
_REFUSED = "stance_doubtful"  # the warning of what was written anyway
_BLENDERS = ("found_mean", "found_most", "found_lost", "true_mean", "true_most", "true_lost")


class Result(NamedTuple):
    """A character in a pose, rigged from a reference.

    Attributes
    ----------
    character, pose, reference : str
        Their names.
    outcome : dict or str
        Figures of `work.judged`; or the reason for failure.
    """

    character: str
    pose: str
    reference: str
    outcome: dict[str, Any] | str


def write_report(store: Store, results: Sequence[Result], left_out: dict[str, str]) -> list[Path]:
    """Write all results. Seconds are in the table of all rows only.

    Parameters
    ----------
    store : Store
        Where to write.
    results : sequence of Result
        The results.
    left_out : dict of str to str
        Characters that were not rigged, and the reasons.

    Returns
    -------
    list of Path
        The written files.
    """
    head = ["character", "pose", "reference", *_OURS, *_BLENDERS, "seconds", "told", "failure"]
    rows = []
    for each in results:
        known = each.outcome if isinstance(each.outcome, dict) else {}
        figures = [number(known.get(name)) for name in (*_OURS, *_BLENDERS, "seconds")]
        failure = each.outcome if isinstance(each.outcome, str) else ""
        rows.append([each.character, each.pose, each.reference, *figures, str(known.get("told", "")), failure])
    return [
        store.write_text("rigs.csv", csv_text(head, rows)),
        store.write_text("rigs.md", report_text(results, left_out)),
    ]


def report_text(results: Sequence[Result], left_out: dict[str, str]) -> str:
    """Write the report in Markdown.

    Parameters
    ----------
    results : sequence of Result
        The results.
    left_out : dict of str to str
        Characters that were not rigged, and the reasons.

    Returns
    -------
    str
        The report.
    """
    head = [
        "reference",
        "character",
        "poses",
        "refused",
        "joints (most)",
        "axes",
        "weights",
        "new poses: mean",
        "95 %",
        "aligned",
    ]
    head += ["Blender's weights on our bones", "on the true ones"]
    rows = []
    for reference in dict.fromkeys(each.reference for each in results):
        own = [each for each in results if each.reference == reference and isinstance(each.outcome, dict)]
        names = list(dict.fromkeys(each.character for each in own))
        rows += [_row(reference, name, [each for each in own if each.character == name]) for name in names]
        if len(names) > 1:
            rows.append(_row(reference, "*all*", own))
    lines = [
        "# Rigs",
        "",
        "Each character in poses of its own bones, reduced to 70 % of its vertices and shuffled, gets the bones of a "
        "reference. Joints, and vertices in its other poses: % of its size, mean (most); bones are turned as its own "
        "turn. What would be refused is counted, and not in the means. *Aligned*: without one motion of the whole. "
        "Axes: degrees; weights: share that is on another bone.",
        "",
        markdown_table(head, rows),
    ]
    failed = [each for each in results if isinstance(each.outcome, str)]
    if failed or left_out:
        lines += ["", "## Not done", "", *(f"- {name}: {why}" for name, why in left_out.items())]
        lines += [f"- {each.character}, {each.pose}, from {each.reference}: {each.outcome}" for each in failed]
    return "\n".join(lines) + "\n"


def _row(reference: str, name: str, results: Sequence[Result]) -> list[str]:
    """Write the means of some results."""
    every = [each.outcome for each in results if isinstance(each.outcome, dict)]
    found = [each for each in every if _REFUSED not in each.get("told", "")]

    def mean(figure: str, form: str = ".2f") -> str:
        known = [each[figure] for each in found if each.get(figure) is not None]
        return format(float(np.mean(known)), form) if known else ""

    most = [each["joint_most"] for each in found if each.get("joint_most") is not None]
    joints = f"{mean('joints')} ({max(most):.1f})" if most else ""
    blenders = [f"{mean(f'{bones}_mean')}" for bones in ("found", "true")]
    counts = [str(len(found)), str(len(every) - len(found))]
    figures = [joints, mean("axes", ".1f"), mean("weights", ".1%"), mean("mean"), mean("most", ".1f"), mean("aligned")]
    return [reference, name, *counts, *figures, *blenders]
