"""The site: its pages lead to each other, and nothing is left out."""

import re
from pathlib import Path

import pytest

from tools.site.pages import gather, indented_lists, page_places, turned_links

ROOT = Path(__file__).resolve().parents[1]


def test_every_page_is_gathered_with_what_it_leads_to(tmp_path):
    places = gather(ROOT, tmp_path / "pages")
    assert {"index.md", "install.md", "examples.md", "rooms.md", "contributing.md", "api/index.md"} <= set(places)
    for place in places:
        page = tmp_path / "pages" / place
        for link in re.findall(r"\]\(([^)#\s]+)", page.read_text(encoding="utf-8")):
            assert "://" in link or (page.parent / link).stat().st_size > 0, f"{place}: {link}"


def test_the_navigation_names_every_page():
    navigation = (ROOT / "tools" / "site" / "mkdocs.yml").read_text(encoding="utf-8").split("\nnav:")[1]
    named = re.findall(r"(\S+\.md)$", navigation, flags=re.MULTILINE)
    assert sorted(named) == sorted(page_places(ROOT).values())


def test_links_are_turned_to_where_pages_lie():
    places = page_places(ROOT)
    text, files = turned_links("[a](docs/api/README.md#x) [b](LICENSE) [c](#here)", "README.md", places, ROOT)
    assert text == "[a](api/index.md#x) [b](LICENSE) [c](#here)"
    assert files == {"LICENSE": "LICENSE"}
    text, files = turned_links("![p](pictures/rooms.png) [r](../README.md)", "docs/method.md", places, ROOT)
    assert text == "![p](pictures/rooms.png) [r](index.md)"
    assert files == {"docs/pictures/rooms.png": "pictures/rooms.png"}
    with pytest.raises(ValueError, match="nowhere"):
        turned_links("[d](nowhere.md)", "README.md", places, ROOT)


def test_what_belongs_to_an_entry_is_indented_as_the_site_needs_it():
    text = "1. one\n   more\n\n   ![p](p.png)\n\nplain\n  kept\n```\n- code\n  x\n```\n"
    assert indented_lists(text) == "1. one\n    more\n\n    ![p](p.png)\n\nplain\n  kept\n```\n- code\n  x\n```\n"
