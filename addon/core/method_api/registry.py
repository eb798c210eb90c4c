"""Discovery of the methods: every file of the room `methods` is found automatically; none is listed anywhere."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from ..run.errors import InvalidSettingsError

OURS = "straight"  # the default


def declared_methods() -> dict[str, Any]:
    """Collect what the files of the room `methods` declare.

    Examples
    --------
    >>> list(declared_methods())[:3]
    ['straight', 'classical', 'least_squares']
    """
    from pkgutil import iter_modules

    room = import_module("..methods", __package__)
    found = [
        each for file in iter_modules(room.__path__) for each in import_module(f"{room.__name__}.{file.name}").METHODS
    ]
    return {each.name: each for each in sorted(found, key=lambda each: (each.rank, each.name))}


def declared_method(name: str) -> Any:
    """Look up a method by its name.

    `name`: its name.

    Examples
    --------
    >>> declared_method("fast").label
    'Fast MDS'
    """
    known = declared_methods()
    if name not in known:
        raise InvalidSettingsError("unknown_method", names=", ".join(known), value=name)
    return known[name]
