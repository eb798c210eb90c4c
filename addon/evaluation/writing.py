"""Writes tables as text: comma-separated or Markdown, figures in few digits or in many."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np


def number(value: Any) -> str:
    """Write a figure with all digits that matter.

    Parameters
    ----------
    value : object
        A number, text, or None.

    Returns
    -------
    str
        The word; empty for None and nan.
    """
    if value is None or (isinstance(value, float) and np.isnan(value)):
        return ""
    return f"{value:.9g}" if isinstance(value, float | np.floating) else str(value)


def short(word: str) -> str:
    """Cut a figure to three digits after the point.

    Parameters
    ----------
    word : str
        From `number`.

    Returns
    -------
    str
        The word; empty where that is.
    """
    return f"{float(word):.3f}" if word else ""


def csv_text(head: Sequence[str], lines: Iterable[Sequence[Any]]) -> str:
    """Write a table as comma-separated values.

    Parameters
    ----------
    head : sequence of str
        Names of the columns.
    lines : iterable of sequence
        The rows.

    Returns
    -------
    str
        The text.
    """
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(head)
    writer.writerows(lines)
    return stream.getvalue()


def markdown_table(head: Sequence[str], lines: Iterable[Sequence[str]]) -> str:
    """Write a table in Markdown.

    Parameters
    ----------
    head : sequence of str
        Names of the columns.
    lines : iterable of sequence of str
        The rows.

    Returns
    -------
    str
        The text.
    """
    rows = [head, ["---"] * len(head), *lines]
    return "\n".join("| " + " | ".join(row) + " |" for row in rows)
