"""Formats tables as text: comma-separated or Markdown, with many or few digits."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np


def number(value: Any) -> str:
    """Format a figure with all significant digits.

    Parameters
    ----------
    value : object
        A number, text, or None.

    Returns
    -------
    str
        The text; empty for None and NaN.
    """
    if value is None or (isinstance(value, float) and np.isnan(value)):
        return ""
    return f"{value:.9g}" if isinstance(value, float | np.floating) else str(value)


def short(word: str) -> str:
    """Round a figure to three decimals.

    Parameters
    ----------
    word : str
        From `number`.

    Returns
    -------
    str
        The text; empty if `word` is empty.
    """
    return f"{float(word):.3f}" if word else ""


def csv_text(head: Sequence[str], lines: Iterable[Sequence[Any]]) -> str:
    """Format a table as comma-separated values.

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
    """Format a table in Markdown.

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
