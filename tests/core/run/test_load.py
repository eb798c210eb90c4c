"""How busy the machine is: what the system tells, and what it does not."""

import os
import subprocess
import sys
from pathlib import Path
from time import sleep

import pytest

from addon.core.run import load


@pytest.mark.parametrize(
    ("minute", "running", "processors", "expected"),
    [(0.0, 1, 2, 1.0), (1.0, 2, 2, 1.0), (3.0, 4, 2, 2.0), (7.0, 1, 2, 1.0), (0.2, 9, 2, 1.0), (3.0, 8, 4, 1.0)],
)
def test_threads_share_the_processors(monkeypatch, minute, running, processors, expected):
    monkeypatch.setattr(os, "getloadavg", lambda: (minute, 0.0, 0.0))
    monkeypatch.setattr(Path, "read_text", lambda *_, **__: f"{minute} 0.00 0.00 {running}/100 4242")
    monkeypatch.setattr(load, "_processors", lambda: processors)
    assert load.slowdown() == expected


def test_a_system_that_does_not_tell_is_taken_as_free(monkeypatch):
    monkeypatch.delattr(os, "getloadavg")
    assert load.slowdown() == 1.0


def test_without_proc_the_last_minute_counts(monkeypatch):
    def missing(*_, **__):
        raise FileNotFoundError

    monkeypatch.setattr(os, "getloadavg", lambda: (5.0, 0.0, 0.0))
    monkeypatch.setattr(Path, "read_text", missing)
    monkeypatch.setattr(load, "_processors", lambda: 2)
    assert load.slowdown() == 3.0


@pytest.mark.skipif(not Path("/proc/loadavg").exists(), reason="needs /proc")
def test_threads_that_run_now_are_seen(monkeypatch):
    monkeypatch.setattr(os, "getloadavg", lambda: (100.0, 0.0, 0.0))
    others = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(6)]
    try:
        sleep(0.5)
        seen = max(load._others() for _ in range(20))
    finally:
        for each in others:
            each.kill()
            each.wait()
    assert seen >= 4
