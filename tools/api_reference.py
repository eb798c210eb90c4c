"""Writes docs/api from the docstrings of the core, one page per room: `make docs`.

With ``--check`` it only checks whether all pages are up to date.
"""

import importlib
import inspect
import pkgutil
import re
import sys
import textwrap
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))
TARGET = ROOT / "docs" / "api"
DOORS = (
    "canonical", "features", "distance_fields", "limbs", "matches", "poses", "mannequins", "transfers", "results",
)  # fmt: skip
ROOMS = (
    "run", "numerics", "modelling", "mesh", "surface", "distances", "detection", "patching", "stress", "deformation",
    "symmetry", "embedding", "measures", "method_api", "methods", "posing", "matching", "placing", "assembly",
)  # fmt: skip
HEAD = """# API of the core

`addon.core` needs numpy and scipy only, and no Blender. Arrays in, arrays out. The doors, what they give back,
`Settings` and the errors are imported from `addon.core`; everything else from the module it is listed under. These
pages are made from the docstrings by `make docs`; [notation](../notation.md) lists symbols, shapes and names of maps.

| page | what is in it |
| --- | --- |
| [doors](doors.md) | What a script calls. |
"""


def pages() -> dict[str, str]:
    """Return all pages by file name: the index, the doors, then one page per room, from the lowest to the highest."""
    core = importlib.import_module("addon.core")
    require_all(core, DOORS, packages=False)
    require_all(core, ROOMS, packages=True)
    doors = ["# Doors\n\nWhat a script calls.\n"]
    for door in DOORS:
        doors += module_reference(importlib.import_module(f"addon.core.{door}"))
    found, rows = {"doors.md": "\n".join(doors)}, []
    for room in ROOMS:
        package = importlib.import_module(f"addon.core.{room}")
        purpose = (package.__doc__ or "").strip()
        parts = [f"# Room `{room}`\n\n{purpose}\n"]
        for name in names_in(package, packages=False):
            parts += module_reference(importlib.import_module(f"{package.__name__}.{name}"))
        found[f"{room}.md"] = "\n".join(parts)
        rows.append(f"| [{room}]({room}.md) | {' '.join(purpose.split())} |\n")
    return {"README.md": HEAD + "".join(rows), **found}


def names_in(package: ModuleType, *, packages: bool) -> list[str]:
    """Return the names of the public modules or packages in a package."""
    found = pkgutil.iter_modules(package.__path__)
    return [each.name for each in found if each.ispkg == packages and not each.name.startswith("_")]


def require_all(package: ModuleType, listed: tuple[str, ...], *, packages: bool) -> None:
    """Stop if the list and the existing modules differ."""
    odd = set(names_in(package, packages=packages)) ^ set(listed)
    if odd:
        raise SystemExit(
            f"not in the list of {'rooms' if packages else 'doors'}, or not there: {', '.join(sorted(odd))}"
        )


def module_reference(module: ModuleType) -> Iterator[str]:
    """Yield heading and docstring of a module, then everything public that is defined in it."""
    yield f"## `{module.__name__}`\n\n{(module.__doc__ or '').strip()}\n"
    for each in vars(module).values():
        if not (inspect.isclass(each) or inspect.isfunction(each)):
            continue
        if each.__module__ != module.__name__ or each.__name__.startswith("_"):
            continue
        yield described(each.__name__, each)
        for name, method in vars(each).items() if inspect.isclass(each) else ():
            documented = inspect.isfunction(method) and (method.__doc__ or "").strip()
            if documented and (name == "__call__" or not name.startswith("_")):
                yield described(f"{each.__name__}.{name}", method)


def described(name: str, thing: Any) -> str:
    """Return heading, signature and docstring of one object."""
    lines = [f"### `{name}`\n"]
    if inspect.isfunction(thing):
        lines.append(f"```python\n{name}{signature(thing)}\n```\n")
    return "\n".join(lines) + "\n" + markdown(inspect.getdoc(thing) or "") + "\n"


def signature(function: Any) -> str:
    """Return parameters and defaults; the docstring has the types."""
    plain = [
        parameter.replace(annotation=inspect.Parameter.empty)
        for parameter in inspect.signature(function).parameters.values()
    ]
    return re.sub(r"<function (\w+) at 0x\w+>", r"\1", str(inspect.Signature(plain)))


def markdown(docstring: str) -> str:
    """Convert numpydoc sections to headings, lists and, for examples, code."""
    pieces = re.split(r"^([A-Z][a-z]+)\n-+\n", docstring, flags=re.MULTILINE)
    result = [plain(pieces[0])]
    for title, body in zip(pieces[1::2], pieces[2::2], strict=True):
        result.append(f"**{title}**\n")
        if title == "Examples":
            result.append(f"```pycon\n{body.strip()}\n```\n")
        elif title in ("References", "Notes"):
            result.append(plain(body))
        else:
            result += [*entries(body), ""]
    return "\n".join(result)


def plain(text: str) -> str:
    """Convert the text of a docstring to Markdown."""
    return text.replace("``", "`").strip() + "\n"


def entries(body: str) -> Iterator[str]:
    """Yield the list items for a section of names and descriptions."""
    for entry in filter(None, re.split(r"^(?=\S)", body.replace("``", "`").strip(), flags=re.MULTILINE)):
        first, _, rest = entry.partition("\n")
        meaning = " ".join(textwrap.dedent(rest).split())
        yield f"- `{first.strip()}`" + (f": {meaning}" if meaning else "")


def main(check: bool) -> None:
    """Write the pages and remove outdated ones; with `check`, only stop if a page is not up to date."""
    made = pages()
    old = {path.name: path.read_text(encoding="utf-8") for path in TARGET.glob("*.md")}
    if check:
        sys.exit(0 if made == old else "docs/api is out of date: run make docs")
    TARGET.mkdir(exist_ok=True)
    for name in old.keys() - made.keys():
        (TARGET / name).unlink()
    for name, text in made.items():
        (TARGET / name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main("--check" in sys.argv)
