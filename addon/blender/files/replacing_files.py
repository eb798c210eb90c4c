"""Writes a file so that no partial file is ever visible under its name."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path


def replaced(path: Path, write: Callable[[Path], object], mark: str = "") -> None:
    """Write a temporary file next to the destination and rename it when it is complete.

    Parameters
    ----------
    path : Path
        The destination.
    write : callable
        Writes to the path that it is given.
    mark : str
        Distinguishes the temporary files of different runs; defaults to the process ID.
    """
    partial = path.with_name(f".{path.stem}.{mark or os.getpid()}.partial{path.suffix}")
    try:
        partial.unlink(missing_ok=True)  # writing would follow a link at this path
        write(partial)
        partial.replace(path)
    finally:
        partial.unlink(missing_ok=True)
