"""Where the results of one file go."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from ..core.run.errors import CanonicalFormError


class Targets(NamedTuple):
    """Names of the results of one file.

    Attributes
    ----------
    path : Path
        The file.
    output : Path
        Folder for results.
    stem : str
        Name of its results, without an ending.
    dash : str
        What stands between that and the name of an object.
    format : str
        Kind of file to write.
    inputs : tuple of Path
        Every file of the run.
    """

    path: Path
    output: Path
    stem: str
    dash: str
    format: str
    inputs: tuple[Path, ...]

    def of_file(self, frame: int | None = None) -> Path:
        """Name the one result of the file.

        Parameters
        ----------
        frame : int, optional
            The frame that it is of.

        Returns
        -------
        Path
            The result.
        """
        return self.output / f"{self.stem}{_numbered(frame)}.{self.format}"

    def of_objects(self, names: Sequence[str], frame: int | None = None) -> list[Path]:
        """Name the results of several objects.

        Parameters
        ----------
        names : sequence of str
            Names of the objects, whatever they hold.
        frame : int, optional
            The frame that they are of.

        Returns
        -------
        list of Path
            The results, no two alike on any file system.

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
        """Tell that a result was there already.

        Parameters
        ----------
        target : Path
            The result.
        frame : int or None
            The frame that it is of.

        Returns
        -------
        dict
            The line.
        """
        line: dict[str, Any] = {"input": str(self.path), "output": str(target), "skipped": True}
        return line if frame is None else {**line, "frame": frame}

    def require_new(self, target: Path) -> None:
        """Refuse to write over any of the files that are read in this run, by whatever name.

        Parameters
        ----------
        target : Path
            The result.

        Raises
        ------
        CanonicalFormError
            If it is one of them.
        """
        for source in self.inputs if target.exists() else ():
            if source.exists() and target.samefile(source):
                raise CanonicalFormError(f"The result would overwrite an input, {source}. Choose another --output.")


def _numbered(frame: int | None) -> str:
    """Append the number of a frame."""
    return "" if frame is None else f"-f{frame:04d}"
