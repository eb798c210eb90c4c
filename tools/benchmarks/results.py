"""What was measured: kept by what it depends on, recorded in docs/results.json, and shown on docs/results.md."""

from __future__ import annotations

import hashlib
import importlib.metadata
import json
import math
import platform
import re
import subprocess
import sys
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from typing import Any

from tools.benchmarks.experiment import Experiment, Row
from tools.benchmarks.mesh_sets import Body, Collection

ROOT = Path(__file__).resolve().parents[2]
KEPT = ROOT / "build" / "benchmarks"
MEASURED = ("addon/core", "addon/evaluation", "tests/meshes")
"""The code that every experiment measures, besides its own."""

PACKAGES = ("numpy", "scipy", "potpourri3d", "bpy")
RAW, PAGE = "results.json", "results.md"
HEAD = f"""# Results

Everything that `make bench` has measured, made from [{RAW}]({RAW}) by it: do not edit. Each table names the commit, the
day, the meshes, and the command that remakes it. Pose ratio, distortions and thickness are defined in
[evaluation](evaluation.md#what-is-measured); lengths and distances are in units of sqrt(area). Seconds are those of one
machine with two cores; compare ratios of times, which are from one run.
"""

_IMPORTED = re.compile(r"^from (tools\.benchmarks[\w.]*) import \(?\s*(\w+)", flags=re.MULTILINE)


@cache
def code_of(module: str) -> frozenset[Path]:
    """Return the files on which the results of a module of experiments depend."""
    found = {path for each in MEASURED for path in (ROOT / each).rglob("*.py")}
    waiting = {ROOT / f"{module.replace('.', '/')}.py"}
    while waiting:
        found |= waiting
        pairs = [pair for path in waiting for pair in _IMPORTED.findall(path.read_text(encoding="utf-8"))]
        named = {ROOT / f"{name.replace('.', '/')}.py" for pair in pairs for name in (pair[0], ".".join(pair))}
        waiting = {path for path in named if path.is_file()} - found
    return frozenset(found)


def key_of(module: str, body: Body, setting: str) -> str:
    """Return a digest of all that a result depends on: code, Python, packages, the contents of meshes, the setting."""
    digest = hashlib.sha256(f"{sys.version} {body.name} {setting} {_versions(PACKAGES)}".encode())
    for path in [*sorted(code_of(module)), *body.files]:
        digest.update(path.name.encode() + path.read_bytes())
    return digest.hexdigest()[:12]


def kept_rows(experiment: Experiment, body: Body, setting: str, folder: Path = KEPT) -> list[Row]:
    """Return the rows of a body with a setting: those that an earlier run kept, or measured now, and kept."""
    words = re.sub(r"[^\w.]+", "-", f"{body.name}-{setting}").strip("-")[:80]
    path = folder / experiment.name / f"{words}-{key_of(experiment.measure.__module__, body, setting)}.json"
    if not path.is_file():
        measured = experiment.measure(body, experiment.settings[setting])
        mesh = "" if isinstance(body, Collection) else body.name
        rows = [{"mesh": mesh, "setting": setting} | _plain(row) for row in measured]
        path.parent.mkdir(parents=True, exist_ok=True)
        part = path.with_suffix(".part")
        part.write_text(json.dumps(rows), encoding="utf-8")
        part.replace(path)
    return json.loads(path.read_text(encoding="utf-8"))


def _plain(row: Row) -> Row:
    """Return a row of Python's own types, its numbers with six significant digits."""
    plain = {name: value.item() if hasattr(value, "item") else value for name, value in row.items()}
    rounded = {name: float(f"{value:.6g}") for name, value in plain.items() if isinstance(value, float)}
    return plain | {name: value if math.isfinite(value) else None for name, value in rounded.items()}


