"""Metadata of an option: label, help, bounds and choices, declared once and read by every interface."""

from __future__ import annotations

from dataclasses import MISSING, field, fields
from numbers import Integral, Real
from typing import Any, NamedTuple

import numpy as np

from ..run.errors import InvalidSettingsError

_TYPES = {int: (Integral, "a whole number"), float: (Real, "a number"), bool: (bool, "True or False")}


class Choice(NamedTuple):
    """One value of an option with a fixed set of values.

    Attributes
    ----------
    value : str
        The value.
    label : str
        Its name in a panel.
    help : str
        One line about it.
    """

    value: str
    label: str
    help: str


class Option(NamedTuple):
    """Metadata of an option.

    Attributes
    ----------
    label : str
        Its name in a panel.
    help : str
        One or two lines: what it does, its unit, when to change it.
    low, high : float or None
        Minimum and maximum.
    above : bool
        Whether the minimum itself is excluded.
    soft_high : float or None
        Maximum that a slider offers.
    digits : int
        Decimal places shown.
    choices : tuple of Choice
        The allowed values, if they are a fixed set.
    """

    label: str
    help: str
    low: float | None = None
    high: float | None = None
    above: bool = False
    soft_high: float | None = None
    digits: int = 2
    choices: tuple[Choice, ...] = ()

    @property
    def range(self) -> str:
        """The allowed values in words."""
        if self.choices:
            return "one of " + ", ".join(choice.value for choice in self.choices)
        if self.above:
            return f"above {self.low:g} and at most {self.high:g}"
        return f"at least {self.low:g}" if self.high is None else f"from {self.low:g} to {self.high:g}"

    def allows(self, value: Any) -> bool:
        """Check whether a value is allowed.

        `value`: the value, of the right type.

        Examples
        --------
        >>> share = Option("Share", "Part of the whole", low=0, high=1)
        >>> share.allows(0.5), share.allows(2), share.range
        (True, False, 'from 0 to 1')
        """
        if self.choices:
            return value in {choice.value for choice in self.choices}
        if self.low is None:
            return True
        return bool((value > self.low if self.above else value >= self.low) and value <= (self.high or float("inf")))


def option(default: Any, label: str, help: str, **about: Any) -> Any:  # noqa: A002 (the field's word)
    """Declare an option as a field of a dataclass.

    `default`: its default value; its type is the option's.

    Examples
    --------
    >>> from dataclasses import dataclass
    >>> @dataclass
    ... class Brush:
    ...     size: int = option(3, "Size", "Width of a stroke, in pixels", low=1)
    >>> options_of(Brush)["size"].label
    'Size'
    """
    return field(default=default, metadata={"option": Option(label, help, **about)})


def options_of(owner: Any) -> dict[str, Option]:
    """List the options that a dataclass declares.

    `owner`: the dataclass.

    Examples
    --------
    >>> from addon.core import Settings
    >>> list(options_of(Settings))[:2]
    ['method', 'quality']
    """
    return {each.name: each.metadata["option"] for each in fields(owner) if "option" in each.metadata}


def require_allowed(owner: Any) -> None:
    """Raise an error for a value of a wrong type or outside its range.

    `owner`: a dataclass with options.

    Examples
    --------
    >>> from dataclasses import dataclass
    >>> @dataclass
    ... class Brush:
    ...     size: int = option(3, "Size", "Width of a stroke, in pixels", low=1)
    >>> require_allowed(Brush(5))
    >>> try:
    ...     require_allowed(Brush(0))
    ... except InvalidSettingsError as error:
    ...     print(error)
    size must be at least 1; got 0.
    """
    for each in fields(owner):
        about, value = each.metadata.get("option"), getattr(owner, each.name)
        if about is None or each.default is MISSING:
            continue
        kind, called = _TYPES.get(type(each.default), (object, ""))
        if not isinstance(value, kind):
            raise InvalidSettingsError("setting_range", name=each.name, range=called, value=value)
        if not about.allows(value):
            raise InvalidSettingsError("setting_range", name=each.name, range=about.range, value=value)


def vertex_list(name: str, value: Any) -> tuple[int, ...] | None:
    """Return vertices of an option that need not be given as whole numbers of Python, which are written out in full.

    `name`: of the option; `value`: what was given; None, and an empty list, for none.

    Examples
    --------
    >>> import numpy as np
    >>> vertex_list("part_here", np.array([2, 5])), vertex_list("part_here", [])
    ((2, 5), None)
    """
    if value is None:
        return None
    try:
        given = np.asarray(value)
    except ValueError:  # rows of different lengths
        given = np.zeros((1, 1))
    if given.size == 0:
        return None
    if given.ndim != 1 or not np.issubdtype(given.dtype, np.integer) or given.min() < 0:
        raise InvalidSettingsError("setting_range", name=name, range="a list of vertices", value=value)
    return tuple(given.tolist())
