"""The command line: ``python -m addon evaluate-matches DATASET --output DIR``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping
from contextlib import closing
from pathlib import Path
from typing import Any, TextIO

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
from ..dataset import Shape, shapes_in
from ..reading import Reader
from ..store import Store, code_version, digest, file_digest
from .matchers import MATCHERS, Matcher, Mesh, chosen_matchers, installed
from .pairs import Pair, Poses, pairs_of
from .published import Landmarked, landmarked_meshes, listed_pairs
from .published_report import write_published
from .published_work import measured
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
    if options.truth is not None:
        return _evaluate_published(options, [each.name for each in matchers], output)
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


def _evaluate_published(options: argparse.Namespace, matchers: list[str], output: TextIO) -> bool:
    """Run the evaluation on a published benchmark."""
    require_packages(["pygeodesic"] if options.exact else [])
    truth = next((each for each in (options.dataset / options.truth, options.truth) if each.is_dir()), options.truth)
    if not truth.is_dir():
        raise CanonicalFormError(f"{truth} is no folder.")
    meshes = landmarked_meshes(options.dataset, truth)
    pairs = listed_pairs(meshes, options.pairs)[: options.first or None]
    own_folder(options.output, [*(each.path for each in meshes), *filter(None, [options.pairs])])
    store, how = Store(options.output), (options.points, options.exact)
    outcomes = _published_results(store, pairs, matchers, how, options)
    for path in write_published(store, outcomes, matchers, exact=options.exact):
        print(path, file=output, flush=True)
    return not any(isinstance(each, str) for each in outcomes.values())


def _published_results(
    store: Store,
    pairs: list[tuple[Landmarked, Landmarked]],
    matchers: list[str],
    how: tuple[int, bool],
    options: argparse.Namespace,
) -> dict[tuple[str, str, str], Any]:
    """Match the pairs that have no result yet."""
    wanted = {
        f"published/{matcher}/{one.name}@{other.name}": (one, other, matcher)
        for one, other in pairs
        for matcher in matchers
    }
    keys = {
        name: digest(file_digest(one.path), file_digest(other.path), matcher, repr(how), code_version())
        for name, (one, other, matcher) in wanted.items()
    }
    unlike = {
        name: f"Their .vts files have {len(one.truth)} and {len(other.truth)} lines."
        for name, (one, other, _) in wanted.items()
        if len(one.truth) != len(other.truth)
    }
    with closing(Reader()) as reader:
        poses = Poses(reader)

        def work(name: str) -> Work:
            one, other, matcher = wanted[name]
            meshes = (_read(poses, each.path) for each in (one, other))
            return measured, (*meshes, one.truth, other.truth, other.mirrored, matcher, *how)

        outcomes = _outcomes(store, keys, work, options, unlike)
    return {(one.name, other.name, matcher): outcomes[name] for name, (one, other, matcher) in wanted.items()}


def _read(poses: Poses, path: Path) -> Mesh:
    """Read a mesh of a benchmark, each once."""
    return poses.mesh(Shape("", path.stem, path))


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
    folder_of_truth = "a published benchmark, matched as it comes: folder of NAME.vts with the vertices that correspond"
    parser.add_argument("--truth", type=Path, metavar="DIR", help=folder_of_truth)
    parser.add_argument("--pairs", type=Path, metavar="FILE", help="with --truth: two names a line (default: all)")
    parser.add_argument("--first", type=int, default=0, metavar="N", help="with --truth: the first N pairs only")
    points = "with --truth: true points measured; 0: all (default: %(default)s)"
    parser.add_argument("--points", type=int, default=300, metavar="N", help=points)
    parser.add_argument("--exact", action="store_true", help="with --truth: exact geodesics, by pygeodesic")
    parser.add_argument("--across", action="store_true", help="match classes that share their vertices, too")
    add_workers(parser)
    return parser


def _results(
    store: Store, pairs: list[Pair], matchers: list[Matcher], poses: Poses, options: argparse.Namespace
) -> list[Result]:
    """Match the pairs that have no result yet."""
    wanted = {f"matches/{matcher.name}/{pair.name}": (pair, matcher) for pair in pairs for matcher in matchers}
    keys = {
        name: digest(file_digest(pair.one.path), file_digest(pair.other.path), matcher.name, code_version())
        for name, (pair, matcher) in wanted.items()
    }

    def work(name: str) -> Work:
        pair, matcher = wanted[name]
        one, other = poses.mesh(pair.one), poses.mesh(pair.other)
        return matched, (one, other, matcher.name, pair.one.label == pair.other.label)

    outcomes = _outcomes(store, keys, work, options, {})
    return [Result(pair, matcher, outcomes[name]) for name, (pair, matcher) in wanted.items()]


def _outcomes(
    store: Store,
    keys: Mapping[str, str],
    work: Callable[[str], Work],
    options: argparse.Namespace,
    refused: Mapping[str, str],
) -> dict[str, Any]:
    """Do the work of each match that is neither stored under its key nor refused; return results, or why there is none.

    The workers' results are kept as they come, so that a run that was stopped goes on where it was.
    """
    from tqdm import tqdm

    missing = [name for name in keys if name not in refused and not store.has(name, keys[name])]
    failed = dict(refused)
    progress = tqdm(total=len(keys), initial=len(keys) - len(missing), unit="match", desc="Matches", **bar_style())
    with progress as bar, crew(options.workers, options.scheduler) as hired:
        for name, outcome in hired.results((name, work(name)) for name in missing) if missing else ():
            if isinstance(outcome, Failure):
                failed[str(name)] = outcome.reason
            else:
                store.keep_comparison(str(name), keys[str(name)], *outcome)
                give_memory_back()
            bar.update()
    return {name: failed.get(name) or store.comparison(name, key) or "No result." for name, key in keys.items()}
