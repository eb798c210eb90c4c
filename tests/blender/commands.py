"""The command line, in this process or as a user runs it: its exit code, its lines, and what it complained of."""

import io
import json
import subprocess
import sys
from contextlib import redirect_stderr
from pathlib import Path
from typing import Any

from addon.batch.command import main

ROOT = Path(__file__).resolve().parents[2]
Told = tuple[int, list[dict[str, Any]], str]
_QUICK = ("--max-iterations", "2", "--landmark-count", "12")

_LIMITED = """
import io, json, resource, signal, sys
from addon.batch.command import main
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[1]),) * 2)
for words in json.load(sys.stdin):
    output = io.StringIO()
    code = main(words, output, alone=True)
    print("\\nTOLD", json.dumps([code, output.getvalue()]), flush=True)  # after what Blender printed
"""


def run(*words: object, about: str = "compute") -> Told:
    """Run the command in this process, as inside Blender: three times as fast as processes of its own."""
    output, complaints = io.StringIO(), io.StringIO()
    with redirect_stderr(complaints):
        code = main([about, *map(str, words), *_QUICK], output, alone=True)
    return _told(code, output.getvalue(), complaints.getvalue())


def run_apart(*words: object, about: str = "compute") -> Told:
    """Run the command as a user does: for what may harm the process that reads it, or is about processes."""
    return ended([sys.executable, "-m", "addon", about, *map(str, words), *_QUICK])


def run_below_file_size(limit: int, *runs: list[str]) -> list[tuple[int, list[dict[str, Any]]]]:
    """Run commands in one process that cannot write files above a size, as on a disk that is full."""
    words = json.dumps([[*each, *_QUICK] for each in runs])
    done = subprocess.run([sys.executable, "-c", _LIMITED, str(limit)], input=words, capture_output=True, text=True,
                          check=True, cwd=ROOT)  # fmt: skip
    lines = done.stderr.splitlines()  # Blender's own words keep out of standard output, and these with them
    told = (line.removeprefix("TOLD") for line in lines if line.startswith("TOLD"))
    return [(code, [json.loads(each) for each in output.splitlines()]) for code, output in map(json.loads, told)]


def ended(command: list[str], **how: Any) -> Told:
    """Run a command to its end."""
    done = subprocess.run(command, **{"cwd": ROOT, **how}, capture_output=True, text=True, check=False, timeout=300)
    return _told(done.returncode, done.stdout, done.stderr)


def _told(code: int, output: str, complaints: str) -> Told:
    assert "Traceback" not in complaints, complaints
    return code, [json.loads(line) for line in output.splitlines()], complaints
