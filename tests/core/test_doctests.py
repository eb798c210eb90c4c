"""The examples in the docstrings of the core run, and every public function, and class with work to do, has one."""

import doctest
import inspect
from dataclasses import is_dataclass
from importlib import import_module
from pkgutil import walk_packages

import pytest

import addon.core

MODULES = ["addon.core", *(each.name for each in walk_packages(addon.core.__path__, "addon.core."))]


def public():
    """Every public function and class of the core by name, where it is defined."""
    found = {}
    for name in MODULES:
        module = import_module(name)
        for each in vars(module).values():
            if (
                (inspect.isfunction(each) or inspect.isclass(each))
                and each.__module__ == name
                and each.__name__[0] != "_"
            ):
                found[f"{name.removeprefix('addon.core.')}.{each.__name__}"] = each
    return found


PUBLIC = public()


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


@pytest.mark.parametrize("name", [name for name, thing in PUBLIC.items() if not needs_none(thing)])
def test_public_names_have_an_example(name):
    assert doctest.DocTestParser().get_examples(inspect.getdoc(PUBLIC[name]) or "")
