"""The command line: arguments in, files processed by the requested number of workers, result lines out."""

from __future__ import annotations

import json
import os
import sys
import time
from argparse import Namespace
from collections.abc import Callable, Iterator, Sequence
from contextlib import redirect_stdout, suppress
from pathlib import Path
from secrets import token_hex
from typing import Any, NamedTuple, TextIO

from ..blender.files.file_access import require_folder
from ..blender.jobs.likeness import Likeness
from ..blender.words.file_errors import sentence
from ..core import CanonicalFormError
from ..scheduling.attempts import Failure
from ..scheduling.crews import Crew, DaskCrew, InThisProcess, LocalCrew
from .arguments import parsed
from .asked import wanted_of
from .claims import remove_left
from .computing import compute_file, compute_reference, read_pose
from .inputs import found_files, listed_files, output_stems, separators
from .lines import DONE, SCHEMA, FileCount, Line, complain
from .matching import match_files
from .open_files import Reference
from .report_log import ReportLog
from .targets import Targets
from .with_donors import rig_file, transfer_file

_ATTEMPTS = 2  # of a file that may have killed its worker: another file may be the cause
_WITH_DONORS: dict[str, Callable[..., Iterator[list[Line]]]] = {"transfer": transfer_file, "rig": rig_file}
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
        kind = {"match": _MatchRun, **dict.fromkeys(_WITH_DONORS, _DonorRun)}.get(options.command, _Run)
        run = kind(options, output, alone)
    except SystemExit as stop:
        return int(stop.code or 0)
    except CanonicalFormError as error:
        complain(str(error))
        return 2
    except OSError as error:
        complain(sentence(error))
        return 2
    try:
        return run.all()
    except KeyboardInterrupt:
        complain("Interrupted; files written so far are complete.")
        return 130
    except BrokenPipeError:  # whoever read the lines has ended, as `head` does
        os.dup2(os.open(os.devnull, os.O_WRONLY), output.fileno())  # what Python still writes at its end
        return 141
    except OSError as error:  # of the result lines: errors of files are told in them
        complain(f"The result lines cannot be written, so the run ends. {sentence(error)}")
        os.dup2(os.open(os.devnull, os.O_WRONLY), output.fileno())
        return 1
    except CanonicalFormError as error:
        complain(str(error))
        return 1
    finally:
        run.close()


class _Task(NamedTuple):
    """Work for a worker, and the files that its line names if the worker dies.

    The function yields the lines of a result as soon as it is written, and `DONE` at its end.
    """

    head: Line
    function: Callable[..., Iterator[list[Line]]]
    arguments: tuple[Any, ...]


