"""Runs the command line in a process of its own, so that a file on which Blender crashes costs that file only.

The two talk in lines of JSON: the first tells the other, on its standard input, what is done already, and keeps that
pipe open as a sign of life; the other tells what it is at among its result lines.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from threading import Thread, Timer
from typing import Any

_SUPERVISED = "CANONICAL_FORM_SUPERVISED"  # set for the other process
_PATIENCE = (1.0, 10.0)  # seconds after Ctrl+C until the other process is told too, and until it is killed
_STOPPED = 130


def supervised(arguments: Sequence[str]) -> int:
    """Run ``python -m addon`` with these words in another process, and again where it dies.

    Parameters
    ----------
    arguments : sequence of str
        The words.

    Returns
    -------
    int
        The exit code: as of the command; 1 too where Blender crashed on a file.
    """
    done: dict[str, Any] = {"files": 0, "written": []}
    failed = False
    while True:
        before = done["files"]
        process = subprocess.Popen(
            [sys.executable, "-m", __package__, *arguments],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env={**os.environ, _SUPERVISED: "1"},
        )
        at = _Report(done)
        try:
            _follow(process, at)
        except KeyboardInterrupt:
            return _stopped(process, at)
        if at.code is not None:
            return max(at.code, int(failed))
        code = process.returncode
        _tidy(at.folder, process.pid)
        if not at.file and done["files"] == before:
            if at.folder is not None or code < 0 or code > _STOPPED:
                print("canonical_form: Blender crashed as it started.", file=sys.stderr)
            return code if 0 < code <= _STOPPED else int(failed or code != 0)
        failed = True
        if at.file:
            reason = (
                f"Blender crashed on this file (exit code {code}); it may be damaged, or the memory was not enough."
            )
            print(f"canonical_form: {at.file}: {reason}", file=sys.stderr)
            print(json.dumps({"input": at.file, "error": reason}), flush=True)


class _Report:
    """What the other process has said."""

    def __init__(self, done: dict[str, Any]) -> None:
        self.done = done
        self.file = ""  # that it is at
        self.folder: str | None = None
        self.code: int | None = None

    def heard(self, line: bytes) -> None:
        found = json.loads(line) if line.startswith(b"{") else {}  # else it is the help
        if "begun" in found:
            self.file, self.done["files"], self.folder = found["begun"], found["number"], found["folder"]
        elif "ended" in found:
            self.file = ""
        elif "finished" in found:
            self.code = found["finished"]
        else:
            if "output" in found:
                self.done["written"].append(Path(found["output"]).stem.casefold())
            sys.stdout.flush()
            sys.stdout.buffer.write(line)
            sys.stdout.buffer.flush()


def _follow(process: subprocess.Popen[bytes], at: _Report) -> None:
    assert process.stdin is not None
    assert process.stdout is not None
    with suppress(BrokenPipeError):
        process.stdin.write(json.dumps(at.done).encode() + b"\n")
        process.stdin.flush()
    for line in process.stdout:
        at.heard(line)
    process.wait()


def _stopped(process: subprocess.Popen[bytes], at: _Report) -> int:
    """Let the other process come to its end after Ctrl+C, which it may have heard itself."""
    assert process.stdout is not None
    told = signal.SIGINT if sys.platform != "win32" else signal.SIGTERM
    timers = [Timer(_PATIENCE[0], process.send_signal, [told]), Timer(_PATIENCE[1], process.kill)]
    for timer in timers:
        timer.daemon = True
        timer.start()
    try:
        for line in process.stdout:
            at.heard(line)
        process.wait()
    except KeyboardInterrupt:
        process.kill()
        process.wait()
    for timer in timers:
        timer.cancel()
    _tidy(at.folder, process.pid)
    return _STOPPED


def _tidy(folder: str | None, pid: int) -> None:
    """Remove what a process that is gone left half-written."""
    if folder is not None:
        for path in Path(folder).glob(f".*.{pid}.partial*"):
            path.unlink(missing_ok=True)


def is_supervised() -> bool:
    """Tell whether this process was started by `supervised`.

    Returns
    -------
    bool
        True in the other process.
    """
    return _SUPERVISED in os.environ


def done_before() -> dict[str, Any]:
    """Read what earlier processes have done, and end this one when the first is gone, killed or not.

    Returns
    -------
    dict
        ``files``, the number of files that need no more work, and ``written``, names that are taken.
    """
    told = b""
    while not told.endswith(b"\n"):
        more = os.read(0, 1 << 16)
        if not more:
            os._exit(1)
        told += more

    def watch() -> None:
        while os.read(0, 1 << 10):
            pass
        os._exit(1)

    Thread(target=watch, daemon=True).start()
    return dict(json.loads(told))
