"""A rig for the meshes of one file, in a worker: read, fitted, written, reported in a line."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from ..core import CanonicalFormError
from .claims import to_be_made
from .lines import DONE, Line, failure, stage_line
from .opening import explained, with_blender
from .targets import Targets
from .wanted import Wanted


def rig_file(targets: Targets, wanted: Wanted, donor: Path | None) -> Iterator[list[Line]]:
    """Give the meshes of a file a rig, and yield the line of the result."""
    line: Line = {"input": str(targets.path), "reference": "mannequin" if donor is None else str(donor)}
    target = targets.of_file()
    try:
        with_blender("rig")
        if targets.too_long(target):
            raise CanonicalFormError(targets.too_long(target))
        with to_be_made(targets, target, [None], wanted) as skipped:
            if skipped:
                yield skipped
            else:
                from .blender_rig import rig_meshes

                targets.require_new(target)
                with stage_line(targets.path.name, wanted.stages) as progress:
                    found = rig_meshes(targets.path, donor, target, wanted, progress)
                yield [{**line, "output": str(target), **found}]
    except Exception as error:  # any error, as other files follow
        yield [failure(line, error, explained(error))]
    yield DONE
