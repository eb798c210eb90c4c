"""Nearest rows against a tree."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from addon.core.numerics.nearest import nearest_rows
from addon.core.run.errors import CancelledError
from addon.core.run.monitor import Monitor


def test_they_are_those_of_a_tree():
    points, others = np.random.default_rng(0).normal(size=(1500, 5)), np.random.default_rng(1).normal(size=(700, 5))
    assert (nearest_rows(points, others, Monitor()) == cKDTree(others).query(points)[1]).all()


def test_the_first_of_those_that_tie_is_taken():
    assert nearest_rows(np.zeros((2, 3)), np.zeros((4, 3)), Monitor()).tolist() == [0, 0]


def test_it_stops_when_asked():
    with pytest.raises(CancelledError):
        nearest_rows(np.zeros((2, 3)), np.zeros((4, 3)), Monitor(cancelled=lambda: True))
