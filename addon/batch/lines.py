"""The output of a run: JSON lines, messages on standard error, a progress line on a terminal."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from ..core.run.errors import CanonicalFormError

SCHEMA = 1  # version of the fields, increased when a field changes its meaning
LEFT_OFF = (
    "Scripts or Python drivers in this file were left off; what they would move is not moved. "
    "If you trust the file, add --trust-scripts."
)
_PICTURES_ABSENT = (
    "Pictures that do not come along: {}. Their files are missing, or choose glb, fbx or usdz, which hold them."
)
_PICTURES_LEFT_OUT = (
    "Pictures from outside the folder of this file were left out: {}. If you trust the file, add --trust-scripts."
)
Line = dict[str, Any]
DONE: list[Line] = []  # comes after the last lines of a file


def failure(line: Line, error: Exception, told: str) -> Line:
    """Create the line for an error; unexpected errors are reported as bugs.

    Examples
    --------
    >>> failure({"input": "a.obj"}, OSError(28, "No space left on device"), "No room.")
    {'input': 'a.obj', 'error': 'No room.'}
    """
    text = told.strip()
    if isinstance(error, ModuleNotFoundError):
        return {**line, "error": f"The Python module {error.name} is missing: pip install {error.name}"}
    if not isinstance(
        error, CanonicalFormError | OSError | RuntimeError | MemoryError
    ):  # Blender's operators raise RuntimeError
        text = f"This is a bug in Canonical Form; please report it with the file. {type(error).__name__}: {text}"
    return {**line, "error": text}


def pictures_told(left_out: list[str], absent: list[str]) -> list[str]:
    """Say which pictures were left out for safety, and which others do not come along.

    Examples
    --------
    >>> [told[:39] for told in pictures_told([], ["Skin"])]
    ['Pictures that do not come along: Skin. ']
    """
    told = [(_PICTURES_LEFT_OUT, left_out), (_PICTURES_ABSENT, [each for each in absent if each not in left_out])]
    return [sentence.format(", ".join(names)) for sentence, names in told if names]


def complain(text: str) -> None:
    """Print a message to standard error."""
    print(f"canonical_form: {plain(text)}", file=sys.stderr, flush=True)


def plain(text: str) -> str:
    r"""Replace each character that cannot be printed, as names in files may contain anything.

    Examples
    --------
    >>> plain("Leg\x1b[2J")
    'Leg?[2J'
    """
    return "".join(each if each.isprintable() else "?" for each in text.replace("\n", " "))


@contextmanager
def stage_line(name: str, wanted: bool) -> Iterator[Any]:
    """Show the current stage of a mesh, in one line of a terminal."""
    if not wanted:
        yield None
        return

    def show(done: float, stage: str) -> None:
        sys.stderr.write(f"\r{plain(name)}: {100 * done:3.0f} % {stage}\x1b[K")
        sys.stderr.flush()

    try:
        yield show
    finally:
        sys.stderr.write("\r\x1b[K")
        sys.stderr.flush()


class FileCount:
    """Progress over all files in one line: the current file and the remaining time."""

    def __init__(self, total: int, clock: Any) -> None:
        self._total, self._clock = total, clock
        self._done = 0
        self._began = clock()
        self._shown = sys.stderr.isatty() and total > 1
        self._show()

    def done(self) -> None:
        """Count a finished file."""
        self._done += 1
        self._show()

    def clear(self) -> None:
        """Clear the progress line."""
        if self._shown:
            sys.stderr.write("\r\x1b[K")
            sys.stderr.flush()

    def text(self) -> str:
        """Return the text of the progress line, as ``file 3 of 100 · 12 s left``."""
        text = f"file {min(self._done + 1, self._total)} of {self._total}"
        if self._done:
            seconds = (self._clock() - self._began) / self._done * (self._total - self._done)
            text += f" · {seconds:.0f} s left" if seconds < 100 else f" · {seconds / 60:.0f} min left"
        return text

    def _show(self) -> None:
        if self._shown and self._done < self._total:
            sys.stderr.write(f"\r{self.text()}\x1b[K")
            sys.stderr.flush()
