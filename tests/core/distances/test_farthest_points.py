"""Points that lie far from each other."""

import numpy as np
from scipy.spatial.distance import cdist

from addon.core.distances.farthest_points import farthest_of


def test_no_point_is_farther_from_the_chosen_than_these_from_each_other():
    places = np.random.default_rng(0).uniform(size=(300, 2))
    apart = cdist(places, places)
    chosen = farthest_of(apart, 25)
    assert len(np.unique(chosen)) == 25
    between = apart[np.ix_(chosen, chosen)] + np.diag(np.full(25, np.inf))
    assert apart[chosen].min(axis=0).max() <= between.min()
    assert chosen[0] == np.argmin(apart.sum(axis=0))


def test_numbering_and_rounding_decide_nothing():
    places = np.random.default_rng(0).uniform(size=(300, 2))
    apart = cdist(places, places)
    order = np.random.default_rng(1).permutation(300)
    again = farthest_of(apart[np.ix_(order, order)] * (1 + 1e-12), 25)
    np.testing.assert_array_equal(order[again], farthest_of(apart, 25))


def test_no_more_points_are_chosen_than_there_are():
    assert sorted(farthest_of(1 - np.eye(3), 7)) == [0, 1, 2]
