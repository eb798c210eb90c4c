"""Measures, keeps and shows: ``python -m tools.benchmarks DATA --only poses,limbs``; ``make bench`` calls it.

What was measured before, by the same code on the same meshes, is taken from build/benchmarks, so that a stopped run
goes on where it was. With ``--check`` nothing is written: every figure of docs/results.md that differs from the
measured one by more than its tolerance is told in a sentence.

Exit code 0: done, or nothing differs; 1: something differs; 2: an experiment failed or has no meshes.
"""

from __future__ import annotations

import argparse
import sys
import traceback
from collections.abc import Sequence
from pathlib import Path

from tools.benchmarks.experiment import Experiment, Row
from tools.benchmarks.experiments import EXPERIMENTS
from tools.benchmarks.mesh_sets import Body, chosen
from tools.benchmarks.results import KEPT, PAGE, ROOT, differences, kept_rows, read_records, record_of, write_records


def main(words: Sequence[str], experiments: dict[str, Experiment] = EXPERIMENTS, kept: Path = KEPT) -> int:
    """Run the command and return its exit code."""
    parser = argparse.ArgumentParser(
        prog="python -m tools.benchmarks", epilog=f"Experiments: {', '.join(experiments)}."
    )
    parser.add_argument("data", type=Path, nargs="?", help="folder with a subfolder of .obj poses for each body")
    parser.add_argument("--only", default="", metavar="NAMES", help="experiments, or all (default: the first ones)")
    parser.add_argument("--bodies", default="", metavar="NAMES", help="names of meshes (default: all)")
    parser.add_argument("--check", action="store_true", help="compare all with the page instead of writing it")
    parser.add_argument("--output", type=Path, default=ROOT / "docs", help="folder of the page (default: docs)")
    options = parser.parse_args(words)
    given, bodies_given = ([word for word in text.split(",") if word] for text in (options.only, options.bodies))
    if unknown := sorted(set(given) - {*experiments, "all"}):
        print(
            f"No such experiment: {', '.join(unknown)}. There are: {', '.join(experiments)}; and all.", file=sys.stderr
        )
        return 2
    everything = "all" in given or (options.check and not given)
    records, measured, failed = read_records(options.output), {}, False
    for name, experiment in experiments.items():
        if not (everything or name in given or (experiment.first and not given)):
            continue
        bodies = chosen(experiment.meshes(options.data), bodies_given)[: experiment.most]
        if not bodies:
            print(f"{name}: no meshes for it in {options.data or 'DATA, which is not given'}.", file=sys.stderr)
            failed |= name in given
            continue
        try:
            rows = _rows(experiment, bodies, kept)
        except Exception:  # the other experiments go on
            traceback.print_exc()
            print(f"{name} failed.", file=sys.stderr)
            failed = True
            continue
        command = f"make bench ONLY={name}{' DATA=folder' if any(body.files for body in bodies) else ''}"
        measured[name] = record_of(bodies, rows, f"{command} BODIES={options.bodies}" if bodies_given else command)
        print(f"\n## {name}\n\n{experiment.markdown(rows)}\n", flush=True)
        if not options.check:
            write_records(options.output, records | measured, experiments)
    sentences = []
    if options.check:
        page = options.output / PAGE
        sentences = differences(
            records, measured, page.read_text(encoding="utf-8") if page.is_file() else "", experiments
        )
        print(*sentences, sep="\n", file=sys.stderr)
    return 2 if failed else int(bool(sentences))


def _rows(experiment: Experiment, bodies: Sequence[Body], kept: Path) -> list[Row]:
    rows = []
    for body in bodies:
        for setting in experiment.settings:
            print(f"{experiment.name}: {body.name} {setting}", file=sys.stderr, flush=True)
            rows += kept_rows(experiment, body, setting, kept)
    return experiment.table(rows)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
