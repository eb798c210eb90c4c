"""The examples in the docstrings of the core run, and every door of the core has one."""

import doctest
import inspect
from dataclasses import is_dataclass
from importlib import import_module
from pkgutil import walk_packages

import pytest

import addon.core

MODULES = ["addon.core", *(each.name for each in walk_packages(addon.core.__path__, "addon.core."))]


DOORS = {name: getattr(addon.core, name) for name in addon.core.__all__}


@pytest.mark.parametrize("name", MODULES)
def test_examples_run(name):
    assert doctest.testmod(import_module(name)).failed == 0


def needs_none(thing):
    """Records, errors and protocols have nothing to run."""
    return inspect.isclass(thing) and (
        is_dataclass(thing)
        or hasattr(thing, "_fields")
        or issubclass(thing, Exception)
        or getattr(thing, "_is_protocol", False)
    )


@pytest.mark.parametrize("name", [name for name, thing in DOORS.items() if not needs_none(thing)])
def test_doors_have_an_example(name):
    assert doctest.DocTestParser().get_examples(inspect.getdoc(DOORS[name]) or "")
