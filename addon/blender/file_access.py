"""Whether a file can be read and a folder written to, found out before the work, and told in sentences."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from ..core.run.errors import CanonicalFormError, InvalidMeshError


def require_readable(path: Path) -> None:
    """Check that a file is there and may be read.

    Parameters
    ----------
    path : Path
        The file.

    Raises
    ------
    InvalidMeshError
        If not.
    """
    try:
        if not path.is_file():
            raise InvalidMeshError(f"{path} is not a file.")
        with path.open("rb"):
            pass
    except OSError as error:
        advice = " Change its permissions." if isinstance(error, PermissionError) else ""
        raise InvalidMeshError(f"{path} cannot be read: {_reason(error)}.{advice}") from error


def require_folder(folder: Path) -> None:
    """Make a folder for results, and check that files can be written to it.

    Parameters
    ----------
    folder : Path
        The folder.

    Raises
    ------
    CanonicalFormError
        If it cannot be made, or nothing can be written there.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise CanonicalFormError(
            f"The folder {folder} for the results cannot be made: {_reason(error)}. Choose another --output."
        ) from error
    try:
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise CanonicalFormError(
            f"Nothing can be written to {folder}: {_reason(error)}. Choose another --output."
        ) from error


def sentence(error: OSError) -> str:
    """Tell what went wrong with a file, without the number of the error.

    Parameters
    ----------
    error : OSError
        The error.

    Returns
    -------
    str
        The sentence.

    Examples
    --------
    >>> sentence(PermissionError(13, "Permission denied", "forms/a.obj"))
    'forms/a.obj: permission denied.'
    >>> sentence(OSError("Is the disk full?"))
    'Is the disk full?'
    """
    if error.strerror is None:
        return str(error)
    named = isinstance(error.filename, str | bytes | os.PathLike)
    return f"{os.fsdecode(error.filename)}: {_reason(error)}." if named else f"{error.strerror}."


def _reason(error: OSError) -> str:
    """Tell why, as it stands within a sentence."""
    reason = error.strerror or str(error)
    return reason[:1].lower() + reason[1:]
