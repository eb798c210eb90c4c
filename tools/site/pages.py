"""The project's documents as the pages of its site, with links adapted to the location of each page."""

from __future__ import annotations

import os
import re
import shutil
from pathlib import Path, PurePosixPath

ROOT = Path(__file__).resolve().parents[2]
ELSEWHERE = {  # documents outside docs, and the pages that they become
    "README.md": "index.md",
    "CONTRIBUTING.md": "contributing.md",
    "addon/core/README.md": "rooms.md",
    "addon/blender/README.md": "blender-rooms.md",
    "docs/api/README.md": "api/index.md",
}
_LINK = re.compile(r"(\]\()([^)#\s]*)(#[^)\s]*)?(\))")


def page_places(root: Path) -> dict[str, str]:
    """Return the path of each page in the site, by the path of its document in the checkout."""
    found = {str(path.relative_to(root)): str(path.relative_to(root / "docs")) for path in root.glob("docs/**/*.md")}
    return {**found, **ELSEWHERE}


def turned_links(text: str, document: str, places: dict[str, str], root: Path) -> tuple[str, dict[str, str]]:
    """Adapt the links of a document to the locations of pages, as `page_places` returns them, and files in the site.

    Returns the page, and the files that the site needs besides its pages: their location by path in the checkout.
    Raises ValueError if a link has no target.
    """
    files: dict[str, str] = {}
    here = PurePosixPath(places[document]).parent

    def turned(found: re.Match[str]) -> str:
        before, target, anchor, after = found.groups()
        if not target or "://" in target or target.startswith("mailto:"):
            return found.group()
        meant = os.path.normpath(PurePosixPath(document).parent / target)
        if meant in places:
            place = places[meant]
        elif (root / meant).is_file():
            place = files[meant] = meant.removeprefix("docs/")
        else:
            raise ValueError(f"{document} links to {target}, which is not there.")
        return f"{before}{os.path.relpath(place, here)}{anchor or ''}{after}"

    return _LINK.sub(turned, text), files


def indented_lists(text: str) -> str:
    """Indent the content of list items by four spaces, as Python-Markdown requires, except in code blocks."""
    lines, code, inside = [], False, False
    for line in text.splitlines():
        fence = line.lstrip().startswith("```")
        if re.match(r"(\d+\.|[-*]) ", line) and not code:
            inside = True
        elif line and not line.startswith(" ") and not code:
            inside = False
        depth = len(line) - len(line.lstrip())
        lines.append(" " * (4 - depth) + line if inside and depth in (2, 3) else line)
        code ^= fence
    return "\n".join(lines) + "\n"


def gather(root: Path, target: Path) -> list[str]:
    """Write the pages of the site, with linked pictures and files, to a new folder; return their locations."""
    shutil.rmtree(target, ignore_errors=True)
    places = page_places(root)
    for document, place in places.items():
        text, files = turned_links((root / document).read_text(encoding="utf-8"), document, places, root)
        (target / place).parent.mkdir(parents=True, exist_ok=True)
        (target / place).write_text(indented_lists(text), encoding="utf-8")
        for path, where in files.items():
            (target / where).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(root / path, target / where)
    return sorted(places.values())