class _Run:
    """The forms or poses of files: what is wanted, the workers that do it, and the lines that they return."""

    def __init__(self, options: Namespace, output: TextIO, alone: bool) -> None:
        if options.jobs < 1:
            raise CanonicalFormError(f"--jobs must be at least 1; got {options.jobs}.")
        if alone and (options.jobs > 1 or options.scheduler):
            raise CanonicalFormError(
                "Inside Blender there is one job only. For --jobs and --scheduler use Blender as a module "
                "(pip install bpy, python -m addon)."
            )
        if options.timeout is not None and (alone or options.scheduler or not options.timeout > 0):
            raise CanonicalFormError("--timeout is a number of seconds, for workers of this machine (python -m addon).")
        if options.scheduler:  # the workers have their own working directories
            options.output = options.output.resolve()
            options.meshes = [path.resolve() for path in options.meshes]
        self._wanted = wanted_of(
            options,
            mark=f"{os.getpid()}-{token_hex(4)}",  # processes of different containers may have the same number
            stages=sys.stderr.isatty() and options.jobs == 1 and not options.scheduler,
        )
        self._output, self._dry = output, options.dry_run
        self._targets: list[Targets] = []
        self._log: ReportLog | None = None
        self._known: set[tuple[str, ...]] = set()
        self._told = {"done": 0, "failed": 0, "skipped": 0}
        self._plan(options)
        for folder in () if self._dry else dict.fromkeys([options.output, *(each.output for each in self._targets)]):
            require_folder(folder)
        self._crew = _hired(options, alone)
        if options.log is not None and not self._dry:
            whole = {str(each.of_file().resolve()) for each in self._targets}
            try:
                self._log = ReportLog(options.log, options.skip_existing, whole)
            except BaseException:
                self._crew.close()
                raise

    def _plan(self, options: Namespace) -> None:
        """Find the files, and name their results."""
        self._read = read_pose if options.command == "pose-like" else compute_reference
        words = [*options.meshes, *(listed_files(options.files_from) if options.files_from else [])]
        found = found_files(words, options.output, recursive=options.recursive)
        if not found:
            raise CanonicalFormError("Name the meshes: files, folders or patterns, or --files-from a list of them.")
        files = [each.path for each in found]
        tree = options.output_tree
        stems = [path.name for path in files] if tree else output_stems(files)
        dashes = ["-"] * len(stems) if tree else separators(stems)
        self._reference_path: Path | None = None
        if options.reference == "first" and options.command == "compute":
            self._reference_path = files[0]
        elif options.reference is not None:
            named = Path(options.reference)
            self._reference_path = named.resolve() if options.scheduler else named
        inputs = (*files, *([] if self._reference_path is None else [self._reference_path]))
        self._targets = [
            Targets(
                each.path, options.output / each.place if tree else options.output, stem, dash, options.format, inputs
            )
            for each, stem, dash in zip(found, stems, dashes, strict=True)
        ]
        if len({each.of_file() for each in self._targets}) < len(self._targets):
            raise CanonicalFormError("Two files would have the same result. Name each mesh once.")

    def all(self) -> int:
        """Do the work, report each task when it is finished, and return the exit code."""
        began = time.monotonic()
        if self._dry:
            self._tell(
                [{"input": str(each.path), "output": str(each.of_file()), "dry_run": True} for each in self._targets]
            )
            return 0
        tasks = self._tasks()
        progress = FileCount(len(tasks), time.monotonic)
        work = ((number, (task.function, task.arguments)) for number, task in enumerate(tasks))
        for number, result in self._crew.results(work):
            progress.clear()
            if isinstance(result, Failure):
                self._tell([{**tasks[int(str(number))].head, "error": _reason(result)}])
            elif result != DONE:
                self._tell([line for line in result if self._is_new(line)])
            if isinstance(result, Failure) or result == DONE:
                progress.done()
        if len(self._targets) > 1 and sys.stderr.isatty():
            counts = ", ".join(f"{count} {name}" for name, count in self._told.items() if count)
            complain(f"{counts}, {time.monotonic() - began:.0f} s.")
        return int(self._told["failed"] > 0)

    def _tasks(self) -> list[_Task]:
        """Return the work that is not done yet, after the reference is known."""
        pending = self._pending()
        reference = self._reference() if pending else None
        return [_Task({"input": str(each.path)}, compute_file, (each, self._wanted, reference)) for each in pending]

    def _pending(self) -> list[Targets]:
        """Return the files that have no result yet, and tell which have."""
        pending = []
        for each in self._targets:
            if self._wanted.skip_existing and not self._wanted.frames and each.of_file().exists():
                self._tell([each.skipped(each.of_file(), None)])  # several results are checked when the file is open
            else:
                pending.append(each)
        return pending

    def _reference(self) -> Reference:
        """Compute the form of the reference, or read its pose, in a worker; return the pose of a mannequin."""
        if self._wanted.pose:
            return Likeness(self._wanted.pose, side=self._wanted.side, anyway=self._wanted.anyway)
        if self._reference_path is None:
            return None
        work = iter([("reference", (self._read, (self._reference_path, self._wanted)))])
        ((_, found),) = self._crew.results(work)
        if isinstance(found, Failure):
            raise CanonicalFormError(f"The reference {self._reference_path} cannot be used. {_reason(found)}")
        return found  # type: ignore[no-any-return]

    def close(self) -> None:
        """Release the workers, and remove their partial files."""
        self._crew.close()
        if self._log is not None:
            self._log.close()
        for folder in {self._wanted.output, *(each.output for each in self._targets)}:
            for partial in folder.glob(f".*.{self._wanted.mark}.partial*"):
                partial.unlink(missing_ok=True)
            remove_left(folder)

    def _is_new(self, line: Line) -> bool:
        """Return whether a line was not told yet: a file that killed its worker begins again with the same results."""
        name = tuple(str(line.get(each)) for each in ("input", "object", "frame", "output"))
        if "error" in line:
            return True
        known = name in self._known
        self._known.add(name)
        return not known

    def _tell(self, lines: list[Line]) -> None:
        """Print lines, those of a result at once, and report errors."""
        lines = [{"schema": SCHEMA, **line} for line in lines]
        for line in lines:
            if "error" in line:
                files = " and ".join(line[name] for name in ("input", "other") if name in line)
                complain(f"{files}: {line['error']}")
            self._told["failed" if "error" in line else "skipped" if line.get("skipped") else "done"] += 1
        if self._log is not None:
            self._log.add(lines)
        self._output.write("".join(f"{json.dumps(line)}\n" for line in lines))
        self._output.flush()


class _MatchRun(_Run):
    """The match of two files, in one task."""

    def _plan(self, options: Namespace) -> None:
        self._files: list[Path] = options.meshes
        stems = [path.stem for path in self._files]
        if stems[0].casefold() == stems[1].casefold():
            with suppress(CanonicalFormError):  # the same folder, as a.ply and a.glb: one file all the same
                stems = output_stems(self._files)
        self._target = options.output / f"{'-'.join(stems)}.npz"

    def _tasks(self) -> list[_Task]:
        one, other = self._files
        head = {"input": str(one), "other": str(other)}
        return [_Task(head, match_files, (one, other, self._target, self._wanted))]


class _DonorRun(_Run):
    """Data or rigs for files, from one that each worker reads itself."""

    def _plan(self, options: Namespace) -> None:
        super()._plan(options)
        self._made = _WITH_DONORS[options.command]

    def _tasks(self) -> list[_Task]:
        """Return the work that is not done yet."""
        donor = self._reference_path
        return [_Task({"input": str(each.path)}, self._made, (each, self._wanted, donor)) for each in self._pending()]


def _reason(failure: Failure) -> str:
    """Return why a worker has no result."""
    return _CRASHED if failure.died else failure.reason


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
    return LocalCrew(options.jobs, _ATTEMPTS, one_thread=options.jobs > 1, timeout=options.timeout)
