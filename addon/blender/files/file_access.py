"""Early checks that a file can be read and a folder written to."""

from __future__ import annotations

import tempfile
from collections.abc import Collection, Iterable
from pathlib import Path

from ...core.run.errors import CanonicalFormError, InvalidMeshError
from ..words.file_errors import reason


def require_readable(path: Path) -> None:
    """Require that a file exists and can be read.

    Parameters
    ----------
    path : Path
        The file.

    Raises
    ------
    InvalidMeshError
        If it does not exist or cannot be read.
    """
    try:
        if not path.is_file():
            raise InvalidMeshError(f"{path} is not a file.")
        with path.open("rb"):
            pass
    except OSError as error:
        advice = " Change its permissions." if isinstance(error, PermissionError) else ""
        raise InvalidMeshError(f"{path} cannot be read: {reason(error)}.{advice}") from error


def require_folder(folder: Path) -> None:
    """Create a folder for results and require that files can be written to it.

    Parameters
    ----------
    folder : Path
        The folder.

    Raises
    ------
    CanonicalFormError
        If it cannot be created or written to.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise CanonicalFormError(
            f"The folder {folder} for the results cannot be made: {reason(error)}. Choose another --output."
        ) from error
    try:
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise CanonicalFormError(
            f"Nothing can be written to {folder}: {reason(error)}. Choose another --output."
        ) from error


def require_named(path: Path, names: Iterable[str], there: Collection[str]) -> None:
    """Require that a file holds the objects that were asked for.

    Parameters
    ----------
    path : Path
        The file.
    names : iterable of str
        Names of the objects.
    there : collection of str
        Names of the mesh objects in the file.

    Raises
    ------
    InvalidMeshError
        If one is missing; the message names it.
    """
    missing = sorted(set(names) - set(there))
    if missing:
        raise InvalidMeshError(f"{path.name} holds no mesh object named {', '.join(map(repr, missing))}.")
