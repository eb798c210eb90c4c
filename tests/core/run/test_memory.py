import pytest

from addon.core.run.memory import free_memory, memory_limit


def test_the_limit_is_the_one_set_or_a_share_of_what_is_free():
    assert memory_limit(3.5) == 3.5
    assert 0 < memory_limit() == pytest.approx(0.6 * free_memory(), rel=0.1)


def test_free_memory_is_what_the_system_says():
    psutil = pytest.importorskip("psutil")
    assert free_memory() <= 1.05 * psutil.virtual_memory().available / 1e9
