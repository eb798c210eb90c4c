"""Rejects a release whose version differs between files: `python tools/release_check.py v1.2.3`.

The tag, the manifest, pyproject.toml, CITATION.cff and the latest released section of the changelog must have the same
version. Exit code 0: they do; 1: they do not, with one message per difference; 2: no tag was given.
"""

from __future__ import annotations

import re
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def citation_version(text: str) -> str | None:
    """Read the version from the text of CITATION.cff, from its top level only; None if there is none."""
    found = re.search(r"""^version:\s*["']?([^"'\s#]+)""", text, flags=re.MULTILINE)
    return found.group(1) if found else None


def released_version(text: str) -> str | None:
    """Read the version of the changelog's first section that is not marked as unreleased; None if there is none.

    Examples
    --------
    >>> released_version("# Changelog\\n\\n## Unreleased\\n\\n## 1.2.0 (2026-03-01)\\n\\n## 1.1.0 (2026-01-01)\\n")
    '1.2.0'
    """
    headings = re.findall(r"^## (\d+\.\d+\.\d+)(?=\s|$)(.*)", text, flags=re.MULTILINE)
    return next((version for version, rest in headings if "unreleased" not in rest.lower()), None)


PLACES: dict[str, Callable[[str], str | None]] = {
    "blender_manifest.toml": lambda text: tomllib.loads(text).get("version"),
    "pyproject.toml": lambda text: tomllib.loads(text).get("project", {}).get("version"),
    "CITATION.cff": citation_version,
    "docs/CHANGELOG.md": released_version,
}


def disagreements(tag: str, root: Path) -> list[str]:
    """Return one message for each file of a checkout whose version is not that of a tag, such as v1.2.3."""
    if not re.fullmatch(r"v\d+\.\d+\.\d+", tag):
        return [f"The tag {tag!r} is not of the form vX.Y.Z."]
    wanted, sentences = tag.removeprefix("v"), []
    for name, version_of in PLACES.items():
        path = root / name
        if not path.is_file():
            sentences.append(f"{name} is missing.")
        elif (found := version_of(path.read_text(encoding="utf-8"))) != wanted:
            states = f"version {found}" if found else "no released version"
            sentences.append(f"{name} states {states}; the tag says {wanted}.")
    return sentences


def main(arguments: list[str]) -> int:
    """Print the differences between the tag, the only argument, and this checkout; return the exit code."""
    if len(arguments) != 1:
        print("Usage: python tools/release_check.py vX.Y.Z", file=sys.stderr)
        return 2
    sentences = disagreements(arguments[0], ROOT)
    for sentence in sentences:
        print(sentence, file=sys.stderr)
    return 1 if sentences else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
