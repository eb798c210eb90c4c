"""Measures the figures of the documents again and reports those that differ: ``release_figures.py DATA``.

Each benchmark writes its tables as Markdown. Every table, and every sentence with figures, must be on its page of the
documents, with the same words and with figures within their tolerance of the measured ones. The tolerances are
defined in tools/release_tolerances.toml; any other figure must agree to one unit of its last digit. Results are
stored in build/release by benchmark and the state of its code, packages and meshes, so that a stopped run can be
resumed, and a corrected page needs no new measurement.

With ``--write`` the measured tables and sentences replace those on the pages; other text is kept.

Exit code 0: all figures agree; 1: some do not, with one message each; 2: a benchmark failed.
"""

from __future__ import annotations

import argparse
import hashlib
import importlib.metadata
import math
import re
import subprocess
import sys
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TOLERANCES = ROOT / "tools" / "release_tolerances.toml"
MEASURED_BY = (
    "addon/core",
    "addon/evaluation",
    "addon/blender/files/obj_format.py",
    "addon/blender/files/off_format.py",
    "addon/blender/files/plain_files.py",
    "addon/blender/files/ply_format.py",
    "addon/blender/files/polygon_mesh.py",
    "addon/blender/files/reading_files.py",
    "addon/blender/objects/mesh_reading.py",
    "tests/meshes",
)
"""The code on which every figure depends, besides its benchmark: folders and files. The panel is not among it."""

SCRIPTS = "tools/benchmarks"

PACKAGES = ("numpy", "scipy", "bpy", "scikit-learn", "potpourri3d")
"""The packages on which a figure depends."""

_IMPORTED = re.compile(r"from tools\.benchmarks\.(\w+) import")
_NUMBER = re.compile(r"(?<![\w.,])(?:(?<![^\s(|*])[-+])?(?:\d[\d,]*\.?\d+|\d|\.\d+)(?:e[-+]?\d+)?(?!\w)")


@dataclass(frozen=True)
class Benchmark:
    """A command that writes the tables of one page, or of some of its sections.

    Attributes
    ----------
    page : str
        Path of the page in the checkout.
    commands : tuple of tuple of str
        Arguments for Python. {data} is replaced by the folder of meshes, {out} by the file to write, {work} by a folder
        that is kept; * by the paths that match the pattern. The output of a command without {out} is its tables.
    """

    page: str
    commands: tuple[tuple[str, ...], ...]


METHODS = (
    "ours,local-features,as-published,as-published-closed,classical,least-squares,non-metric,fast,euclidean-random,"
    "euclidean-normalised,one-form,skeleton"
)
WITH_ALL_PAIRS = (
    "ours,local-features,ours-full,as-published,as-published-closed,classical-full,classical,least-squares-full,"
    "least-squares,non-metric-full,non-metric,fast,euclidean-random,euclidean-normalised,one-form-full,one-form,skeleton"
)
CLASSES = ("tools/benchmarks/derived_datasets.py", "classes", "{data}", "{work}/classes", "7")
BENCHMARKS: Mapping[str, Benchmark] = {
    "forms": Benchmark("docs/benchmarks.md", (("tools/benchmarks/form_tables.py", "{data}", "--output", "{out}"),)),
    "poses": Benchmark("docs/measurements.md", (("tools/benchmarks/poses.py", "{data}"),)),
    "limbs": Benchmark("docs/measurements.md", (("tools/benchmarks/limbs.py", "{data}"),)),
    "memory": Benchmark("docs/measurements.md", (("tools/benchmarks/memory.py", "{data}"),)),
    "characters": Benchmark("docs/measurements.md", (("tools/benchmarks/characters.py", "{data}/creatures/*.glb"),)),
    "weights": Benchmark(
        "docs/measurements.md", (("tools/benchmarks/carried_weights.py", "{data}/creatures/human-*.glb"),)
    ),
    "sets": Benchmark(
        "docs/measurements.md",
        (
            (
                "tools/benchmarks/sets_of_poses.py",
                "{data}/man",
                "{data}/woman",
                "{data}/horse",
                "{data}/bear",
                "{data}/creatures/*.glb",
            ),
        ),
    ),
    "matches": Benchmark(
        "docs/measurements.md",
        (CLASSES, ("tools/benchmarks/two_meshes.py", "{work}/classes/*", "{work}/classes/man:{work}/classes/woman")),
    ),
    "evaluation": Benchmark(
        "docs/evaluation.md",
        (
            CLASSES,
            ("tools/benchmarks/derived_datasets.py", "coarse", "{work}/classes", "{work}/coarse", "2000"),
            ("-m", "addon", "evaluate", "{work}/classes", "--output", "{work}/native", "--methods", METHODS),
            ("-m", "addon", "evaluate", "{work}/coarse", "--output", "{work}/few", "--methods", WITH_ALL_PAIRS),
            ("tools/benchmarks/evaluation_page.py", "{work}/native", "{work}/few", "--page", "{out}"),
        ),
    ),
}


