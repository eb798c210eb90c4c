"""What an experiment is: a set of meshes × settings × a measure; and how its rows are shown and compared."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tools.benchmarks.mesh_sets import Body

Row = dict[str, Any]  # numbers, texts or None, by column
Measure = Callable[[Any, Any], Iterable[Row]]  # of a body with a setting; `mesh` and `setting` are added to each row
LOOSE = {"seconds": 1.0, "time /": 0.4, "GB": 0.3, "MB": 0.5, "wait": 2.0, "rounding": math.inf}
"""Words in the name of a column, and the share by which its numbers may differ when they are measured again: seconds of
another machine say little, ratios of times more. All other numbers are the same in every run, to the last digit shown.
"""


def shown(value: Any) -> str:
    """Return the text of a cell.

    Examples
    --------
    >>> shown(0.14349), shown(13380), shown(12345.6), shown(2e-16), shown("5, 6"), shown(None)
    ('0.143', '13,380', '12,346', '2.00e-16', '5, 6', '')
    """
    if isinstance(value, float):
        return f"{value:,.0f}" if abs(value) >= 1000 else f"{value:#.{_digits(value)}g}"
    return "" if value is None else f"{value:,d}" if isinstance(value, int) else str(value).replace("|", r"\|")


def _digits(value: float) -> int:
    """Return the number of significant digits that are shown."""
    return 4 if abs(value) >= 1 else 3


def agrees(column: str, told: Any, measured: Any) -> bool:
    """Return whether two values of a column are the same: texts to the letter, numbers up to their tolerance.

    Examples
    --------
    >>> agrees("pose ratio", 0.143, 0.144), agrees("pose ratio", 0.143, 0.145), agrees("seconds", 1.0, 1.6)
    (True, False, True)
    """
    if type(told) is not type(measured) or not isinstance(told, float):
        return bool(told == measured)
    share = next((share for word, share in LOOSE.items() if word in column), 0.0)
    unit = 10.0 ** (math.floor(math.log10(max(abs(told), 1e-300))) + 1 - _digits(told))
    return math.isinf(share) or abs(told - measured) <= max(1.001 * unit, share * min(abs(told), abs(measured)))


@dataclass(frozen=True)
class Experiment:
    """One table of the results."""

    name: str  # on the command line, and the heading
    meshes: Callable[[Path | None], Sequence[Body]]  # in a folder of data; generated ones need none
    measure: Measure  # its docstring is on the page, and says what the columns mean
    settings: Mapping[str, Any] = field(default_factory=lambda: {"": None})  # passed to `measure` one by one
    table: Callable[[list[Row]], list[Row]] = list  # turns the rows of all bodies and settings into those to show
    note: Callable[[list[Row]], str] = lambda rows: ""  # a sentence on the rows, below the table
    most: int | None = None  # bodies, of those that are chosen
    first: bool = False  # whether `make bench` measures it if no experiment is named

    @property
    def about(self) -> str:
        """What the columns mean."""
        return " ".join((self.measure.__doc__ or "").split())

    def markdown(self, rows: Sequence[Row]) -> str:
        """Return the table of the rows, and the note."""
        columns = list(dict.fromkeys(name for row in rows for name, value in row.items() if value != ""))
        lines = [columns, ["---"] * len(columns), *([shown(row.get(name)) for name in columns] for row in rows)]
        note = self.note(list(rows))
        return "\n".join("| " + " | ".join(line) + " |" for line in lines) + (f"\n\n{note}" if note else "")

    def differences(self, told: Sequence[Row], measured: Sequence[Row]) -> list[str]:
        """Return a sentence for each value that differs by more than its tolerance."""
        if [list(row) for row in told] != [list(row) for row in measured]:
            return [f"{self.name}: the page has {len(told)} rows, {len(measured)} were measured, or other columns."]
        sentences = []
        for old, new in zip(told, measured, strict=True):
            where = ", ".join([self.name, *(value for value in old.values() if isinstance(value, str) and value)])
            for name in old:
                if not agrees(name, old[name], new[name]):
                    now = f"the page has {shown(old[name])}, measured {shown(new[name])}"
                    sentences.append(f"{where}, {name}: {now}.")
        return sentences


REGISTERED: dict[str, Experiment] = {}


def experiment(name: str, meshes: Callable[[Path | None], Sequence[Body]], **more: Any) -> Callable[[Measure], Measure]:
    """Register a measure as an experiment, in the order in which the modules of experiments are imported."""

    def register(measure: Measure) -> Measure:
        REGISTERED[name] = Experiment(name, meshes, measure, **more)
        return measure

    return register
