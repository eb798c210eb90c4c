"""The pages for artists as files that any browser shows, for the zip: the preferences open them.

Called by `package.py`. Links to other documents, which are not in the zip, become plain text.
"""

from __future__ import annotations

import html
import os
import re
import shutil
from pathlib import Path, PurePosixPath

from tools.site.pages import indented_lists

ROOT = Path(__file__).resolve().parents[1]
PAGES = ("user-guide.md", "options.md", "troubleshooting.md", "what-is-written.md", "canonical-form.md", "any-mesh.md")
FOLDERS = ("tasks",)
_LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)#\s]*)(#[^)\s]*)?\)")
_PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>{title}</title><style>
body {{ font: 16px/1.5 sans-serif; max-width: 46em; margin: 2em auto; padding: 0 1em; color: #222; }}
img {{ max-width: 100%; }} code {{ background: #eee; }} pre {{ background: #eee; padding: 1em; overflow: auto; }}
table {{ border-collapse: collapse; }} td, th {{ border: 1px solid #ccc; padding: .3em .6em; text-align: left; }}
</style></head><body>
{body}
</body></html>
"""


def pages() -> list[Path]:
    """List the documents that become pages."""
    docs = ROOT / "docs"
    return [
        *(docs / name for name in PAGES),
        *(path for name in FOLDERS for path in sorted((docs / name).glob("*.md"))),
    ]


def write_guide(target: Path) -> list[Path]:
    """Write the pages with their pictures to a folder; return their paths."""
    import markdown

    docs = ROOT / "docs"
    known = {path.relative_to(docs).as_posix() for path in pages()}
    written = []
    for path in pages():
        place = path.relative_to(docs)
        text, pictures = _linked(path.read_text(encoding="utf-8"), place.as_posix(), known)
        for picture in pictures:
            (target / picture).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(docs / picture, target / picture)
        title = next((line.lstrip("# ") for line in text.splitlines() if line.startswith("# ")), place.stem)
        body = markdown.markdown(indented_lists(text), extensions=["extra", "toc", "sane_lists"])
        page = (target / place).with_suffix(".html")
        page.parent.mkdir(parents=True, exist_ok=True)
        page.write_text(_PAGE.format(title=html.escape(title), body=body), encoding="utf-8")
        written.append(page)
    return written


def _linked(text: str, place: str, known: set[str]) -> tuple[str, set[str]]:
    """Turn links to pages, keep those to pictures and the web, and drop others; also return the pictures."""
    pictures: set[str] = set()
    here = PurePosixPath(place).parent

    def turned(match: re.Match[str]) -> str:
        picture, label, link, anchor = match[1], match[2], match[3], match[4] or ""
        if not link or "://" in link:
            return match[0]
        where = os.path.normpath(here / link)
        if picture and (ROOT / "docs" / where).is_file():
            pictures.add(where)
            return match[0]
        return f"[{label}]({link.removesuffix('.md')}.html{anchor})" if where in known else label

    return _LINK.sub(turned, text), pictures
