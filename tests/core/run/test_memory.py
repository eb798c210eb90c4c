import subprocess
import sys

import pytest

from addon.core import Settings, TooLargeError
from addon.core.distance_fields import KINDS, distance_field, heat_geodesics
from addon.core.distances.costs import distance_memory
from addon.core.run.memory import free_memory, memory_limit
from addon.core.unfolding.costs import memory_estimate, require_memory, time_estimate
from tests.meshes import shapes


def test_the_limit_is_the_one_set_or_a_share_of_what_is_free():
    assert memory_limit(3.5) == 3.5
    assert 0 < memory_limit() == pytest.approx(0.6 * free_memory(), rel=0.1)


def test_free_memory_is_what_the_system_says():
    psutil = pytest.importorskip("psutil")
    assert free_memory() <= 1.05 * psutil.virtual_memory().available / 1e9


def test_estimates_grow_with_the_mesh_and_the_quality():
    for estimate in (memory_estimate, time_estimate):
        small, large = (estimate(count, Settings()) for count in (1_000, 1_000_000))
        assert 0 < small < large / 10
        assert estimate(20_000, Settings(quality="full")) > estimate(20_000, Settings())


def test_a_mesh_that_does_not_fit_is_refused_in_words(monkeypatch):
    monkeypatch.setattr("addon.core.run.memory.free_memory", lambda: 1.0)
    require_memory(400_000, Settings())
    with pytest.raises(
        TooLargeError, match=r"1,000,000 vertices needs about 1\.3 GB, more than 0\.6 GB, which is 60% of"
    ):
        require_memory(1_000_000, Settings())


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
    assert "of the free memory" in done.stdout


@pytest.mark.parametrize("kind", KINDS)
def test_distances_that_do_not_fit_are_refused_in_words(kind):
    mesh = shapes.grid(70, 70)
    said = "Fast marching takes far less" if kind == "heat" else r"\. Close other programs"
    with pytest.raises(TooLargeError, match=rf"need about 0\.\d GB, more than the limit of 0\.01 GB.*{said}"):
        distance_field(*mesh, [0], kind, memory_limit=0.01)
    small, large = (distance_memory(count, kind) for count in (1_000, 1_000_000))
    assert 0 < small < large / 10


def test_geodesics_that_do_not_fit_are_refused(monkeypatch):
    monkeypatch.setattr("addon.core.run.memory.free_memory", lambda: 0.01)
    with pytest.raises(TooLargeError, match="These distances need"):
        heat_geodesics(*shapes.grid(5, 5), [0])


def test_what_heat_refines_is_counted_refined():
    mesh = shapes.grid(70, 70)  # about 0.06 GB as it is, 0.13 GB refined
    with pytest.raises(TooLargeError):
        distance_field(*mesh, [0], memory_limit=0.1)
    with pytest.raises(TooLargeError):
        heat_geodesics(*mesh, [0], memory_limit=0.1)
