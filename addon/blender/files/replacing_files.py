"""Writes a file so that it is never there in part."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path


def replaced(path: Path, write: Callable[[Path], object], mark: str = "") -> None:
    """Write a file beside its destination and rename it when it is complete.

    Parameters
    ----------
    path : Path
        The destination.
    write : callable
        Writes the file that it is given.
    mark : str
        Tells unfinished files of one run from those of others; the number of the process when left out.
    """
    partial = path.with_name(f".{path.stem}.{mark or os.getpid()}.partial{path.suffix}")
    try:
        partial.unlink(missing_ok=True)  # a link that lies there would be followed
        write(partial)
        partial.replace(path)
    finally:
        partial.unlink(missing_ok=True)
