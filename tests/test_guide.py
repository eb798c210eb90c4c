"""The pages for artists that the extension carries."""

import posixpath
import re

import pytest

from addon.interface import preferences
from tools import guide


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    folder = tmp_path_factory.mktemp("guide")
    return folder, guide.write_guide(folder)


def test_every_link_leads_to_a_page_or_a_picture_of_the_guide(written):
    folder, pages = written
    names = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}
    for page in pages:
        here = page.relative_to(folder).parent.as_posix()
        for link, anchor in re.findall(r'(?:href|src)="([^"#]*)(#[^"]*)?"', page.read_text(encoding="utf-8")):
            if "://" in link:
                continue
            there = posixpath.normpath(posixpath.join(here, link)) if link else page.relative_to(folder).as_posix()
            assert there in names, (page.name, link)
            if anchor:
                assert f'id="{anchor[1:]}"' in (folder / there).read_text(encoding="utf-8"), (page.name, link, anchor)


def test_pages_have_titles_tables_and_lists_and_no_markdown(written):
    _, pages = written
    texts = [page.read_text(encoding="utf-8") for page in pages]
    assert all("<title>" in text and "<h1" in text for text in texts)
    assert any("<table>" in text for text in texts)
    assert any("<ul>" in text for text in texts)
    assert not any(re.search(r"\]\(|^#+ ", text, re.MULTILINE) for text in texts)


def test_the_preferences_open_pages_that_there_are(written):
    folder, _ = written
    assert all((folder / page).is_file() for page in (preferences.FIRST, preferences.OPTIONS, preferences.TROUBLE))
