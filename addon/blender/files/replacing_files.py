"""Writes a file so that no partial file is ever visible under its name."""

from __future__ import annotations

import os
import zlib
from collections.abc import Callable
from pathlib import Path

LONGEST = 255  # bytes in a name, of most file systems


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
    end = f".{mark or os.getpid()}.partial{path.suffix}"
    stem = path.stem
    if len(os.fsencode(f".{stem}{end}")) > LONGEST:
        stem = f"{zlib.crc32(os.fsencode(stem)):08x}"
    partial = path.with_name(f".{stem}{end}")
    try:
        partial.unlink(missing_ok=True)  # writing would follow a link at this path
        write(partial)
        partial.replace(path)
    finally:
        partial.unlink(missing_ok=True)
