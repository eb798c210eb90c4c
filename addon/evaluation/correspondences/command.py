"""The command line: ``python -m addon evaluate-matches DATASET --output DIR``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from contextlib import closing
from typing import TextIO

from ...core import CanonicalFormError
from ...scheduling.attempts import Failure, give_memory_back
from ...scheduling.crews import crew
from ...scheduling.workers import Work
from ..arguments import (
    add_dataset,
    add_workers,
    bar_style,
    exit_code,
    own_folder,
    require_packages,
    require_workers,
)
from ..dataset import shapes_in
from ..reading import Reader
from ..store import Store, code_version, digest, file_digest
from .matchers import MATCHERS, Matcher, chosen_matchers, installed
from .pairs import Pair, Poses, pairs_of
from .report import Result, write_report
from .work import matched


def main(arguments: list[str], output: TextIO | None = None) -> int:
    """Evaluate methods of matching on the poses of a dataset.

    Parameters
    ----------
    arguments : list of str
        The arguments after ``evaluate-matches``.
    output : TextIO, optional
        Stream for the names of the written files; standard output if omitted.

    Returns
    -------
    int
        0 if every pair was matched, 1 if one failed, 2 if nothing could be computed, 130 after a keyboard interrupt.
    """
    return exit_code(_parser(), arguments, lambda options: _evaluate(options, output or sys.stdout))


def _evaluate(options: argparse.Namespace, output: TextIO) -> bool:
    """Run the evaluation, and return whether every pair was matched."""
    matchers = chosen_matchers([word for word in options.methods.split(",") if word])
    needed = ["matplotlib", "tqdm", "threadpoolctl", *(name for each in matchers for name in each.packages)]
    require_packages([*needed, *(["distributed"] if options.scheduler else [])])
    require_workers(options.workers)
    if options.poses < 1:
        raise CanonicalFormError("--poses must be at least 1.")
    shapes = shapes_in(options.dataset, options.classes)
    own_folder(options.output, [*(shape.path for shape in shapes), *filter(None, [options.classes])])
    with closing(Reader()) as reader:
        poses = Poses(reader)
        pairs, left_out = pairs_of(shapes, options.poses, options.across, poses)
    store = Store(options.output)
    results = _results(store, pairs, matchers, poses, options)
    for path in write_report(store, results, matchers, left_out, poses):
        print(path, file=output, flush=True)
    return not any(isinstance(each.outcome, str) for each in results)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="canonical_form evaluate-matches",
        description="Match every pose of a class with every other, which is reduced and shuffled, and measure how far "
        "the matches are from the truth. A run that was stopped or killed goes on where it was.",
        epilog=f"Methods: {', '.join(MATCHERS)}.",
    )
    add_dataset(parser)
    parser.add_argument(
        "--methods", default=",".join(installed()), help="names, separated by commas (default: %(default)s)"
    )
    parser.add_argument(
        "--poses", type=int, default=5, metavar="N", help="poses of a class, evenly chosen (default: %(default)s)"
    )
    parser.add_argument("--across", action="store_true", help="match classes that share their vertices, too")
    add_workers(parser)
    return parser


def _results(
    store: Store, pairs: list[Pair], matchers: list[Matcher], poses: Poses, options: argparse.Namespace
) -> list[Result]:
    """Match the pairs that have no result yet."""
    from tqdm import tqdm

    wanted = {
        f"matches/{matcher.name}/{pair.name}": (
            pair,
            matcher,
            digest(file_digest(pair.one.path), file_digest(pair.other.path), matcher.name, code_version()),
        )
        for pair in pairs
        for matcher in matchers
    }
    missing = {name: each for name, each in wanted.items() if not store.has(name, each[2])}
    failed: dict[str, str] = {}

    def work() -> Iterator[tuple[object, Work]]:
        for name, (pair, matcher, _) in missing.items():
            one, other = poses.mesh(pair.one), poses.mesh(pair.other)
            yield name, (matched, (one, other, matcher.name, pair.one.label == pair.other.label))

    progress = tqdm(total=len(wanted), initial=len(wanted) - len(missing), unit="match", desc="Matches", **bar_style())
    with progress as bar, crew(options.workers, options.scheduler) as hired:
        for name, outcome in hired.results(work()) if missing else ():
            if isinstance(outcome, Failure):
                failed[str(name)] = outcome.reason
            else:
                store.keep_comparison(str(name), wanted[str(name)][2], *outcome)
                give_memory_back()
            bar.update()
    return [
        Result(pair, matcher, failed.get(name) or store.comparison(name, key) or "No result.")
        for name, (pair, matcher, key) in wanted.items()
    ]
