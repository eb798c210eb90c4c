"""What a run will cost, known before it is spent."""

import subprocess
import sys

import pytest

from addon.core import Settings, TooLargeError
from addon.core.method_api.costs import (
    match_memory_estimate,
    match_time_estimate,
    memory_estimate,
    require_match_memory,
    require_memory,
    time_estimate,
)


def test_the_memory_is_known_beforehand():
    normal = [memory_estimate(count, Settings()) for count in (1_000, 10_000, 1_000_000)]
    assert normal == sorted(normal)
    assert normal[-1] < 6
    assert memory_estimate(10_000, Settings(quality="full")) > normal[1]


def test_estimates_grow_with_the_mesh_and_the_quality():
    for estimate in (memory_estimate, time_estimate):
        small, large = (estimate(count, Settings()) for count in (1_000, 4_000_000))
        assert 0 < small < large / 10
        assert estimate(20_000, Settings(quality="full")) > estimate(20_000, Settings())


def test_a_mesh_that_does_not_fit_is_refused_in_words(monkeypatch):
    monkeypatch.setattr("addon.core.run.memory.free_memory", lambda: 1.0)
    require_memory(400_000, Settings())
    with pytest.raises(
        TooLargeError, match=r"takes 0\.9 GB, more than 0\.6 GB, 60% of what is free\. Reduce the 1,000,000 vertices"
    ):
        require_memory(1_000_000, Settings())


def test_a_match_takes_more_than_the_forms_and_is_refused_in_words(monkeypatch):
    monkeypatch.setattr("addon.core.run.memory.free_memory", lambda: 1.0)
    assert match_memory_estimate(10_000, 200_000, Settings()) > memory_estimate(200_000, Settings())
    assert match_time_estimate(10_000, 200_000, Settings()) > time_estimate(200_000, Settings())
    require_match_memory(200_000, 200_000, Settings())
    with pytest.raises(TooLargeError, match=r"more than 0\.6 GB.* Reduce the 1,200,000 vertices"):
        require_match_memory(700_000, 500_000, Settings())


@pytest.mark.skipif(sys.platform != "linux", reason="needs ulimit -v")
def test_a_process_with_little_address_space_ends_with_a_sentence():
    code = """
import resource, sys
from addon.core import Settings, TooLargeError, canonical_form
from tests.meshes import shapes
import scipy.sparse.linalg, scipy.spatial
mesh = shapes.sphere(6)
taken = int(open('/proc/self/statm').read().split()[0]) * 4096
resource.setrlimit(resource.RLIMIT_AS, (taken + 80_000_000,) * 2)
try:
    canonical_form(*mesh)
except TooLargeError as error:
    print(error)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "of what is free" in done.stdout
