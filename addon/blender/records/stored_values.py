"""Checked values from stored JSON: an untrusted file may contain anything."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

_Value = TypeVar("_Value")
_MOST = 10**15  # largest absolute value of an integer
_LARGEST = 1e30


def whole(value: Any) -> int:
    """Return a stored value if it is an integer.

    Parameters
    ----------
    value : object
        The stored value.

    Returns
    -------
    int
        The integer.

    Raises
    ------
    ValueError
        If it is not an integer, or larger than any that this project writes.

    Examples
    --------
    >>> whole(3)
    3
    """
    if isinstance(value, int) and not isinstance(value, bool) and abs(value) <= _MOST:
        return value
    raise ValueError(f"{value!r:.40} is not a whole number.")


def real(value: Any) -> float:
    """Return a stored value if it is a finite number.

    Parameters
    ----------
    value : object
        The stored value.

    Returns
    -------
    float
        The number.

    Raises
    ------
    ValueError
        If it is not a finite number.

    Examples
    --------
    >>> real(1)
    1.0
    """
    if isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= _LARGEST:  # false for NaN
        return float(value)
    raise ValueError(f"{value!r:.40} is not a finite number.")


def words(value: Any) -> str:
    """Return a stored value if it is a string.

    Parameters
    ----------
    value : object
        The stored value.

    Returns
    -------
    str
        The string.

    Raises
    ------
    ValueError
        If it is not a string, or contains surrogates, which Blender cannot show.

    Examples
    --------
    >>> words("Basis")
    'Basis'
    """
    if isinstance(value, str) and not any("\ud800" <= each <= "\udfff" for each in value):
        return value
    raise ValueError(f"{value!r:.40} is not a text.")


def flag(value: Any) -> bool:
    """Return a stored value if it is a Boolean.

    Parameters
    ----------
    value : object
        The stored value.

    Returns
    -------
    bool
        The Boolean.

    Raises
    ------
    ValueError
        If it is not a Boolean.

    Examples
    --------
    >>> flag(True)
    True
    """
    if isinstance(value, bool):
        return value
    raise ValueError(f"{value!r:.40} is neither true nor false.")


def maybe(take: Callable[[Any], _Value], value: Any) -> _Value | None:
    """Return a stored value that may be missing.

    Parameters
    ----------
    take : callable
        Checks the value.
    value : object
        The stored value; None if it is missing.

    Returns
    -------
    object or None
        The checked value.

    Raises
    ------
    ValueError
        If `take` rejects it.

    Examples
    --------
    >>> maybe(whole, None) is None
    True
    """
    return None if value is None else take(value)


def listed(take: Callable[[Any], _Value], value: Any, count: int | None = None) -> list[_Value]:
    """Return a stored value if it is a list.

    Parameters
    ----------
    take : callable
        Checks each element.
    value : object
        The stored value.
    count : int, optional
        Required length.

    Returns
    -------
    list
        The checked elements.

    Raises
    ------
    ValueError
        If it is not a list, has another length, or `take` rejects an element.

    Examples
    --------
    >>> listed(whole, [1, 2])
    [1, 2]
    """
    if not isinstance(value, list) or count not in (None, len(value)):
        raise ValueError(f"{value!r:.40} is not the list that it should be.")
    return [take(each) for each in value]


def named(take: Callable[[Any], _Value], value: Any) -> dict[str, _Value]:
    """Return a stored value if it is a dictionary with string keys.

    Parameters
    ----------
    take : callable
        Checks each value.
    value : object
        The stored value.

    Returns
    -------
    dict
        The checked values, by name.

    Raises
    ------
    ValueError
        If it is not such a dictionary, or `take` rejects a value.

    Examples
    --------
    >>> named(real, {"Detail": 0.5})
    {'Detail': 0.5}
    """
    if not isinstance(value, dict):
        raise ValueError(f"{value!r:.40} has no names.")
    return {words(name): take(each) for name, each in value.items()}
