"""What a run tells: lines of JSON, sentences on standard error, one line of progress on a terminal."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from ..blender.words.file_errors import sentence
from ..core.run.errors import CanonicalFormError

SCHEMA = 1  # version of the fields; higher when one changes its meaning
Line = dict[str, Any]


def failure(line: Line, error: Exception, told: str | None = None) -> Line:
    """Make the line of what went wrong; what nobody foresaw is told as a mistake of ours.

    Parameters
    ----------
    line : dict
        What is known of the mesh.
    error : Exception
        What was raised.
    told : str, optional
        Its sentence, with advice.

    Returns
    -------
    dict
        The line.

    Examples
    --------
    >>> failure({"input": "a.obj"}, OSError("No room."))
    {'input': 'a.obj', 'error': 'No room.'}
    """
    text = (told or (sentence(error) if isinstance(error, OSError) else str(error))).strip()
    if isinstance(error, ModuleNotFoundError):
        return {**line, "error": f"The Python module {error.name} is missing: pip install {error.name}"}
    if not isinstance(
        error, CanonicalFormError | OSError | RuntimeError | MemoryError
    ):  # RuntimeError: Blender refuses
        text = f"This is a bug in Canonical Form; please report it with the file. {type(error).__name__}: {text}"
    return {**line, "error": text}


def complain(text: str) -> None:
    """Say something on standard error.

    Parameters
    ----------
    text : str
        A sentence.
    """
    print(f"canonical_form: {plain(text)}", file=sys.stderr, flush=True)


def plain(text: str) -> str:
    r"""Replace what a terminal would obey: names in files may hold anything.

    Parameters
    ----------
    text : str
        A text.

    Returns
    -------
    str
        The text in one line, with a question mark for every character that is not printed.

    Examples
    --------
    >>> plain("Leg\x1b[2J")
    'Leg?[2J'
    """
    return "".join(each if each.isprintable() else "?" for each in text.replace("\n", " "))


@contextmanager
def stage_line(name: str, wanted: bool) -> Iterator[Any]:
    """Show the stage that a mesh is at, in one line of a terminal.

    Parameters
    ----------
    name : str
        What it is.
    wanted : bool
        Whether to show anything.

    Yields
    ------
    callable or None
        Takes the fraction done and the stage.
    """
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
    """One line of progress over all files: which it is, and how long the rest will take.

    Parameters
    ----------
    total : int
        Number of files.
    clock : callable
        Returns the time in seconds.
    """

    def __init__(self, total: int, clock: Any) -> None:
        self._total, self._clock = total, clock
        self._done = 0
        self._began = clock()
        self._shown = sys.stderr.isatty() and total > 1
        self._show()

    def done(self) -> None:
        """Count a file that has ended."""
        self._done += 1
        self._show()

    def clear(self) -> None:
        """Make room for another line."""
        if self._shown:
            sys.stderr.write("\r\x1b[K")
            sys.stderr.flush()

    def text(self) -> str:
        """Tell how far the run is.

        Returns
        -------
        str
            As in ``file 3 of 100 · 12 s left``.
        """
        text = f"file {min(self._done + 1, self._total)} of {self._total}"
        if self._done:
            seconds = (self._clock() - self._began) / self._done * (self._total - self._done)
            text += f" · {seconds:.0f} s left" if seconds < 100 else f" · {seconds / 60:.0f} min left"
        return text

    def _show(self) -> None:
        if self._shown and self._done < self._total:
            sys.stderr.write(f"\r{self.text()}\x1b[K")
            sys.stderr.flush()
