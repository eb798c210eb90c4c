"""A figure of the documents that differs from the measured one by more than its tolerance stops a release."""

import os
import tomllib
from pathlib import Path

import pytest

from tools import release_figures
from tools.release_figures import BENCHMARKS, TOLERANCES, Benchmark, agrees, blocks_of, disagreements, figures_in, main

ROOT = Path(__file__).resolve().parents[1]
PAGES = sorted({benchmark.page for benchmark in BENCHMARKS.values()})
TOLD = """# Page

## Quality

| shape | pose ratio | seconds |
| --- | --- | --- |
| bear | 0.479 | 1.0 s |
| man | **0.170** | 2.0 s |

Pose ratio overall: 0.236, on
two lines.
"""


def of(page):
    return (ROOT / page).read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("text", "words", "figures"),
    [
        ("5-5", "#-#", ["5", "5"]),
        ("+0.04%", "#%", ["+0.04"]),
        ("1e-16", "#", ["1e-16"]),
        (".21 (-.23)", "# (#)", [".21", "-.23"]),
        ("10.6 s, 259 steps.", "# s, # steps.", ["10.6", "259"]),
        ("160,000, and 5", "#, and #", ["160,000", "5"]),
        ("bear_idle_04", "bear_idle_04", []),
    ],
)
def test_figures_are_taken_out_of_words(text, words, figures):
    assert figures_in(text) == (words, figures)


@pytest.mark.parametrize(
    ("told", "measured", "tolerance", "wanted"),
    [
        ("0.143", "0.142", 0, True),
        ("0.143", "0.141", 0, False),
        ("1,200", "1,201", 0, True),
        ("1,200", "1,202", 0, False),
        ("2e-16", "9e-17", 0.0, False),
        ("2e-16", "9e-17", 2.0, True),
        ("2.0", "1.0", 0.9, False),
        ("2.0", "1.0", 1.0, True),
        ("-1", "1", 0, False),
        ("0.1", "0", float("inf"), True),
    ],
)
def test_a_figure_agrees_to_its_last_digit_or_its_tolerance(told, measured, tolerance, wanted):
    assert agrees(told, measured, tolerance) is wanted


def test_the_same_page_agrees_with_itself():
    assert disagreements("page", TOLD, TOLD, {}) == []


@pytest.mark.parametrize("page", PAGES)
def test_the_pages_agree_with_themselves(page):
    assert disagreements(page, of(page), of(page), {}) == []


@pytest.mark.parametrize("page", PAGES)
def test_any_figure_of_a_table_that_is_changed_by_hand_is_told(page):
    tables = [block for block in blocks_of(of(page)) if block.is_table]
    tried = 0
    for block in tables:
        figure = figures_in(block.lines[-1])[1]
        if figure:
            changed = block.lines[-1].replace(figure[-1], f"{float(figure[-1].replace(',', '')) * 3 + 7:.3f}", 1)
            told = disagreements(page, of(page).replace(block.lines[-1], changed), of(page), {})
            assert page in "".join(told), block
            tried += 1
    assert tried > 1


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("0.479", "0.481", "page, Quality, bear, pose ratio: says 0.481; measured 0.479 (tolerance 0%)."),
        ("0.236", "0.24", None),
        ("0.236", "0.246", "page, Quality: says 0.246; measured 0.236 (tolerance 0%)."),
        ("1.0 s", "1.4 s", None),
        ("1.0 s", "1.6 s", "page, Quality, bear, seconds: says 1.6; measured 1.0 (tolerance 50%)."),
        ("1.0 s", "1.0", "page, Quality, bear, seconds: says '1.0'; measured '1.0 s'."),
        ("| bear | 0.479 | 1.0 s |\n", "", "page, Quality: a table has 1 rows, 2 were measured."),
        ("pose ratio |", "ratio |", "page does not have, with whatever figures: | shape | pose ratio | seconds |"),
        ("overall", "in all", "page does not have, with whatever figures: Pose ratio overall: #, on two lines."),
    ],
)
def test_what_differs_is_told_in_a_sentence(old, new, told):
    found = disagreements("page", TOLD.replace(old, new), TOLD, {"Quality": {"seconds": 0.5}})
    assert found == ([told] if told else [])


