"""The files to which the results of one input file are written."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from ..blender.files.replacing_files import LONGEST
from ..core.run.errors import CanonicalFormError


class Targets(NamedTuple):
    """File names for the results of one input file.

    Attributes
    ----------
    path : Path
        The input file.
    output : Path
        Folder for results.
    stem : str
        Name of its results, without extension.
    dash : str
        Separator between `stem` and the name of an object.
    format : str
        Kind of file to write.
    inputs : tuple of Path
        All files of the run.
    """

    path: Path
    output: Path
    stem: str
    dash: str
    format: str
    inputs: tuple[Path, ...]

    def of_file(self, frame: int | None = None) -> Path:
        """Return the file for the only result of the input file."""
        return self.output / f"{self.stem}{_numbered(frame)}.{self.format}"

    def of_objects(self, names: Sequence[str], frame: int | None = None) -> list[Path]:
        """Return the files for the results of several objects, unique on any file system.

        Examples
        --------
        >>> targets = Targets(Path("a.blend"), Path("out"), "a", "-", "obj", ())
        >>> [path.name for path in targets.of_objects(["Leg", "leg", "../x"])]
        ['a-Leg.obj', 'a-leg-2.obj', 'a-.._x.obj']
        """
        taken: set[str] = set()
        found = []
        for name in names:
            plain = re.sub(r"[^\w.\- ]", "_", name)
            own, number = plain, 1
            while own.casefold() in taken:
                number += 1
                own = f"{plain}-{number}"
            taken.add(own.casefold())
            found.append(self.output / f"{self.stem}{self.dash}{own}{_numbered(frame)}.{self.format}")
        return found

    def skipped(self, target: Path, frame: int | None) -> dict[str, Any]:
        """Return the line for an existing result that was skipped."""
        line: dict[str, Any] = {"input": str(self.path), "output": str(target), "skipped": True}
        return line if frame is None else {**line, "frame": frame}

    def left_to_another(self, target: Path, frame: int | None) -> dict[str, Any]:
        """Return the line for a result that another run is making."""
        return {**self.skipped(target, frame), "warnings": ["Another run is making this result."]}

    def too_long(self, target: Path) -> str:
        """Say so if a name is longer than file systems allow; empty otherwise."""
        size = len(os.fsencode(target.name))
        return (
            "" if size <= LONGEST else f"The name of the result has {size} bytes, more than {LONGEST}: {target.name}."
        )

    def require_new(self, target: Path) -> None:
        """Refuse to overwrite any input file of this run, under whatever name."""
        for source in self.inputs if target.exists() else ():
            if source.exists() and target.samefile(source):
                raise CanonicalFormError(f"The result would overwrite an input, {source}. Choose another --output.")


def _numbered(frame: int | None) -> str:
    """Return the suffix for the number of a frame."""
    return "" if frame is None else f"-f{frame:04d}"
