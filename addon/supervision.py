"""Runs the command line in a process of its own, so that a file on which Blender crashes costs that file only."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import IO, Any

SUPERVISED = "--supervised"  # an option of the command that people do not type: what an earlier process has done
_ENDS = (0, 1, 2, 130)  # exit codes of a command that came to its own end


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
    worst = 0
    while True:
        words = [sys.executable, "-m", __package__, *arguments, SUPERVISED, json.dumps(done)]
        process = subprocess.Popen(words, stdout=subprocess.PIPE)
        assert process.stdout is not None
        at = ""
        try:
            at = _passed_on(process.stdout, done)
            code = process.wait()
        except KeyboardInterrupt:
            return _stopped(process)
        if code in _ENDS:
            return max(code, worst)
        worst = 1
        if not at:  # it never came to a file: nothing to go on with
            print("canonical_form: Blender crashed as it started.", file=sys.stderr)
            return 1
        reason = f"Blender crashed on this file (exit code {code}); it may be damaged, or the memory was not enough."
        print(f"canonical_form: {at}: {reason}", file=sys.stderr)
        print(json.dumps({"input": at, "error": reason}), flush=True)


def _passed_on(stream: IO[bytes], done: dict[str, Any]) -> str:
    """Print the result lines of the process as they come; give the file that it was at in the end."""
    at = ""
    for line in stream:
        found = json.loads(line) if line.startswith(b"{") else {}  # else it is the help
        if "begun" in found:
            at, done["files"] = found["begun"], found["number"]
            continue
        if "output" in found:
            done["written"].append(Path(found["output"]).stem)
        sys.stdout.write(line.decode())
        sys.stdout.flush()
    return at


def _stopped(process: subprocess.Popen[bytes]) -> int:
    """Wait for a process that the keyboard stops too."""
    try:
        process.wait(10)
    except subprocess.TimeoutExpired:
        process.kill()
    return 130


def end_with_parent() -> None:
    """End this process when the one that started it is gone, killed or not."""
    from threading import Thread

    parent = os.getppid()

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(0.5)
        os._exit(1)

    Thread(target=watch, daemon=True).start()