def figures_in(text: str) -> tuple[str, list[str]]:
    """Separate the figures from a text.

    Parameters
    ----------
    text : str
        A cell of a table, or a paragraph.

    Returns
    -------
    words : str
        The text with # in place of each figure.
    figures : list of str
        The figures as written.

    Examples
    --------
    >>> figures_in("1,200 of 3 (-0.5 %)")
    ('# of # (# %)', ['1,200', '3', '-0.5'])
    """
    return _NUMBER.sub("#", text), _NUMBER.findall(text)


def agrees(told: str, measured: str, tolerance: float) -> bool:
    """Return whether two figures differ by at most one unit of the last digit of `told`, or a share of `measured`.

    Examples
    --------
    >>> agrees("0.143", "0.144", 0.0), agrees("0.143", "0.145", 0.0), agrees("0.95", "1.2", 0.3)
    (True, False, True)
    """
    digits = told.lower().split("e")[0].partition(".")[2]
    exponent = int(told.lower().partition("e")[2] or 0)
    unit = 10.0 ** (exponent - len(digits))
    one, two = (float(each.replace(",", "")) for each in (told, measured))
    return math.isinf(tolerance) or abs(one - two) <= max(1.001 * unit, tolerance * abs(two))


@dataclass(frozen=True)
class Block:
    """A table or a paragraph of a page, under its heading."""

    heading: str
    lines: tuple[str, ...]
    start: int
    """Number of its first line on the page."""

    @property
    def is_table(self) -> bool:
        """Whether it is a table, so that its first line is the header."""
        return self.lines[0].startswith("|")

    @property
    def words(self) -> str:
        """Its key for comparison: the header of a table, or the words between a paragraph's figures."""
        return " ".join(self.lines[0].split()) if self.is_table else figures_in(" ".join(self.lines))[0]

    @property
    def rows(self) -> list[list[str]]:
        """The cells of a table, without the header."""
        return [_cells(line) for line in self.lines[2:]]


def _cells(line: str) -> list[str]:
    """Split a line of a table at unescaped bars."""
    return [cell.strip() for cell in re.split(r"(?<!\\)\|", line.strip())[1:-1]]


def blocks_of(text: str) -> list[Block]:
    """Split a page of Markdown into its tables and paragraphs, without comments and headings."""
    blocks, heading, lines = [], "", []
    for number, line in enumerate([*text.splitlines(), ""]):
        if line.strip() and not line.startswith(("#", "<!--")):
            lines.append(line.strip())
            continue
        if lines:
            blocks.append(Block(heading, tuple(lines), number - len(lines)))
        lines = []
        heading = line.lstrip("# ") if line.startswith("#") else heading
    return blocks


def disagreements(page: str, told: str, measured: str, tolerances: Mapping[str, Mapping[str, float]]) -> list[str]:
    """Compare a page with the measured results.

    Parameters
    ----------
    page : str
        Name of the page, for the messages.
    told, measured : str
        Markdown: the whole page, and the tables and sentences that it must contain.
    tolerances : mapping of str to mapping of str to float
        By the heading on the page and the column ("text" for paragraphs, "*" for all others), as shares.

    Returns
    -------
    list of str
        One message for each figure that differs, and for each table or sentence that is missing.
    """
    sentences = []
    for block, told_block in _pairs(told, measured):
        if told_block is None:
            sentences.append(f"{page} does not have, with whatever figures: {block.words[:200]}")
            continue
        allowed = tolerances.get(told_block.heading, {})
        where = f"{page}, {told_block.heading}"
        if not block.is_table:
            sentences += _differing(" ".join(told_block.lines), " ".join(block.lines), allowed.get("text", 0.0), where)
            continue
        if len(told_block.rows) != len(block.rows):
            sentences.append(f"{where}: a table has {len(told_block.rows)} rows, {len(block.rows)} were measured.")
            continue
        columns = [cell.strip() for cell in block.lines[0].strip("|").split("|")]
        for old, new in zip(told_block.rows, block.rows, strict=True):
            for column, one, two in zip(columns, old, new, strict=True):
                tolerance = allowed.get(column, allowed.get("*", 0.0))
                sentences += _differing(one, two, tolerance, f"{where}, {old[0]}, {column}")
    return sentences


def rewritten(told: str, measured: str) -> str:
    """Replace tables and sentences of the page by the measured ones."""
    lines = told.splitlines()
    pairs = [(block, old) for block, old in _pairs(told, measured) if old is not None]
    for block, old in sorted(pairs, key=lambda pair: pair[1].start, reverse=True):
        end = old.start + len(old.lines)
        if block.lines != old.lines:
            indents = [line[: len(line) - len(line.lstrip())] for line in lines[old.start : end]]
            lines[old.start : end] = [
                indents[min(number, len(indents) - 1)] + line for number, line in enumerate(block.lines)
            ]
    return "\n".join(lines) + "\n"


