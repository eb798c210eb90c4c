"""A transfer between two files in Blender: the mesh of one is brought into the other, and removed again."""

from __future__ import annotations

from pathlib import Path

import bpy

from ..blender.transfer.transfer_task import TransferTask
from ..core import CanonicalFormError
from ..core.run.monitor import Progress
from .lines import Line
from .rigged_files import character_of, largest_of, opened, remove_all_but, written
from .wanted import KINDS, Wanted


def transfer_between(path: Path, donor: Path, target: Path, wanted: Wanted, progress: Progress | None) -> Line:
    """Transfer data from the largest mesh of a file to those of another, write it, and return what was done."""
    if path.samefile(donor):
        raise CanonicalFormError("This file is the reference itself.")
    objects, warnings = opened(path, wanted)
    own = set(bpy.data.objects)
    source = character_of(largest_of(donor))
    kinds = {KINDS[name] for name in wanted.kinds}
    task = TransferTask(objects, source, kinds, wanted.settings, wanted.side, anyway=wanted.anyway)
    task.compute(progress)
    task.write()
    name, figures = source.name, {"objects": [obj.name for obj in objects], "transferred": task.told}
    remove_all_but(own, objects)
    warnings += written(objects, path, target, wanted)
    return {"object": objects[0].name, **figures, "from": name, "warnings": [*task.warnings, *warnings]}
