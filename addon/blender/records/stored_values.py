"""Values out of stored JSON, each of the type that it must have: a file from a stranger may hold anything."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

_Value = TypeVar("_Value")
_MOST = 10**15  # of a whole number
_LARGEST = 1e30


def whole(value: Any) -> int:
    """Take a whole number.

    Parameters
    ----------
    value : object
        What is stored.

    Returns
    -------
    int
        The number.

    Raises
    ------
    ValueError
        If it is none, or larger than any that this project writes.

    Examples
    --------
    >>> whole(3)
    3
    """
    if isinstance(value, int) and not isinstance(value, bool) and abs(value) <= _MOST:
        return value
    raise ValueError(f"{value!r:.40} is not a whole number.")


def real(value: Any) -> float:
    """Take a finite number.

    Parameters
    ----------
    value : object
        What is stored.

    Returns
    -------
    float
        The number.

    Raises
    ------
    ValueError
        If it is none.

    Examples
    --------
    >>> real(1)
    1.0
    """
    if isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= _LARGEST:  # false for nan
        return float(value)
    raise ValueError(f"{value!r:.40} is not a finite number.")


def words(value: Any) -> str:
    """Take a text.

    Parameters
    ----------
    value : object
        What is stored.

    Returns
    -------
    str
        The text.

    Raises
    ------
    ValueError
        If it is none, or none that Blender can show.

    Examples
    --------
    >>> words("Basis")
    'Basis'
    """
    if isinstance(value, str) and not any("\ud800" <= each <= "\udfff" for each in value):
        return value
    raise ValueError(f"{value!r:.40} is not a text.")


def flag(value: Any) -> bool:
    """Take a truth value.

    Parameters
    ----------
    value : object
        What is stored.

    Returns
    -------
    bool
        The truth value.

    Raises
    ------
    ValueError
        If it is none.

    Examples
    --------
    >>> flag(True)
    True
    """
    if isinstance(value, bool):
        return value
    raise ValueError(f"{value!r:.40} is neither true nor false.")


def maybe(take: Callable[[Any], _Value], value: Any) -> _Value | None:
    """Take a value that may be missing.

    Parameters
    ----------
    take : callable
        Takes the value.
    value : object
        What is stored; None where it is missing.

    Returns
    -------
    object or None
        The value.

    Raises
    ------
    ValueError
        If it is of another type.

    Examples
    --------
    >>> maybe(whole, None) is None
    True
    """
    return None if value is None else take(value)


def listed(take: Callable[[Any], _Value], value: Any, count: int | None = None) -> list[_Value]:
    """Take a list.

    Parameters
    ----------
    take : callable
        Takes each of its values.
    value : object
        What is stored.
    count : int, optional
        How many it must have.

    Returns
    -------
    list
        The values.

    Raises
    ------
    ValueError
        If it is no list, or one of another length or other values.

    Examples
    --------
    >>> listed(whole, [1, 2])
    [1, 2]
    """
    if not isinstance(value, list) or count not in (None, len(value)):
        raise ValueError(f"{value!r:.40} is not the list that it should be.")
    return [take(each) for each in value]


def named(take: Callable[[Any], _Value], value: Any) -> dict[str, _Value]:
    """Take values by name.

    Parameters
    ----------
    take : callable
        Takes each of the values.
    value : object
        What is stored.

    Returns
    -------
    dict
        The values.

    Raises
    ------
    ValueError
        If it is no such thing, or has other values.

    Examples
    --------
    >>> named(real, {"Detail": 0.5})
    {'Detail': 0.5}
    """
    if not isinstance(value, dict):
        raise ValueError(f"{value!r:.40} has no names.")
    return {words(name): take(each) for name, each in value.items()}
