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
HEAD = """# API of the core

`canonical_form.core` needs numpy and scipy only, and no Blender. Arrays in, arrays out. The doors, what they give back,
`Settings` and the errors are imported from `canonical_form`; everything else from the module it is listed under. In a
checkout that is not installed, the package is called `addon`. [For Python](../python.md) is where to start. These pages
are made from the docstrings by `make docs`; [notation](../notation.md) lists symbols, shapes and names of maps.

| page | what is in it |
| --- | --- |
| [doors](doors.md) | What a script calls. |
"""


def pages() -> dict[str, str]:
    """Return all pages by file name: the index, the doors, then one page per room, from the lowest to the highest."""
    found = {"doors.md": page("# Doors\n\nWhat a script calls.\n", importlib.import_module("addon.core"))}
    rows = []
    listed = (ROOT / "addon" / "core" / "README.md").read_text(encoding="utf-8")
    for room in re.findall(r"^\| `(\w+)` \|", listed, flags=re.MULTILINE):
        package = importlib.import_module(f"addon.core.{room}")
        purpose = (package.__doc__ or "").strip()
        found[f"{room}.md"] = page(f"# Room `{room}`\n\n{purpose}\n", package)
        rows.append(f"| [{room}]({room}.md) | {' '.join(purpose.split())} |\n")
    return {"README.md": HEAD + "".join(rows), **{name: installed(text) for name, text in found.items()}}


def installed(text: str) -> str:
    """Call the package as it is called where it is installed."""
    return re.sub(r"\baddon\.core\b", "canonical_form.core", text)


def page(head: str, package: ModuleType) -> str:
    """Return the page of a package: what it is, then everything public in its modules."""
    parts = [head]
    for each in pkgutil.iter_modules(package.__path__):
        if not each.ispkg and not each.name.startswith("_"):
            parts += module_reference(importlib.import_module(f"{package.__name__}.{each.name}"))
    return "\n".join(parts)


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