def test_what_was_measured_takes_the_places_of_what_is_told():
    old = TOLD.replace("0.479", "0.3").replace("| man | **0.170** | 2.0 s |\n", "").replace("0.236", "0.9")
    assert release_figures.rewritten("Before.\n\n" + old, TOLD) == "Before.\n\n" + TOLD
    assert release_figures.rewritten(TOLD, "| other |\n| --- |\n| 1 |") == TOLD


def test_items_of_lists_stay_indented():
    item = "- It takes 3 s\n  for 2,000 vertices.\n"
    assert release_figures.rewritten(item, item) == item
    assert release_figures.rewritten(item, item.replace("3", "4")) == item.replace("3", "4")


def test_every_tolerance_names_a_column_of_its_page():
    for page, sections in tomllib.loads(TOLERANCES.read_text(encoding="utf-8")).items():
        for heading, columns in sections.items():
            blocks = [block for block in blocks_of(of(page)) if block.heading == heading]
            heads = {cell.strip() for block in blocks if block.is_table for cell in block.lines[0].split("|")}
            assert set(columns) <= heads | {"text", "*"}, (page, heading)


def test_the_code_that_figures_depend_on_is_there():
    assert all((release_figures.ROOT / each).exists() for each in release_figures.MEASURED_BY)


def test_a_figure_depends_on_its_scripts_and_on_those_that_they_import():
    found = {
        name: {path.name for path in release_figures.code_of(benchmark) if path.parent == ROOT / "tools" / "benchmarks"}
        for name, benchmark in BENCHMARKS.items()
    }
    assert found["forms"] == {"form_tables.py", "scale_tables.py", "remeshing.py"}
    assert found["evaluation"] == {"derived_datasets.py", "evaluation_page.py", "characters.py"}
    assert found["weights"] == {"carried_weights.py", "characters.py", "two_meshes.py"}
    for benchmark in BENCHMARKS.values():
        assert {"canonical.py", "off_format.py", "shapes.py"} <= {
            path.name for path in release_figures.code_of(benchmark)
        }


def test_a_release_is_checked_in_words_and_exit_codes(tmp_path, monkeypatch, capsys):
    data = tmp_path / "meshes"
    for folder in (tmp_path / "tools", data):
        folder.mkdir()
    (tmp_path / "page.md").write_text(TOLD, encoding="utf-8")
    script = tmp_path / "measure.py"
    script.write_text(f"import sys; print({TOLD!r})", encoding="utf-8")
    monkeypatch.setattr(release_figures, "ROOT", tmp_path)
    monkeypatch.setattr(release_figures, "BENCHMARKS", {"one": Benchmark("page.md", ((str(script), "{data}"),))})
    assert main([str(data)]) == 0
    script.write_text("raise SystemExit(1)", encoding="utf-8")
    assert main([str(data)]) == 0  # measured by the same code before
    (tmp_path / "page.md").write_text(TOLD.replace("0.479", "0.379"), encoding="utf-8")
    assert main([str(data)]) == 1
    assert "says 0.379; measured 0.479" in capsys.readouterr().err
    for folder in ("interface", "core"):
        (tmp_path / "addon" / folder).mkdir(parents=True)
    (tmp_path / "addon" / "interface" / "panel.py").write_text("", encoding="utf-8")
    assert main([str(data)]) == 1  # no figure depends on it
    (tmp_path / "addon" / "core" / "changed.py").write_text("", encoding="utf-8")
    assert main([str(data)]) == 2
    assert "one failed" in capsys.readouterr().err
    (tmp_path / "addon" / "core" / "changed.py").unlink()
    assert main([str(data)]) == 1
    mesh = data / "one.obj"
    mesh.write_text("v 0 0 0", encoding="utf-8")
    assert main([str(data)]) == 2  # other meshes have other figures
    script.write_text(f"print({TOLD!r})", encoding="utf-8")
    assert main([str(data)]) == 1
    script.write_text("raise SystemExit(1)", encoding="utf-8")
    os.utime(mesh, (0, 0))
    assert main([str(data)]) == 1  # the same meshes, copied anew
    mesh.write_text("v 0 0 1", encoding="utf-8")
    assert main([str(data)]) == 2
