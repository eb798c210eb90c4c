"""Distances that do not fit into the memory."""

import pytest

from addon.core import TooLargeError
from addon.core.distance_fields import KINDS, distance_field, heat_geodesics
from addon.core.distances.costs import distance_memory
from tests.meshes import shapes


@pytest.mark.parametrize("kind", KINDS)
def test_distances_that_do_not_fit_are_refused_in_words(kind):
    mesh = shapes.grid(70, 70)
    said = r"takes 0\.\d GB, more than the limit of 0\.01 GB\. Close other programs"
    with pytest.raises(TooLargeError, match=said):
        distance_field(*mesh, [0], kind, memory_limit=0.01)
    small, large = (distance_memory(count, kind) for count in (1_000, 1_000_000))
    assert 0 < small < large / 10


def test_fast_marching_is_advised_where_it_fits():
    with pytest.raises(TooLargeError, match="Fast marching takes less and fits"):
        distance_field(*shapes.grid(70, 70), [0], memory_limit=0.1)


def test_geodesics_that_do_not_fit_are_refused(monkeypatch):
    monkeypatch.setattr("addon.core.run.memory.free_memory", lambda: 0.01)
    with pytest.raises(TooLargeError, match="This takes"):
        heat_geodesics(*shapes.grid(5, 5), [0])


def test_what_heat_refines_is_counted_refined():
    mesh = shapes.grid(70, 70)  # about 0.06 GB as it is, 0.13 GB refined
    with pytest.raises(TooLargeError):
        distance_field(*mesh, [0], memory_limit=0.1)
    with pytest.raises(TooLargeError):
        heat_geodesics(*mesh, [0], memory_limit=0.1)
