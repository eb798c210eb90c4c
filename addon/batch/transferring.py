"""The transfer of data to one file, in a worker: read, matched, written, reported in a line."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from ..core import CanonicalFormError
from .claims import to_be_made
from .lines import DONE, Line, failure, stage_line
from .opening import explained, with_blender
from .targets import Targets
from .wanted import Wanted


def transfer_file(targets: Targets, wanted: Wanted, donor: Path) -> Iterator[list[Line]]:
    """Transfer data from a mesh to those of a file, and yield the line of the result."""
    line: Line = {"input": str(targets.path), "reference": str(donor)}
    target = targets.of_file()
    try:
        with_blender("transfer")
        if targets.too_long(target):
            raise CanonicalFormError(targets.too_long(target))
        with to_be_made(targets, target, [None], wanted) as skipped:
            if skipped:
                yield skipped
            else:
                from .blender_transfer import transfer_between

                targets.require_new(target)
                with stage_line(targets.path.name, wanted.stages) as progress:
                    found = transfer_between(targets.path, donor, target, wanted, progress)
                yield [{**line, "output": str(target), **found}]
    except Exception as error:  # any error, as other files follow
        yield [failure(line, error, explained(error))]
    yield DONE
