"""The match of two files, in a worker: read, matched, written as arrays, reported in a line."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from ..blender.files.replacing_files import replaced
from ..core import CanonicalFormError, Match, match
from .computing import read_pose
from .lines import DONE, Line, failure, stage_line
from .opening import explained
from .wanted import Wanted


def match_files(one: Path, other: Path, target: Path, wanted: Wanted) -> Iterator[list[Line]]:
    """Match the meshes of two files, write the match, and yield its line."""
    yield [_matched(one, other, target, wanted)]
    yield DONE


def _matched(one: Path, other: Path, target: Path, wanted: Wanted) -> Line:
    """Match the meshes of two files and write the match."""
    line: Line = {"input": str(one), "other": str(other)}
    try:
        found_here, found_there = read_pose(one, wanted), read_pose(other, wanted)
        if wanted.objects and not {found_here.name, found_there.name} & set(wanted.objects):
            raise CanonicalFormError(f"Neither file has a mesh called {' or '.join(wanted.objects)}.")
        here, there = found_here.reference, found_there.reference
        assert here is not None
        assert there is not None
        with stage_line(f"{one.name} and {other.name}", wanted.stages) as progress:
            found = match(
                here.pose,
                here.faces,
                there.pose,
                there.faces,
                wanted.settings,
                side="auto" if wanted.side < 0 else wanted.side,
                progress=progress,
            )
        replaced(target, lambda partial: _write(partial, found), wanted.mark)
    except Exception as error:  # any error is reported in the line
        return failure(line, error, explained(error))
    figures = {
        "output": str(target),
        "vertices": len(found.vertices),
        "sides": [round(score, 3) for score in found.sides],
        "confidence": round(float(found.confidence.mean()), 3),
        "timings": found.timings,
        "warnings": [str(each) for each in found.warnings],
        "other_warnings": [str(each) for each in found.other_warnings],
    }
    return {**line, **figures}


def _write(path: Path, found: Match) -> None:
    """Write a match as arrays."""
    corners = np.where(found.faces[:, None] < 0, -1, found.other_faces[found.faces])
    with path.open("wb") as file:
        np.savez_compressed(
            file,
            vertices=found.vertices,
            corners=corners,
            weights=found.weights,
            confidence=found.confidence,
            sides=np.array(found.sides),
        )
