"""Claims on results: of several runs with the same output folder, one makes each result."""

from __future__ import annotations

import os
import sys
import zlib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from ..blender.files.replacing_files import LONGEST


@contextmanager
def claimed(path: Path) -> Iterator[bool]:
    """Claim a file that is to be written, for a while; whether it exists is to be asked again within.

    The claim is the lock of a hidden file beside it, which ends with the process, however that ends.

    Parameters
    ----------
    path : Path
        The file.

    Yields
    ------
    bool
        Whether no other run has claimed it.
    """
    name = f".{path.name}.claim"
    if len(os.fsencode(name)) > LONGEST:
        name = f".{zlib.crc32(os.fsencode(path.name)):08x}.claim"
    beside = path.with_name(name)
    handle = os.open(beside, os.O_RDWR | os.O_CREAT, 0o666)
    ours = _locked(handle)
    try:
        yield ours
    finally:
        if ours:
            with suppress(OSError):  # Windows removes no file that another run looks at; that run removes it
                beside.unlink()
        os.close(handle)


def _locked(handle: int) -> bool:
    """Lock a file, unless another process has."""
    try:
        if sys.platform == "win32":
            import msvcrt

            msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True
