"""The command line: arguments in, files processed by the requested number of workers, result lines out."""

from __future__ import annotations

import json
import os
import sys
import time
from argparse import Namespace
from collections.abc import Sequence
from contextlib import redirect_stdout, suppress
from pathlib import Path
from secrets import token_hex
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

_ATTEMPTS = 2  # of a file that may have killed its worker: another file may be the cause
_CRASHED = "Blender crashed on this file; it may be damaged, or the memory was not enough."


def main(words: Sequence[str], output: TextIO, *, alone: bool = False) -> int:
    """Run the command line.

    Parameters
    ----------
    words : sequence of str
        The arguments after the name of the command.
    output : TextIO
        Stream for the result lines.
    alone : bool
        Work in this process, as inside Blender.

    Returns
    -------
    int
        0 if every mesh was computed, 1 if one failed, 2 for invalid arguments, 130 after a keyboard interrupt, 141 if
        nobody reads the result lines any more.
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
    except BrokenPipeError:  # whoever read the lines has ended, as `head` does
        os.dup2(os.open(os.devnull, os.O_WRONLY), output.fileno())  # what Python still writes at its end
        return 141
    except CanonicalFormError as error:
        complain(str(error))
        return 1
    finally:
        run.close()


def _mark() -> str:
    """Return a name for this run's partial files; processes of different containers may have the same number."""
    return f"{os.getpid()}-{token_hex(4)}"


class _Run:
    """A run over several files."""

    def __init__(self, options: Namespace, alone: bool) -> None:
        if options.jobs < 1:
            raise CanonicalFormError(f"--jobs must be at least 1; got {options.jobs}.")
        if alone and (options.jobs > 1 or options.scheduler):
            raise CanonicalFormError(
                "Inside Blender there is one job only. For --jobs and --scheduler use Blender as a module "
                "(pip install bpy, python -m addon)."
            )
        if options.scheduler:  # the workers have their own working directories
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
            mark=_mark(),
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
        """Process all files and report each when it is finished."""
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
        """Release the workers, and remove their partial files."""
        self._crew.close()
        for partial in self.wanted.output.glob(f".*.{self.wanted.mark}.partial*"):
            partial.unlink(missing_ok=True)

    def _is_done(self, targets: Targets) -> bool:
        """Return whether a file already has its only result; several results are checked when the file is open."""
        return self.wanted.skip_existing and not self.wanted.frames and targets.of_file().exists()

    def _reference(self) -> CanonicalForm | Likeness | None:
        """Compute the form of the reference, or read its pose, in a worker; return the pose of a mannequin."""
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
        """Print the lines of a file, and report errors."""
        for line in lines:
            if "error" in line:
                complain(f"{line['input']}: {line['error']}")
            self._told["failed" if "error" in line else "skipped" if line.get("skipped") else "done"] += 1
            print(json.dumps({"schema": SCHEMA, **line}), file=output, flush=True)


class _MatchRun:
    """A match of two files, in a separate process."""

    def __init__(self, options: Namespace, alone: bool) -> None:
        self._options, self._mark = options, _mark()
        settings_of(options)
        output: Path = options.output
        require_folder(output)
        one, other = (path.stem for path in options.meshes)
        if one.casefold() == other.casefold():
            with suppress(CanonicalFormError):  # the same folder, as a.ply and a.glb: one file all the same
                one, other = output_stems(options.meshes)
        self._target = output / f"{one}-{other}.npz"
        self._crew: Crew = InThisProcess() if alone else LocalCrew(1, _ATTEMPTS, one_thread=False)

    def all(self, output: TextIO) -> int:
        """Match the files, and report the result."""
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
        """Release the worker."""
        self._crew.close()


def compute_file(targets: Targets, wanted: Wanted, reference: CanonicalForm | Likeness | None) -> list[Line]:
    """Compute the meshes of one file, in a worker process.

    Parameters
    ----------
    targets : Targets
        The file, and the names of its results.
    wanted : Wanted
        What to do with the file.
    reference : CanonicalForm, Likeness or None
        The form to align to, or the pose that is applied instead of computing a form.

    Returns
    -------
    list of dict
        The result lines.
    """
    if not has_blender():
        from .plain_computing import compute_plainly

        return list(compute_plainly(targets, wanted, reference))
    _keep_output_clean()
    from .computing import compute_in_blender

    return list(compute_in_blender(targets, wanted, reference))


def compute_reference(path: Path, wanted: Wanted) -> CanonicalForm:
    """Compute the reference form that others are aligned to, in a worker process.

    Parameters
    ----------
    path : Path
        The file.
    wanted : Wanted
        What to do with the other files.

    Returns
    -------
    CanonicalForm
        Its form.

    Raises
    ------
    CanonicalFormError
        If the file cannot be read or the form cannot be computed.
    """
    if not has_blender():
        from .plain_computing import reference_plainly

        return reference_plainly(path, wanted)
    _keep_output_clean()
    from .computing import reference_in_blender

    return reference_in_blender(path, wanted)


def read_pose(path: Path, wanted: Wanted) -> Likeness:
    """Read the pose that is applied to others, in a worker process.

    Parameters
    ----------
    path : Path
        The file.
    wanted : Wanted
        What to do with the other files.

    Returns
    -------
    Likeness
        The pose.

    Raises
    ------
    CanonicalFormError
        If the file cannot be read.
    """
    if has_blender():
        _keep_output_clean()
    from .matching import read_likeness

    return read_likeness(path, wanted.objects, wanted.side, trusted=wanted.trusted)


def compute_match(options: Namespace, target: Path, mark: str, stages: bool) -> Line:
    """Match two files, in a worker process.

    Parameters
    ----------
    options, target, mark, stages
        As in `match_files`.

    Returns
    -------
    dict
        The result line.
    """
    if has_blender():
        _keep_output_clean()
    from .matching import match_files

    return match_files(options, target, mark, stages)


def _hired(options: Namespace, alone: bool) -> Crew:
    """Return the workers requested by the options."""
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
    """Redirect what Blender prints in a worker to standard error: standard output is for result lines."""
    if "bpy" not in sys.modules:
        sys.stdout.flush()
        os.dup2(2, 1)
