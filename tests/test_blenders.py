"""The table of Blenders in which the suite ran: one row a series, and no row without a run."""

import subprocess

import pytest

from tools import blenders

TABLE = "| Blender |\n| --- |\n| 4.2.1 LTS (module) | old |"
PAGE = f"Before.\n<!-- blenders -->\n\n{TABLE}\n\n<!-- end of blenders -->\nAfter.\n"


@pytest.fixture
def page(tmp_path, monkeypatch):
    path = tmp_path / "page.md"
    path.write_text(PAGE, encoding="utf-8")
    monkeypatch.setattr(blenders, "PAGE", path)
    return path


def test_a_series_has_one_row(page):
    blenders.write([["4.2.23 LTS (module)", "3.11", "1.24.3", "2 passed", "1 min", ""],
                    ["4.2.3 LTS (program, window)", "", "", "window session passed", "1 min", ""]])  # fmt: skip
    blenders.write([["5.1.2 (module)", "3.13", "2.3.5", "2 passed", "1 min", ""]])
    text = page.read_text(encoding="utf-8")
    rows = [line.split("|")[1].strip() for line in text.splitlines() if line.startswith(("| 4", "| 5"))]
    assert rows == ["4.2.23 LTS (module)", "4.2.3 LTS (program, window)", "5.1.2 (module)"]
    assert text.startswith("Before.")
    assert text.endswith("After.\n")


@pytest.mark.parametrize(("report", "code", "told"), [
    (None, 139, "**failed: no report, exit code 139**"),
    ('<testsuites><testsuite tests="3" failures="0" errors="0" skipped="1"/></testsuites>', 0, "2 passed, 1 skipped"),
    ('<testsuites><testsuite tests="3" failures="0" errors="0" skipped="1"/></testsuites>', 4,
     "2 passed, 1 skipped, **failed: exit code 4**"),
    ('<testsuites><testsuite tests="3" failures="1" errors="1" skipped="0"/></testsuites>', 1,
     "1 passed, 0 skipped, **2 failed**"),
])  # fmt: skip
def test_an_earlier_report_is_not_taken_for_that_of_this_run(tmp_path, monkeypatch, report, code, told):
    monkeypatch.setattr(blenders, "FOLDER", tmp_path)
    monkeypatch.setattr(blenders, "python_of", lambda _: tmp_path / "python")
    (tmp_path / "5.0.xml").write_text("<stale/>", encoding="utf-8")

    def ran(command, **_):
        if "pytest" in command and report is not None:
            (tmp_path / "5.0.xml").write_text(report, encoding="utf-8")
        return subprocess.CompletedProcess(command, code if "pytest" in command else 0, "5.0.1|3|11|1.26.4\n", "")

    monkeypatch.setattr(subprocess, "run", ran)
    assert blenders.suite("5.0")[:4] == ["5.0.1 (module)", "3.11", "1.26.4", told]
