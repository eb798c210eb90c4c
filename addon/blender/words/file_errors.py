"""Sentences for file errors."""

from __future__ import annotations

import os


def sentence(error: OSError) -> str:
    """Describe a file error in a sentence, without its error number.

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
    return f"{os.fsdecode(error.filename)}: {reason(error)}." if named else f"{error.strerror}."


def reason(error: OSError) -> str:
    """Return the reason for a file error, for use inside a sentence.

    Parameters
    ----------
    error : OSError
        The error.

    Returns
    -------
    str
        The reason.

    Examples
    --------
    >>> reason(PermissionError(13, "Permission denied", "forms/a.obj"))
    'permission denied'
    """
    said = error.strerror or str(error)
    return said[:1].lower() + said[1:]
