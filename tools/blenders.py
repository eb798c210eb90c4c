"""Runs all tests in every Blender that is a Python module, and the window session: `make blenders`.

Each Blender gets an environment in build/blenders, with the numpy version of the Blender program; the tests run in one
after the other. The results go to the table of docs/reviewers.md. Arguments select Blenders: ``4.2 5.2 window``; the
last is the session in a window, with the Blender that `make test-window` uses.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import time
import xml.etree.ElementTree as ET
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from tools.environment import run  # noqa: E402

FOLDER = ROOT / "build" / "blenders"
PAGE = ROOT / "docs" / "reviewers.md"
BLENDERS = {  # version: its Python, and the numpy version of the program
    "4.2": ("3.11", "1.24.3"),
    "4.5": ("3.11", "1.26.4"),
    "5.0": ("3.11", "1.26.4"),
    "5.1": ("3.13", "2.3.*"),
    "5.2": ("3.13", "2.3.*"),
}
TELL = "import bpy, numpy, sys; print(bpy.app.version_string, *sys.version_info[:2], numpy.__version__, sep='|')"


def interpreter(version: str) -> str | None:
    """Return a Python interpreter of a version, from the path or from pyenv."""
    kept = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv")) / "versions"
    found = [*sorted(kept.glob(f"{version}.*/bin/python")), shutil.which(f"python{version}")]
    return next((str(each) for each in found if each), None)


def python_of(blender: str) -> Path | None:
    """Create the environment of a Blender, or find it; None if its Python is not installed."""
    python, numpy = BLENDERS[blender]
    folder = FOLDER / blender
    inside = folder / "bin" / "python"
    if (folder / "made").exists():
        return inside
    base = interpreter(python)
    if base is None:
        return None
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    wanted = [line for line in (ROOT / "tools" / "requirements.txt").read_text().splitlines() if line[:1].isalpha()]
    wanted = [f"bpy=={blender}.*", *(line for line in wanted if not line.startswith("bpy"))]
    (folder / "requirements.txt").write_text("\n".join(wanted))
    (folder / "constraints.txt").write_text(f"numpy=={numpy}\n")
    run([base, "-m", "venv", folder])
    run([inside, "-m", "pip", "install", "--quiet", "--disable-pip-version-check",
         "-r", folder / "requirements.txt", "-c", folder / "constraints.txt"])  # fmt: skip
    (folder / "made").touch()
    return inside


def suite(blender: str) -> list[str]:
    """Run the tests in a Blender and return the cells of its row."""
    python = python_of(blender)
    if python is None:
        return [blender, BLENDERS[blender][0], "", "not run: this Python is not here", "", ""]
    version, major, minor, numpy = subprocess.run(
        [python, "-c", TELL], capture_output=True, text=True, check=True
    ).stdout.splitlines()[-1].split("|")  # fmt: skip
    report = FOLDER / f"{blender}.xml"
    report.unlink(missing_ok=True)  # from an earlier run
    began = time.perf_counter()
    done = subprocess.run(
        [python, "-m", "pytest", "-q", "-n", "logical", "--maxprocesses", "4", "--dist", "loadfile",
         f"--junitxml={report}"],
        cwd=ROOT, check=False,
    )  # fmt: skip
    row = [f"{version} (module)", f"{major}.{minor}", numpy, "", f"{(time.perf_counter() - began) / 60:.0f} min", ""]
    if not report.exists():
        return [*row[:3], f"**failed: no report, exit code {done.returncode}**", *row[4:]]
    counts = dict.fromkeys(("tests", "failures", "errors", "skipped"), 0)
    for each in ET.parse(report).getroot().iter("testsuite"):
        counts = {name: counts[name] + int(each.get(name, 0)) for name in counts}
    failed = counts["failures"] + counts["errors"]
    passed = counts["tests"] - failed - counts["skipped"]
    told = f"{passed:,} passed, {counts['skipped']} skipped" + (
        f", **{failed} failed**" if failed else f", **failed: exit code {done.returncode}**" if done.returncode else ""
    )
    return [*row[:3], told, *row[4:]]


def window() -> list[str]:
    """Run the window session and return the cells of its row."""
    began = time.perf_counter()
    command = [sys.executable, str(ROOT / "tests" / "window" / "run.py")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    found = re.search(r"WINDOW SESSION PASSED in Blender (\S+)", done.stdout)
    if found is None:
        print(done.stdout[-3000:], done.stderr[-3000:], sep="\n")
    minutes = (time.perf_counter() - began) / 60
    name = f"{found.group(1)} (program, window)" if found else "a program with a window"
    return [name, "", "", "window session passed" if found else "**window session failed**", f"{minutes:.0f} min", ""]


def write(rows: list[list[str]]) -> None:
    """Write the rows to the table of the page, replacing those of the same Blenders."""
    before, rest = PAGE.read_text(encoding="utf-8").split("<!-- blenders -->\n", 1)
    old, after = rest.split("<!-- end of blenders -->", 1)
    head = ["Blender", "Python", "numpy", "suite", "time", "commit"]
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], cwd=ROOT, capture_output=True, text=True).stdout
    kept = {_series(line.split("|")[1]): line for line in old.splitlines() if re.match(r"\| [\da]", line)}
    for row in rows:
        kept[_series(row[0])] = "| " + " | ".join([*row[:-1], commit.strip()]) + " |"
    table = ["| " + " | ".join(head) + " |", "| --- " * len(head) + "|", *(kept[name] for name in sorted(kept))]
    PAGE.write_text(
        before + "<!-- blenders -->\n\n" + "\n".join(table) + "\n\n<!-- end of blenders -->" + after, encoding="utf-8"
    )


def _series(name: str) -> str:
    """Shorten the name of a Blender to its series, and whether it is the module or a program."""
    found = re.search(r"\d+\.\d+", name)
    return f"{found.group() if found else ''} {'module' if 'module' in name or 'window' not in name else 'window'}"


def main(words: list[str]) -> int:
    rows = []
    for name in words or [*BLENDERS, "window"]:
        rows.append(window() if name == "window" else suite(name))
        print(" | ".join(rows[-1]), flush=True)
        write(rows)
    return 1 if any("failed" in row[3] or "not run" in row[3] for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
