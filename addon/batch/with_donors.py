"""Data or a rig for the meshes of one file, from another, in a worker: read, computed, written, reported in a line."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

from ..core import CanonicalFormError
from ..core.run.monitor import Progress
from .claims import to_be_made
from .lines import DONE, Line, failure, stage_line
from .opening import explained, with_blender
from .targets import Targets
from .wanted import Wanted


def transfer_file(targets: Targets, wanted: Wanted, donor: Path) -> Iterator[list[Line]]:
    """Transfer data from a mesh to those of a file, and yield the line of the result."""

    def work(target: Path, progress: Progress | None) -> Line:
        from .blender_transfer import transfer_between

        return transfer_between(targets.path, donor, target, wanted, progress)

    return _made("transfer", targets, wanted, str(donor), work)


def rig_file(targets: Targets, wanted: Wanted, donor: Path | None) -> Iterator[list[Line]]:
    """Give the meshes of a file a rig, and yield the line of the result."""

    def work(target: Path, progress: Progress | None) -> Line:
        from .blender_rig import rig_meshes

        return rig_meshes(targets.path, donor, target, wanted, progress)

    return _made("rig", targets, wanted, "mannequin" if donor is None else str(donor), work)


def _made(
    command: str,
    targets: Targets,
    wanted: Wanted,
    reference: str,
    work: Callable[[Path, Progress | None], Line],
) -> Iterator[list[Line]]:
    """Make the result of a file, unless it is there. `work`: writes it to a path, and returns what was done."""
    line: Line = {"input": str(targets.path), "reference": reference}
    target = targets.of_file()
    try:
        with_blender(command)
        if targets.too_long(target):
            raise CanonicalFormError(targets.too_long(target))
        with to_be_made(targets, target, [None], wanted) as skipped:
            if skipped:
                yield skipped
            else:
                targets.require_new(target)
                with stage_line(targets.path.name, wanted.stages) as progress:
                    found = work(target, progress)
                yield [{**line, "output": str(target), **found}]
    except Exception as error:  # any error, as other files follow
        yield [failure(line, error, explained(error))]
    yield DONE
