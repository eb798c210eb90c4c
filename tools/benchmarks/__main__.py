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
from dataclasses import replace
from pathlib import Path

from tools.benchmarks.experiment import Experiment
from tools.benchmarks.experiments import EXPERIMENTS
from tools.benchmarks.mesh_sets import Body, chosen
from tools.benchmarks.results import KEPT, PAGE, ROOT, differences, kept_rows, read_records, record_of, write_records

KINDS = ("forms", "more", "stress")


def main(words: Sequence[str], experiments: dict[str, Experiment] = EXPERIMENTS, kept: Path = KEPT) -> int:
    """Run the command and return its exit code."""
    options = _parser(experiments).parse_args(words)
    given = [name for name in options.only.split(",") if name]
    unknown = set(given) - {*experiments, *KINDS, "all"}
    if unknown:
        print(f"No such experiment: {', '.join(sorted(unknown))}. There are: {', '.join(experiments)}; and all, "
              f"{', '.join(KINDS)}.", file=sys.stderr)  # fmt: skip
        return 2
    wanted = given or (["all"] if options.check else ["forms"])
    some = [body for body in options.bodies.split(",") if body]
    records, measured, failed = read_records(options.output), {}, False
    for name, experiment in experiments.items():
        if not {name, experiment.kind, *(["all"] if experiment.kind != "stress" else [])} & set(wanted):
            continue
        if options.amount and experiment.kind == "stress":
            experiment = replace(experiment, settings={f"{options.amount}": options.amount})
        bodies = chosen(experiment.meshes(options.data), some)
        if not bodies:
            print(
                f"{name}: there are no meshes for it in {options.data or 'DATA, which is not given'}.", file=sys.stderr
            )
            failed = failed or name in given
            continue
        try:
            rows = _rows(experiment, bodies, kept)
        except Exception:  # the other experiments go on
            traceback.print_exc()
            print(f"{name} failed.", file=sys.stderr)
            failed = True
            continue
        data = " DATA=folder" if any(body.files for body in bodies) else ""
        command = f"make bench ONLY={name}{data}{f' BODIES={options.bodies}' if some else ''}"
        measured[name] = record_of(bodies, rows, command)
        print(f"\n## {name}\n\n{experiment.markdown(rows)}\n", flush=True)
        if not options.check:
            write_records(options.output, records | measured, experiments)
    if not options.check:
        return 2 if failed else 0
    page = options.output / PAGE
    text = page.read_text(encoding="utf-8") if page.is_file() else ""
    sentences = differences(records, measured, text, experiments)
    print(*sentences, sep="\n", file=sys.stderr)
    return 2 if failed else int(bool(sentences))


def _rows(experiment: Experiment, bodies: Sequence[Body], kept: Path) -> list[dict]:
    rows = []
    for body in bodies:
        for setting in experiment.settings:
            print(f"{experiment.name}: {body.name} {setting}", file=sys.stderr, flush=True)
            rows += kept_rows(experiment, body, setting, kept)
    return experiment.table(rows)


def _parser(experiments: dict[str, Experiment]) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m tools.benchmarks",
        description="Measure, keep the results, and write them to docs/results.md.",
        epilog=f"Experiments: {', '.join(f'{name} ({each.kind})' for name, each in experiments.items())}.",
    )
    parser.add_argument("data", type=Path, nargs="?", help="folder with a subfolder of .obj poses for each body")
    parser.add_argument(
        "--only", default="", metavar="NAMES", help="experiments or their kinds, or all (default: forms)"
    )
    parser.add_argument("--bodies", default="", metavar="NAMES", help="names of meshes (default: all)")
    parser.add_argument("--amount", type=int, metavar="N", help="of files, kills or walks of a stress run")
    parser.add_argument("--check", action="store_true", help="compare with the page instead of writing it")
    parser.add_argument("--output", type=Path, default=ROOT / "docs", help="folder of the page (default: docs)")
    return parser


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
