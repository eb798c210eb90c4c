"""The command: words in, files worked on by as many processes as wanted, lines out."""

from __future__ import annotations

import json
import os
import sys
import time
from argparse import Namespace
from collections.abc import Sequence
from contextlib import redirect_stdout
from pathlib import Path
from typing import TextIO

from ..blender.files.file_access import require_folder
from ..blender.jobs.likeness import Likeness
from ..blender.words.file_errors import sentence
from ..core import CanonicalForm, CanonicalFormError
from ..scheduling.attempts import Failure
from ..scheduling.crews import Crew, DaskCrew, InThisProcess, LocalCrew
from .arguments import Wanted, parsed, settings_of, wanted_of
from .inputs import found_files, output_stems, separators
from .lines import SCHEMA, FileCount, Line, complain
from .plain_files import has_blender
from .targets import Targets

_ATTEMPTS = 2  # of a file that may have cost a worker the life: another may have
_CRASHED = "Blender crashed on this file; it may be damaged, or the memory was not enough."


def main(words: Sequence[str], output: TextIO, *, alone: bool = False) -> int:
    """Run the command line.

    Parameters
    ----------
    words : sequence of str
        The words after the name of the command.
    output : TextIO
        Where the lines go.
    alone : bool
        Work in this process, as inside Blender.

    Returns
    -------
    int
        0 if every mesh was done, 1 if one failed, 2 if the words make no sense, 130 if stopped by the keyboard.
    """
    try:
        with redirect_stdout(output):  # for --help
            options = parsed(list(words))
        run = _MatchRun(options, alone) if options.command == "match" else _Run(options, alone)
    except SystemExit as stop:
        return int(stop.code or 0)
    except CanonicalFormError as error:
        complain(str(error))
        return 2
    except OSError as error:
        complain(sentence(error))
        return 2
    try:
        return run.all(output)
    except KeyboardInterrupt:
        complain("Interrupted; files written so far are complete.")
        return 130
    except CanonicalFormError as error:
        complain(str(error))
        return 1
    finally:
        run.close()


class _Run:
    """All the files of a run."""

    def __init__(self, options: Namespace, alone: bool) -> None:
        if options.jobs < 1:
            raise CanonicalFormError(f"--jobs must be at least 1; got {options.jobs}.")
        if alone and (options.jobs > 1 or options.scheduler):
            raise CanonicalFormError(
                "Inside Blender there is one job only. For --jobs and --scheduler use Blender as a module "
                "(pip install bpy, python -m addon)."
            )
        if options.scheduler:  # the workers have working folders of their own
            options.output = options.output.resolve()
            options.meshes = [path.resolve() for path in options.meshes]
        files = found_files(options.meshes, options.output)
        stems = output_stems(files)
        named = options.reference
        self._posing = options.command == "pose-like"
        first = named == "first" and not self._posing
        self._reference_path = None if named is None else files[0] if first else Path(named)
        if options.scheduler and self._reference_path is not None:
            self._reference_path = self._reference_path.resolve()
        inputs = (*files, *([self._reference_path] if self._reference_path else []))
        require_folder(options.output)
        self.wanted = wanted_of(
            options,
            mark=str(os.getpid()),
            stages=sys.stderr.isatty() and options.jobs == 1 and not options.scheduler,
            inputs=inputs,
        )
        self._targets = [
            Targets(path, options.output, stem, dash, options.format, inputs)
            for path, stem, dash in zip(files, stems, separators(stems), strict=True)
        ]
        self._crew = _hired(options, alone)
        self._told = {"done": 0, "failed": 0, "skipped": 0}

    def all(self, output: TextIO) -> int:
        """Do all the files and tell of each as it ends."""
        began = time.monotonic()
        pending = [number for number, each in enumerate(self._targets) if not self._is_done(each)]
        for number in sorted(set(range(len(self._targets))) - set(pending)):
            self._tell([self._targets[number].skipped(self._targets[number].of_file(), None)], output)
        reference = self._reference() if pending else None
        progress = FileCount(len(pending), time.monotonic)
        work = ((number, (compute_file, (self._targets[number], self.wanted, reference))) for number in pending)
        for name, result in self._crew.results(work):
            progress.clear()
            path = self._targets[int(str(name))].path
            if isinstance(result, Failure):
                result = [{"input": str(path), "error": _CRASHED if result.died else result.reason}]
            self._tell(result, output)
            progress.done()
        if len(self._targets) > 1 and sys.stderr.isatty():
            counts = ", ".join(f"{count} {name}" for name, count in self._told.items() if count)
            complain(f"{counts}, {time.monotonic() - began:.0f} s.")
        return int(self._told["failed"] > 0)

    def close(self) -> None:
        """Let the workers go, and remove what they left half-written."""
        self._crew.close()
        for partial in self.wanted.output.glob(f".*.{self.wanted.mark}.partial*"):
            partial.unlink(missing_ok=True)

    def _is_done(self, targets: Targets) -> bool:
        """Return whether a file has its only result already; several are looked for when it is open."""
        return self.wanted.skip_existing and not self.wanted.frames and targets.of_file().exists()

    def _reference(self) -> CanonicalForm | Likeness | None:
        """Compute the form of the reference, or read its pose, in a worker; make the pose of a mannequin."""
        if self.wanted.pose:
            return Likeness(self.wanted.pose, side=self.wanted.side)
        if self._reference_path is None:
            return None
        read = read_pose if self._posing else compute_reference
        work = iter([("reference", (read, (self._reference_path, self.wanted)))])
        ((_, found),) = self._crew.results(work)
        if isinstance(found, Failure):
            reason = _CRASHED if found.died else found.reason
            raise CanonicalFormError(f"The reference {self._reference_path} cannot be used. {reason}")
        return found  # type: ignore[no-any-return]

    def _tell(self, lines: list[Line], output: TextIO) -> None:
        """Print the lines of a file, and complain of what failed."""
        for line in lines:
            if "error" in line:
                complain(f"{line['input']}: {line['error']}")
            self._told["failed" if "error" in line else "skipped" if line.get("skipped") else "done"] += 1
            print(json.dumps({"schema": SCHEMA, **line}), file=output, flush=True)