def _pairs(told: str, measured: str) -> list[tuple[Block, Block | None]]:
    """Pair each measured table, and each sentence with figures, with the block of the page that has the same words."""
    there, pairs = blocks_of(told), []
    for block in blocks_of(measured):
        if block.is_table or figures_in(" ".join(block.lines))[1]:
            found = [each for each in there if each.words == block.words and block.heading in ("", each.heading)]
            pairs.append((block, found[0] if found else None))
            there = [each for each in there if not found or each is not found[0]]  # tables of one header are in order
    return pairs


def _differing(told: str, measured: str, tolerance: float, where: str) -> list[str]:
    """Compare two texts figure by figure."""
    (words, figures), (other_words, others) = figures_in(told), figures_in(measured)
    if words != other_words:
        return [f"{where}: says {told!r}; measured {measured!r}."]
    return [
        f"{where}: says {one}; measured {two} (tolerance {tolerance:.0%})."
        for one, two in zip(figures, others, strict=True)
        if not agrees(one, two, tolerance)
    ]


def code_of(benchmark: Benchmark) -> list[Path]:
    """Return the code that the figures of a benchmark depend on, with the scripts that its scripts import."""
    found = {path for each in MEASURED_BY for path in [ROOT / each, *(ROOT / each).rglob("*.py")] if path.is_file()}
    scripts = {ROOT / word for command in benchmark.commands for word in command if word.startswith(SCRIPTS)}
    while scripts:
        found |= scripts
        names = {name for path in scripts for name in _IMPORTED.findall(path.read_text(encoding="utf-8"))}
        scripts = {ROOT / SCRIPTS / f"{name}.py" for name in names} - found
    return sorted(found)


def state_of(benchmark: Benchmark, data: Path) -> str:
    """Return a digest of all that figures depend on: code, Python, packages, and names and contents of meshes."""
    digest = hashlib.sha256(sys.version.encode())
    for name in PACKAGES:
        digest.update(f"{name} {importlib.metadata.version(name)}\0".encode())
    for path in sorted(each for each in data.rglob("*") if each.is_file()):
        digest.update(f"{path.relative_to(data)}\0".encode() + hashlib.sha256(path.read_bytes()).digest())
    for path in code_of(benchmark):
        digest.update(f"{path.relative_to(ROOT)}\0".encode() + path.read_bytes())
    return digest.hexdigest()[:12]


def measured_by(benchmark: Benchmark, data: Path, work: Path, out: Path) -> str:
    """Run the commands of a benchmark, unless stored results of the same code exist; return the Markdown.

    Raises
    ------
    subprocess.CalledProcessError
        If a command fails.
    """
    if out.is_file():
        return out.read_text(encoding="utf-8")
    printed = ""
    part = out.with_suffix(".part")
    for command in benchmark.commands:
        words = [word.format(data=data, work=work, out=part) for word in command]
        given = [
            path for word in words for path in (sorted(map(str, Path("/").glob(word[1:]))) if "*" in word else [word])
        ]
        print("$", *command, file=sys.stderr, flush=True)
        done = subprocess.run([sys.executable, *given], cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True)
        printed = "\n".join(line for line in done.stdout.splitlines() if not line or line.startswith("|"))  # no logs
    if not part.is_file():
        part.write_text(printed, encoding="utf-8")
    part.replace(out)
    return out.read_text(encoding="utf-8")


def main(arguments: Sequence[str]) -> int:
    """Measure, compare, print the messages; return the exit code."""
    parser = argparse.ArgumentParser(description="Measure the figures of the documents again.")
    parser.add_argument("data", type=Path, help="folder with a subfolder of .obj poses a shape, and rigs in creatures")
    parser.add_argument("--only", nargs="*", choices=BENCHMARKS, help="benchmarks to run (default: all)")
    parser.add_argument("--write", action="store_true", help="put what was measured onto the pages")
    options = parser.parse_args(arguments)
    data = options.data.resolve()
    tolerances = tomllib.loads(TOLERANCES.read_text(encoding="utf-8"))
    sentences = []
    for name in options.only or BENCHMARKS:
        benchmark = BENCHMARKS[name]
        work = ROOT / "build" / "release" / f"{name}-{state_of(benchmark, data)}"
        work.mkdir(parents=True, exist_ok=True)
        try:
            measured = measured_by(benchmark, data, work, work / f"{name}.md")
        except subprocess.CalledProcessError as error:
            print(f"The benchmark {name} failed: {error}", file=sys.stderr)
            return 2
        told = (ROOT / benchmark.page).read_text(encoding="utf-8")
        differing = disagreements(benchmark.page, told, measured, tolerances.get(benchmark.page, {}))
        print(f"{name}: {len(differing)} of its figures differ from those on {benchmark.page}.", flush=True)
        sentences += differing
        if options.write:
            (ROOT / benchmark.page).write_text(rewritten(told, measured), encoding="utf-8")
    for sentence in sentences:
        print(sentence, file=sys.stderr)
    return 1 if sentences else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
