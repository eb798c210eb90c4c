"""The file of result lines that --log names; a run that goes on where another stopped has each result in it once."""

from __future__ import annotations

import json
from collections.abc import Collection
from contextlib import ExitStack
from pathlib import Path

from ..blender.files.file_access import require_folder
from ..blender.files.kinds_of_files import READ, WRITTEN
from ..blender.files.replacing_files import replaced
from ..core.run.errors import CanonicalFormError
from .claims import claimed
from .lines import Line

_KINDS = {*READ, *(f".{kind}" for kind in WRITTEN), ".mtl", ".npz"}  # of what may be read or written: no logs


class ReportLog:
    """The result lines of a run, and of those before it that it continues.

    Parameters
    ----------
    path : Path
        The file; what is no log is never overwritten.
    continued : bool
        Whether to keep the lines of results that exist, in place of starting anew.
    whole : collection of str
        Results that are skipped as a whole: errors of their inputs are kept, as these are not tried again.
    """

    def __init__(self, path: Path, continued: bool, whole: Collection[str] = ()) -> None:
        if path.suffix.lower() in _KINDS or not path.name or (path.exists() and not path.is_file()):
            raise CanonicalFormError(f"--log {path}: this is no name for a log. Choose another, as run.jsonl.")
        require_folder(path.parent)
        self._open = ExitStack()
        if not self._open.enter_context(claimed(path)):
            self._open.close()
            raise CanonicalFormError(f"Another run writes to {path}. Choose another --log.")
        try:
            before = _lines(path)  # which requires that they are ours
            kept = _kept(before, whole) if continued else []
            self._outputs = {_output(line) for line in kept if "output" in line}
            replaced(path, lambda partial: partial.write_text("".join(map(_text, kept)), encoding="utf-8"))
            self._file = self._open.enter_context(path.open("ab", buffering=0))
        except BaseException:
            self._open.close()
            raise

    def add(self, lines: list[Line]) -> None:
        """Add lines, all at once, so that a kill cuts no result off from its other lines; not those that it has."""
        new = [line for line in lines if not (line.get("skipped") and _output(line) in self._outputs)]
        rest = "".join(map(_text, new)).encode()
        while rest:  # a disk that runs full takes a part
            rest = rest[self._file.write(rest) :]

    def close(self) -> None:
        """Close the file."""
        self._open.close()


def _lines(path: Path) -> list[Line]:
    """Read the lines of a log, without what a kill has cut off; raise an error if a file is no log."""
    found = []
    for text in path.read_bytes().split(b"\n")[:-1] if path.exists() else ():
        try:
            line = json.loads(text)
        except ValueError:
            line = None
        if not isinstance(line, dict) or "schema" not in line:
            raise CanonicalFormError(f"--log {path}: this file is no log, and was left as it is. Choose another name.")
        found.append(line)
    if path.exists() and path.stat().st_size and not found and not path.read_bytes().startswith(b'{"schema"'):
        raise CanonicalFormError(f"--log {path}: this file is no log, and was left as it is. Choose another name.")
    return found


def _kept(lines: list[Line], whole: Collection[str]) -> list[Line]:
    """Keep the lines of results that exist, and the errors of what is not tried again."""
    there = [line for line in lines if "error" not in line and "output" in line and Path(line["output"]).exists()]
    skipped = {line["input"] for line in there if _output(line) in whole}
    return [line for line in lines if line in there or ("error" in line and line.get("input") in skipped)]


def _output(line: Line) -> str:
    """Return the result of a line, however its path was written."""
    return str(Path(line["output"]).resolve())


def _text(line: Line) -> str:
    """Write a line as text."""
    return json.dumps(line) + "\n"