def record_of(bodies: Sequence[Body], rows: list[Row], command: str) -> dict[str, Any]:
    """Return what is recorded of an experiment: its rows, and when, on what and by which command they were measured."""
    return {
        "commit": commit(),
        "date": f"{datetime.now(UTC):%Y-%m-%d}",
        "versions": {"Python": platform.python_version()} | _versions(PACKAGES[:3]),
        "meshes": ", ".join(body.name for body in bodies),
        "command": command,
        "rows": rows,
    }


def commit() -> str:
    """Return the commit of this checkout, and whether the code that is measured was changed since."""
    git = ["git", "-C", str(ROOT)]
    head = subprocess.run([*git, "rev-parse", "--short", "HEAD"], capture_output=True, text=True, check=True).stdout
    changed = subprocess.run([*git, "diff", "--quiet", "HEAD", "--", *MEASURED, "tools/benchmarks"], check=False)
    return head.strip() + (" with changes" if changed.returncode else "")


def _versions(names: Sequence[str]) -> dict[str, str]:
    return {name: importlib.metadata.version(name) for name in names}


def read_records(folder: Path) -> dict[str, Any]:
    """Return the records of a folder of documents, by experiment; none before the first run."""
    path = folder / RAW
    return json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}


def write_records(folder: Path, records: Mapping[str, Any], experiments: Mapping[str, Experiment]) -> None:
    """Write the records of experiments that still exist, and the page."""
    folder.mkdir(parents=True, exist_ok=True)
    known = {name: records[name] for name in experiments if name in records}
    text = json.dumps(known, ensure_ascii=False, indent=1)
    text = re.sub(
        r"\{\n\s+(\"mesh\".*?)\n\s+\}", lambda row: "{" + re.sub(r"\n\s+", " ", row[1]) + "}", text, flags=re.S
    )
    (folder / RAW).write_text(text + "\n", encoding="utf-8")
    (folder / PAGE).write_text(page(known, experiments), encoding="utf-8")


def page(records: Mapping[str, Any], experiments: Mapping[str, Experiment]) -> str:
    """Return the page of the records: a list of the experiments, and a table of each that has been run."""
    lines = ["| experiment | commit | day | measured on |", "| --- | --- | --- | --- |"]
    parts = []
    for name, each in records.items():
        experiment = experiments[name]
        lines.append(f"| [{name}](#{name}) | {each['commit']} | {each['date']} | {each['meshes']} |")
        versions = ", ".join(f"{package} {version}" for package, version in each["versions"].items())
        parts.append(
            f"## {name}\n\n{experiment.about}\n\n{experiment.markdown(each['rows'])}\n\n"
            f"*{each['date']}, commit {each['commit']}, {versions}:* `{each['command']}`\n"
        )
    missing = [f"`{name}`" for name in experiments if name not in records]
    left = f"\n\nNot measured yet, or not by this driver: {', '.join(missing)}." if missing else ""
    return HEAD + "\n" + "\n".join(lines) + left + "\n\n" + "\n".join(parts)


def differences(
    records: Mapping[str, Any], measured: Mapping[str, Any], text: str, experiments: Mapping[str, Experiment]
) -> list[str]:
    """Return a sentence for each figure of the page `text` that is not the recorded one, or not the measured one."""
    sentences = []
    told, made = text.splitlines(), page(records, experiments).splitlines()
    sentences += [f"{PAGE} has by hand: {line}" for line in told if line not in set(made)]
    sentences += [f"{PAGE} lacks: {line}" for line in made if line not in set(told)]
    for name, each in measured.items():
        if name not in records:
            sentences.append(f"{name} is not on the page: make bench ONLY={name} DATA=folder puts it there.")
        elif records[name]["meshes"] != each["meshes"]:
            on, now = (found["meshes"] for found in (records[name], each))
            sentences.append(f"{name} was measured on {on}, now on {now}: make bench ONLY={name} DATA=folder.")
        else:
            sentences += experiments[name].differences(records[name]["rows"], each["rows"])
    return sentences
