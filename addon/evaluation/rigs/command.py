"""The command line: ``python -m addon evaluate-rigs FILE… --output DIR``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import TextIO, cast

from ...core import CanonicalFormError
from ...core.rigging.reference_rig import ReferenceRig
from ...scheduling.attempts import Failure
from ...scheduling.crews import LocalCrew, crew
from ...scheduling.workers import Work
from ..arguments import add_workers, bar_style, exit_code, own_folder, require_packages, require_workers
from ..store import Store, code_version, digest, file_digest
from .characters import Character, read_character
from .report import Result, write_report
from .work import judged

_SAME, _MANNEQUIN = "same", "mannequin"


def main(arguments: list[str], output: TextIO | None = None) -> int:
    """Evaluate rigs on characters that have one.

    Parameters
    ----------
    arguments : list of str
        The arguments after ``evaluate-rigs``.
    output : TextIO, optional
        Stream for the names of the written files; standard output if omitted.

    Returns
    -------
    int
        0 if every pose was rigged, 1 if one failed, 2 if nothing could be computed, 130 after a keyboard interrupt.
    """
    return exit_code(_parser(), arguments, lambda options: _evaluate(options, output or sys.stdout))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="canonical_form evaluate-rigs",
        description="Rig characters, in poses of their own bones, reduced and shuffled, and measure joints, weights "
        "and new poses. A run that was stopped or killed goes on where it was.",
    )
    parser.add_argument("files", nargs="+", type=Path, help="rigged characters: .glb, .fbx, .blend")
    parser.add_argument("--output", type=Path, required=True, metavar="DIR", help="folder for results and tables")
    parser.add_argument(
        "--references", nargs="+", default=[_SAME, _MANNEQUIN], metavar="R",
        help="what lends its bones: the same character at rest, the mannequin, or files (default: same mannequin)",
    )  # fmt: skip
    parser.add_argument("--frames", type=int, default=2, metavar="N", help="poses of a clip (default: %(default)s)")
    parser.add_argument(
        "--random", type=int, default=2, metavar="N", help="poses of random bones (default: %(default)s)"
    )
    parser.add_argument("--automatic", action="store_true", help="measure Blender's automatic weights, too")
    add_workers(parser)
    return parser


def _evaluate(options: argparse.Namespace, output: TextIO) -> bool:
    """Run the evaluation, and return whether every pose was rigged."""
    require_packages(["tqdm", "threadpoolctl", *(["distributed"] if options.scheduler else [])])
    require_workers(options.workers)
    if options.frames < 0 or options.random < 0 or options.frames + options.random < 1:
        raise CanonicalFormError("--frames and --random must not be negative, and not both 0.")
    others = [Path(each) for each in options.references if each not in (_SAME, _MANNEQUIN)]
    paths = {path.resolve(): path for path in [*options.files, *others]}.values()
    names = [_SAME, _MANNEQUIN, *(path.stem for path in paths)]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise CanonicalFormError(f"Two characters are called {twice}. Rename one of the files.")
    own_folder(options.output, [*options.files, *others])
    characters, left_out = _characters([*options.files, *others], options)
    lent = {each.stem: each for each in others}
    if left_out.keys() & lent.keys() or not any(path.stem in characters for path in options.files):
        raise CanonicalFormError("; ".join(f"{name}: {why}" for name, why in left_out.items()))
    store = Store(options.output)
    results = _results(store, characters, options)
    for path in write_report(store, results, left_out):
        print(path, file=output, flush=True)
    return not any(isinstance(each.outcome, str) for each in results)


def _characters(paths: list[Path], options: argparse.Namespace) -> tuple[dict[str, Character], dict[str, str]]:
    """Read characters by Blender in another process, which a damaged file may kill; also why one could not be read."""
    found: dict[str, Character] = {}
    failed: dict[str, str] = {}
    with closing(LocalCrew(1, attempts=2)) as process:
        work = ((path, (read_character, (path, options.frames, options.random))) for path in dict.fromkeys(paths))
        for path, outcome in process.results(work):
            name = cast("Path", path).stem
            if isinstance(outcome, Failure):
                failed[name] = "Blender crashed on it." if outcome.died else outcome.reason
            else:
                found[name] = cast("Character", outcome)
    return found, failed


def _results(store: Store, characters: dict[str, Character], options: argparse.Namespace) -> list[Result]:
    """Rig what has no result yet."""
    from tqdm import tqdm

    code = code_version()
    wanted: dict[str, tuple[str, str, str, ReferenceRig | None, str]] = {}
    for path in dict.fromkeys(options.files):
        character = characters.get(path.stem)
        for reference in options.references if character is not None else ():
            lender = path if reference == _SAME else None if reference == _MANNEQUIN else Path(reference)
            called = reference if lender is None or reference == _SAME else lender.stem
            bones = None if lender is None else characters[lender.stem].rig
            inputs = [file_digest(path), "" if lender is None else file_digest(lender), str(options.automatic), code]
            for pose in character.poses if character is not None else ():
                key = digest(*inputs, pose, str(options.frames), str(options.random))
                wanted[f"rigs/{called}/{path.stem}/{pose}"] = (path.stem, pose, called, bones, key)
    missing = {name: each for name, each in wanted.items() if not store.has(name, each[4])}
    failed: dict[str, str] = {}

    def work() -> Iterator[tuple[object, Work]]:
        for name, (who, pose, _, bones, _key) in missing.items():
            yield name, (judged, (characters[who], pose, bones, options.automatic))

    progress = tqdm(total=len(wanted), initial=len(wanted) - len(missing), unit="rig", desc="Rigs", **bar_style())
    with progress as bar, crew(options.workers, options.scheduler) as hired:
        for name, outcome in hired.results(work()) if missing else ():
            if isinstance(outcome, Failure):
                failed[str(name)] = outcome.reason
            else:
                store.keep_comparison(str(name), wanted[str(name)][4], *outcome)
            bar.update()
    results = []
    for name, (who, pose, called, _, key) in wanted.items():
        kept = store.comparison(name, key)
        results.append(Result(who, pose, called, failed.get(name) or (kept[0] if kept else "No result.")))
    return results
