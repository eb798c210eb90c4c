"""A batch in a process of its own: started, its workers seen at work, and what it said at its end."""

import json
import subprocess
import sys
import time
from pathlib import Path

import psutil

ROOT = Path(__file__).resolve().parents[2]


def started(words, **how):
    return subprocess.Popen([sys.executable, "-m", "addon", "compute", *map(str, words)], stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, text=True, cwd=ROOT, **how)  # fmt: skip


def busy_worker(process, known=(), seconds=3.5):
    """Wait for a worker that is at a mesh: Blender takes two seconds to be there."""
    until = time.monotonic() + 120
    while time.monotonic() < until and process.poll() is None:
        for child in psutil.Process(process.pid).children():
            if child.pid not in known and child.cpu_times().user > seconds:
                return child
        time.sleep(0.05)
    raise AssertionError("no worker is at work")


def ended(process):
    output, errors = process.communicate(timeout=300)
    assert "Traceback" not in errors
    return process.returncode, [json.loads(line) for line in output.splitlines()], errors
