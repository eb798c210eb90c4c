"""The command line, in this process or as a user runs it: its exit code, its lines, and what it complained of."""

import io
import json
import subprocess
import sys
import time
from collections.abc import Sequence
from contextlib import redirect_stderr
from pathlib import Path
from typing import Any

from addon.batch.command import main

ROOT = Path(__file__).resolve().parents[1]
Told = tuple[int, list[dict[str, Any]], str]
QUICK = ("--max-iterations", "2", "--landmark-count", "12")

_LIMITED = """
import io, json, resource, signal, sys
from contextlib import redirect_stderr
from addon.batch.command import main
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[1]),) * 2)
for words in json.load(sys.stdin):
    output, complaints = io.StringIO(), io.StringIO()
    with redirect_stderr(complaints):
        code = main(words, output, alone=True)
    told = [code, output.getvalue(), complaints.getvalue()]
    print("\\nTOLD", json.dumps(told), flush=True)  # after what Blender printed
"""


def run(*words: object, about: str = "compute") -> Told:
    """Run the command in this process, as inside Blender: three times as fast as processes of its own."""
    output, complaints = io.StringIO(), io.StringIO()
    with redirect_stderr(complaints):
        code = main([about, *map(str, words), *QUICK], output, alone=True)
    print(complaints.getvalue(), end="", file=sys.stderr)
    return _told(code, output.getvalue(), complaints.getvalue())


def run_apart(*words: object, about: str = "compute") -> Told:
    """Run the command as a user does: for what may harm the process that reads it, or is about processes."""
    return ended(started([*words, *QUICK], about))


def run_below_file_size(limit: int, *runs: list[str]) -> list[Told]:
    """Run commands in one process that cannot write files above a size, as on a disk that is full."""
    words = json.dumps([[*each, *QUICK] for each in runs])
    done = subprocess.run([sys.executable, "-c", _LIMITED, str(limit)], input=words, capture_output=True, text=True,
                          check=True, cwd=ROOT)  # fmt: skip
    lines = done.stderr.splitlines()  # Blender's own words keep out of standard output, and these with them
    told = (json.loads(line.removeprefix("TOLD")) for line in lines if line.startswith("TOLD"))
    return [(code, _parsed(output), complaints) for code, output, complaints in told]


def started(words: Sequence[object], about: str = "compute", **how: Any) -> subprocess.Popen[str]:
    """Start the command in a process of its own."""
    command = [sys.executable, "-m", "addon", about, *map(str, words)]
    return subprocess.Popen(command, **{"cwd": ROOT, **how}, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def busy_worker(process: subprocess.Popen[str], known: Sequence[int] = (), seconds: float = 3.5) -> Any:
    """Wait for a worker that is at a mesh: Blender takes two seconds to be there."""
    import psutil

    until = time.monotonic() + 120
    while time.monotonic() < until and process.poll() is None:
        for child in psutil.Process(process.pid).children():
            if child.pid not in known and child.cpu_times().user > seconds:
                return child
        time.sleep(0.05)
    raise AssertionError("no worker is at work")


def ended(process: subprocess.Popen[str]) -> Told:
    """Wait for the end of a command."""
    output, complaints = process.communicate(timeout=300)
    return _told(process.returncode, output, complaints)


def _told(code: int, output: str, complaints: str) -> Told:
    assert "Traceback" not in complaints, complaints
    return code, _parsed(output), complaints


def _parsed(output: str) -> list[dict[str, Any]]:
    return [json.loads(line) for line in output.splitlines()]
