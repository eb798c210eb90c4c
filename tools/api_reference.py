"""Writes docs/api.md from the docstrings of the core: `make docs`. With ``--check`` it only says if it is current."""

import importlib
import inspect
import pkgutil
import re
import sys
import textwrap
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))
TARGET = ROOT / "docs" / "api.md"
MODULES = (  # in the order of the data
    "canonical", "recognition", "local_features", "embedding", "settings", "errors", "surface", "mending", "parts",
    "coarsening", "delaunay", "laplacian", "spectrum", "features", "heat", "patches", "distances", "struts", "pairs",
    "scaling",
    "arrangement", "stress", "products", "weight_inverse", "smacof", "pushing", "deformation", "detail", "articulation",
    "limbs", "fast_marching", "fields", "alignment", "measures", "memory", "monitor", "rivals.choice",
    "rivals.samples", "rivals.classical", "rivals.least_squares", "rivals.non_metric", "rivals.fast",
    "rivals.euclidean", "rivals.one_form", "rivals.skeleton",
)  # fmt: skip
HEAD = """# API of the core

`addon.core` needs numpy and scipy only, and no Blender. Arrays in, arrays out. The first two names and the errors are
imported from `addon.core`; everything else from the module it is listed under. This page is made from the docstrings
by `make docs`.
"""


def reference() -> str:
    """Assemble the page."""
    core = str(ROOT / "addon" / "core")
    found = {each.name for each in pkgutil.iter_modules([core]) if not each.ispkg}
    found |= {f"rivals.{each.name}" for each in pkgutil.iter_modules([f"{core}/rivals"])}
    missing = found - set(MODULES)
    if missing:
        raise SystemExit(f"not in the list of modules: {', '.join(sorted(missing))}")
    parts = [HEAD]
    for name in MODULES:
        module = importlib.import_module(f"addon.core.{name}")
        parts.append(f"## `addon.core.{name}`\n\n{module.__doc__.strip()}\n")
        for each in vars(module).values():
            public = getattr(each, "__module__", "") == module.__name__ and not each.__name__.startswith("_")
            if inspect.isclass(each) and public:
                parts.append(described(each.__name__, each))
                for method_name, method in vars(each).items():
                    documented = inspect.isfunction(method) and (method.__doc__ or "").strip()
                    if documented and (method_name == "__call__" or not method_name.startswith("_")):
                        parts.append(described(f"{each.__name__}.{method_name}", method))
            elif inspect.isfunction(each) and public:
                parts.append(described(each.__name__, each))
    return "\n".join(parts)


def described(name: str, thing: object) -> str:
    """One heading, signature and docstring."""
    text = inspect.getdoc(thing) or ""
    is_function = inspect.isfunction(thing)
    lines = [f"### `{name}`\n"]
    if is_function:
        lines.append(f"```python\n{name}{signature(thing)}\n```\n")
    return "\n".join(lines) + "\n" + markdown(text) + "\n"


def signature(function: object) -> str:
    """Parameters and defaults; types are told in the text."""
    plain = [
        parameter.replace(annotation=inspect.Parameter.empty)
        for parameter in inspect.signature(function).parameters.values()
    ]
    return str(inspect.Signature(plain))


def markdown(docstring: str) -> str:
    """Turn numpydoc sections into headings and lists."""
    docstring = docstring.replace("``", "`")
    pieces = re.split(r"^([A-Z][a-z]+)\n-+\n", docstring, flags=re.MULTILINE)
    result = [pieces[0].strip() + "\n"]
    for title, body in zip(pieces[1::2], pieces[2::2], strict=True):
        result.append(f"**{title}**\n")
        if title in ("References", "Notes"):
            result.append(body.strip() + "\n")
            continue
        entries = re.split(r"^(?=\S)", body.strip(), flags=re.MULTILINE)
        for entry in filter(None, entries):
            first, _, rest = entry.partition("\n")
            meaning = " ".join(textwrap.dedent(rest).split())
            result.append(f"- `{first.strip()}`" + (f": {meaning}" if meaning else ""))
        result.append("")
    return "\n".join(result)


if __name__ == "__main__":
    page = reference()
    if "--check" in sys.argv:
        sys.exit(0 if TARGET.exists() and TARGET.read_text() == page else "docs/api.md is out of date: run make docs")
    TARGET.write_text(page)
