"""A release is refused unless its version is the same everywhere."""

import re
import shutil
import tomllib
from pathlib import Path

import pytest

from tools import release_check
from tools.release_check import PLACES, citation_version, disagreements, main, released_version

ROOT = Path(__file__).resolve().parents[1]


def restate(path, version):
    """Write another version into the place where a file states its own."""
    text = path.read_text(encoding="utf-8")
    if path.name == "CHANGELOG.md":
        text = re.sub(r"^## .*", f"## Unreleased\n\n## {version} (2026-01-01)", text, count=1, flags=re.MULTILINE)
    else:
        pattern = r"^(version\s*[:=]\s*).*"
        text = re.sub(pattern, rf'\g<1>"{version}"', text, count=1, flags=re.MULTILINE)
    path.write_text(text, encoding="utf-8")


@pytest.fixture
def checkout(tmp_path):
    """A copy of the files of this checkout that state a version, all of them 9.8.7."""
    for name in PLACES:
        (tmp_path / name).parent.mkdir(exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
        restate(tmp_path / name, "9.8.7")
    return tmp_path


def test_a_matching_set_passes(checkout):
    assert disagreements("v9.8.7", checkout) == []


@pytest.mark.parametrize("name", PLACES)
def test_a_file_that_disagrees_is_named(checkout, name):
    restate(checkout / name, "9.8.6")
    assert disagreements("v9.8.7", checkout) == [f"{name} states version 9.8.6; the tag says 9.8.7."]


@pytest.mark.parametrize("name", PLACES)
def test_a_file_that_is_missing_is_named(checkout, name):
    (checkout / name).unlink()
    assert disagreements("v9.8.7", checkout) == [f"{name} is missing."]


def test_a_tag_that_disagrees_is_told_of_every_file(checkout):
    told = disagreements("v9.9.0", checkout)
    assert [sentence.split()[0] for sentence in told] == list(PLACES)
    assert all("the tag says 9.9.0" in sentence for sentence in told)


@pytest.mark.parametrize("tag", ["9.8.7", "v9.8", "v9.8.7-rc1", "release", ""])
def test_a_tag_of_another_form_is_refused(checkout, tag):
    assert disagreements(tag, checkout) == [f"The tag {tag!r} is not of the form vX.Y.Z."]


@pytest.mark.parametrize("heading", ["Unreleased", "9.8.7 (unreleased)"])
def test_a_section_that_is_not_released_does_not_count(checkout, heading):
    (checkout / "docs" / "CHANGELOG.md").write_text(f"# Changelog\n\n## {heading}\n", encoding="utf-8")
    assert disagreements("v9.8.7", checkout) == ["docs/CHANGELOG.md states no released version; the tag says 9.8.7."]


def test_the_newest_released_section_counts():
    assert released_version("## Unreleased\n\n## 1.2.0 (2026-03-01)\n\n## 1.1.0 (2026-01-01)\n") == "1.2.0"


def test_the_version_of_a_reference_is_not_that_of_the_citation():
    assert citation_version("references:\n  - title: A\n    version: 3.0.0\n") is None


def test_the_command_prints_the_sentences_and_fails(checkout, monkeypatch, capsys):
    monkeypatch.setattr(release_check, "ROOT", checkout)
    assert main(["v9.8.7"]) == 0
    restate(checkout / "CITATION.cff", "9.8.6")
    assert main(["v9.8.7"]) == 1
    assert capsys.readouterr().err == "CITATION.cff states version 9.8.6; the tag says 9.8.7.\n"
    assert main([]) == 2


def test_the_citation_of_this_checkout_states_the_manifests_version_and_licence():
    manifest = tomllib.loads((ROOT / "blender_manifest.toml").read_text(encoding="utf-8"))
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert citation_version(citation) == manifest["version"]
    assert f"license: {manifest['license'][0].removeprefix('SPDX:')}\n" in citation
