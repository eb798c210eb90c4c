"""Claims on results: of several runs with the same output folder, one makes each result."""

from __future__ import annotations

import os
import sys
import zlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

from ..blender.files.replacing_files import LONGEST
from .lines import Line
from .targets import Targets
from .wanted import Wanted

_END = ".claim"


@contextmanager
def claimed(path: Path) -> Iterator[bool]:
    """Claim a file that is to be written, for a while; whether it exists is to be asked again within.

    The claim is the lock of a hidden file beside it, which ends with the process, however that ends. Where a file
    system has no locks, every claim is granted.

    Parameters
    ----------
    path : Path
        The file.

    Yields
    ------
    bool
        Whether no other run has claimed it.
    """
    name = f".{path.name}{_END}"
    if len(os.fsencode(name)) > LONGEST:
        name = f".{zlib.crc32(os.fsencode(path.name)):08x}{_END}"
    beside = path.with_name(name)
    handle, ours = _opened(beside)
    try:
        yield ours
    finally:
        _released(handle, beside if ours else None)


@contextmanager
def to_be_made(targets: Targets, target: Path, frames: Sequence[int | None], wanted: Wanted) -> Iterator[list[Line]]:
    """Claim a result, for a while, if existing ones are skipped.

    Yields
    ------
    list of dict
        Lines that say why it is not to be made; none if it is.
    """
    if not wanted.skip_existing:
        yield []
        return
    with claimed(target) as ours:
        if target.exists():
            yield [targets.skipped(target, frame) for frame in frames]
        else:
            yield [] if ours else [targets.left_to_another(target, frame) for frame in frames]


def remove_left(folder: Path) -> None:
    """Remove the claims that killed processes have left in a folder; those of other runs are locked and stay."""
    for beside in folder.glob(f".*{_END}"):
        with suppress(OSError):  # gone meanwhile, or of another user
            if beside.stat().st_size == 0:  # as all of ours are
                handle, ours = _opened(beside)
                _released(handle, beside if ours else None)


def _opened(beside: Path) -> tuple[int, bool]:
    """Open the file of a claim and lock it: the one that is there, which another run may have removed meanwhile."""
    while True:
        handle = os.open(beside, os.O_RDWR | os.O_CREAT, 0o666)
        ours = _locked(handle)
        with suppress(FileNotFoundError):
            if not ours or os.path.samestat(os.fstat(handle), beside.stat()):
                return handle, ours
        os.close(handle)


def _released(handle: int, beside: Path | None) -> None:
    """End a claim, and remove its file."""
    if sys.platform == "win32":  # removes no file that is open
        os.close(handle)
    with suppress(OSError):  # another run may look at it
        if beside is not None:
            beside.unlink()
    if sys.platform != "win32":  # first removed, so that nobody locks it in between
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
    except (BlockingIOError, PermissionError):
        return False
    except OSError:  # no locks here: better twice than not at all
        return True
    return True