class _MatchRun:
    """The match of two files, in a process of its own."""

    def __init__(self, options: Namespace, alone: bool) -> None:
        self._options, self._mark = options, str(os.getpid())
        settings_of(options)
        output: Path = options.output
        require_folder(output)
        one, other = output_stems(options.meshes)
        self._target = output / f"{one}-{other}.npz"
        self._crew: Crew = InThisProcess() if alone else LocalCrew(1, _ATTEMPTS, one_thread=False)

    def all(self, output: TextIO) -> int:
        """Match them, and tell."""
        work = iter([("match", (compute_match, (self._options, self._target, self._mark, sys.stderr.isatty())))])
        ((_, line),) = self._crew.results(work)
        if isinstance(line, Failure):
            one, other = self._options.meshes
            line = {"input": str(one), "other": str(other), "error": _CRASHED if line.died else line.reason}
        if "error" in line:
            complain(f"{line['input']} and {line['other']}: {line['error']}")
        print(json.dumps({"schema": SCHEMA, **line}), file=output, flush=True)
        return int("error" in line)

    def close(self) -> None:
        """Let the worker go."""
        self._crew.close()


def compute_file(targets: Targets, wanted: Wanted, reference: CanonicalForm | Likeness | None) -> list[Line]:
    """Compute the meshes of one file, in the process of a worker.

    Parameters
    ----------
    targets : Targets
        The file, and names of its results.
    wanted : Wanted
        What is to be done.
    reference : CanonicalForm, Likeness or None
        What the forms are laid onto; or the pose that is taken instead of a form.

    Returns
    -------
    list of dict
        The lines to tell.
    """
    if not has_blender():
        from .plain_computing import compute_plainly

        return list(compute_plainly(targets, wanted, reference))
    _keep_output_clean()
    from .computing import compute_in_blender

    return list(compute_in_blender(targets, wanted, reference))


def compute_reference(path: Path, wanted: Wanted) -> CanonicalForm:
    """Compute the form that others are laid onto, in the process of a worker.

    Parameters
    ----------
    path : Path
        The file.
    wanted : Wanted
        What is to be done with the others.

    Returns
    -------
    CanonicalForm
        Its form.

    Raises
    ------
    CanonicalFormError
        If it cannot be read or computed.
    """
    if not has_blender():
        from .plain_computing import reference_plainly

        return reference_plainly(path, wanted)
    _keep_output_clean()
    from .computing import reference_in_blender

    return reference_in_blender(path, wanted)


def read_pose(path: Path, wanted: Wanted) -> Likeness:
    """Read the pose that others take, in the process of a worker.

    Parameters
    ----------
    path : Path
        The file.
    wanted : Wanted
        What is to be done with the others.

    Returns
    -------
    Likeness
        The pose.

    Raises
    ------
    CanonicalFormError
        If it cannot be read.
    """
    if has_blender():
        _keep_output_clean()
    from .matching import read_likeness

    return read_likeness(path, wanted.objects, wanted.side, trusted=wanted.trusted)


def compute_match(options: Namespace, target: Path, mark: str, stages: bool) -> Line:
    """Match two files, in the process of a worker.

    Parameters
    ----------
    options, target, mark, stages
        As in `match_files`.

    Returns
    -------
    dict
        The line to tell.
    """
    if has_blender():
        _keep_output_clean()
    from .matching import match_files

    return match_files(options, target, mark, stages)


def _hired(options: Namespace, alone: bool) -> Crew:
    """Hire the workers that the words ask for."""
    if alone:
        return InThisProcess()
    if options.scheduler:
        cluster = DaskCrew(options.scheduler)
        if cluster.most_threads > 1:
            cluster.close()
            raise CanonicalFormError("Blender works on one file at a time. Start the Dask workers with --nthreads 1.")
        return cluster
    return LocalCrew(options.jobs, _ATTEMPTS, one_thread=options.jobs > 1)


def _keep_output_clean() -> None:
    """Send what Blender prints in a worker to standard error: standard output is for lines."""
    if "bpy" not in sys.modules:
        sys.stdout.flush()
        os.dup2(2, 1)
