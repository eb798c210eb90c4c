"""The match of two files: read, matched, written as arrays, reported in a line."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ..blender.files.replacing_files import replaced
from ..blender.jobs.likeness import Likeness, PoseArrays
from ..core import CanonicalFormError, Match, match
from .arguments import settings_of
from .lines import Line, failure, stage_line
from .plain_files import fans, has_blender, read_plain


def match_files(options: Namespace, target: Path, mark: str, stages: bool) -> Line:
    """Match the meshes of two files and write the match.

    Parameters
    ----------
    options : argparse.Namespace
        The options: two files, objects, side and settings.
    target : Path
        The .npz file to write: `vertices`, `corners`, `weights`, `confidence` for each vertex of the first mesh, and
        the scores of the `sides`.
    mark : str
        Distinguishes temporary files of this run from those of others.
    stages : bool
        Whether to show the current stage.

    Returns
    -------
    dict
        The result line.
    """
    one, other = options.meshes
    line: Line = {"input": str(one), "other": str(other)}
    try:
        trusted = options.trust_scripts
        named = options.objects or ()
        found_here, found_there = (read_likeness(path, named, trusted=trusted) for path in (one, other))
        if named and found_here.name not in named and found_there.name not in named:
            raise CanonicalFormError(f"Neither file has a mesh called {' or '.join(named)}.")
        here, there = found_here.reference, found_there.reference
        assert here is not None
        assert there is not None
        with stage_line(f"{one.name} and {other.name}", stages) as progress:
            found = match(
                here.pose,
                here.faces,
                there.pose,
                there.faces,
                settings_of(options),
                side="auto" if options.side < 0 else options.side,
                progress=progress,
            )
        replaced(target, lambda partial: _write(partial, found), mark)
    except Exception as error:  # any error is reported in the line
        return failure(line, error)
    return {
        **line,
        "output": str(target),
        "vertices": len(found.vertices),
        "sides": [round(score, 3) for score in found.sides],
        "confidence": round(float(found.confidence.mean()), 3),
        "timings": found.timings,
        "warnings": [str(each) for each in found.warnings],
        "other_warnings": [str(each) for each in found.other_warnings],
    }


def read_likeness(path: Path, names: Sequence[str], side: int = -1, *, trusted: bool = False) -> Likeness:
    """Read the pose of the mesh of a file, or of the largest one, with or without Blender.

    Parameters
    ----------
    path : Path
        The file.
    names : sequence of str
        Names of the objects to use, as far as they exist.
    side : int
        Which way to match: -1 for the most likely, or its index.
    trusted : bool
        Whether scripts and Python drivers in a .blend file run.

    Returns
    -------
    Likeness
        The pose.

    Raises
    ------
    CanonicalFormError
        If the file cannot be read.
    """
    if has_blender():
        from .computing import likeness_in_blender

        return likeness_in_blender(path, names, side, trusted=trusted)
    vertices, polygons = read_plain(path)
    return Likeness("OBJECT", path.stem, PoseArrays(vertices, fans(polygons), vertices), side)


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
