"""Shared by the commands of an evaluation: arguments, and checks before the work begins."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from ..blender.files.file_access import require_folder
from ..blender.words.file_errors import sentence
from ..core import CanonicalFormError

_PACKAGE = {"distributed": "dask[distributed]", "pyFM": "pyfmaps"}  # packages not named like their module


def add_dataset(parser: argparse.ArgumentParser) -> None:
    """Add the arguments for the dataset, its classes and the folder for the results.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        The parser.
    """
    parser.add_argument("dataset", type=Path, help="one folder per class, or all meshes and a file of their classes")
    parser.add_argument("--output", type=Path, required=True, metavar="DIR", help="folder for results and tables")
    parser.add_argument("--classes", type=Path, metavar="FILE", help=".cla file, or lines 'file,class'")


def add_workers(parser: argparse.ArgumentParser) -> None:
    """Add the arguments for the workers.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        The parser.
    """
    parser.add_argument(
        "--workers", type=int, default=os.cpu_count() or 1, metavar="N", help="processes (default: cores)"
    )
    parser.add_argument("--scheduler", metavar="HOST:PORT", help="use a Dask cluster instead of processes")


def exit_code(parser: argparse.ArgumentParser, words: Sequence[str], work: Callable[[argparse.Namespace], bool]) -> int:
    """Run a command and return its exit code; print a message if it cannot run.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        Parses the arguments.
    words : sequence of str
        The arguments after the command.
    work : callable
        The command: takes its options, returns whether all of it succeeded.

    Returns
    -------
    int
        0 if all succeeded, 1 if not, 2 if nothing could be computed, 130 after a keyboard interrupt.
    """
    try:
        options = parser.parse_args(words)
    except SystemExit as stop:
        return int(stop.code or 0)
    try:
        return int(not work(options))
    except (CanonicalFormError, OSError) as error:
        print(f"canonical_form: {sentence(error) if isinstance(error, OSError) else error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("canonical_form: Stopped; the same command goes on from here.", file=sys.stderr)
        return 130


def require_packages(names: Sequence[str]) -> None:
    """Check early that all modules are installed, instead of failing after hours.

    Parameters
    ----------
    names : sequence of str
        Names of modules.

    Raises
    ------
    CanonicalFormError
        If one is not installed; the message says how to install it.
    """
    missing = [_PACKAGE.get(name, name) for name in names if find_spec(name) is None]
    if missing:
        words = " ".join(missing)
        raise CanonicalFormError(f"An evaluation needs more packages. Install them with: pip install {words}")


def require_workers(count: int) -> None:
    """Check the number of workers.

    Parameters
    ----------
    count : int
        The number.

    Raises
    ------
    CanonicalFormError
        If it is below 1.
    """
    if count < 1:
        raise CanonicalFormError("--workers must be at least 1.")


def own_folder(output: Path, inputs: Sequence[Path]) -> None:
    """Create the folder for the results, which must not contain input files, as file names may coincide.

    Parameters
    ----------
    output : Path
        The folder for the results.
    inputs : sequence of Path
        The input files.

    Raises
    ------
    CanonicalFormError
        If it contains an input file, or cannot be created or written to.
    """
    if output.resolve() in {path.resolve().parent for path in inputs}:
        raise CanonicalFormError(f"{output} holds files of the dataset. Choose another --output.")
    require_folder(output)


def bar_style() -> dict[str, Any]:
    """Return the options of progress bars; bars in a log file are updated less often.

    Returns
    -------
    dict
        Arguments of a progress bar.
    """
    return {"smoothing": 0.05, "mininterval": 0.5 if sys.stderr.isatty() else 30.0}  # seconds
