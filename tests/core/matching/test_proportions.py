"""Distances on a body, as they were if its limbs had the lengths of another's."""

import numpy as np

from addon.core.matching.proportions import in_proportion

OWN = np.array([[0.0, 1.0, 2.0], [1.0, 0.0, 2.5], [2.0, 2.5, 0.0]])  # between the feature points
OTHERS = np.array([[0.0, 1.5, 4.0], [1.5, 0.0, 4.5], [4.0, 4.5, 0.0]])


def test_the_feature_points_lie_where_the_other_body_has_them():
    np.testing.assert_allclose(in_proportion(OWN, OWN, OTHERS), OTHERS)
    np.testing.assert_allclose(in_proportion(OTHERS, OTHERS, OWN), OWN)


def test_between_two_of_them_distances_are_stretched_evenly():
    halfway = np.array([[0.5, 0.5, 1.0], [1.5, 1.75, 2.25]])
    np.testing.assert_allclose(in_proportion(halfway, OWN, OTHERS), [[0.75, 0.75, 2.0], [2.75, 3.0, 4.25]])


def test_beyond_the_farthest_they_grow_as_it_does():
    np.testing.assert_allclose(in_proportion(np.array([[3.0, 3.0, 3.0]]), OWN, OTHERS), [[6.0, 5.4, 5.4]])


def test_a_body_of_the_same_lengths_keeps_its_distances():
    away = np.random.default_rng(0).uniform(0, 4, (50, 3))
    np.testing.assert_allclose(in_proportion(away, OWN, OWN), away)


def test_a_point_farther_away_stays_farther_whatever_the_order_of_the_others():
    away = np.sort(np.random.default_rng(1).uniform(0, 3, (50, 3)), axis=0)
    swapped = OTHERS[np.ix_([2, 0, 1], [2, 0, 1])]  # the nearest of one body is the farthest of the other
    assert (np.diff(in_proportion(away, OWN, swapped), axis=0) >= 0).all()


def test_one_feature_point_alone_tells_no_lengths():
    away = np.array([[0.3], [0.7]])
    assert in_proportion(away, np.zeros((1, 1)), np.zeros((1, 1))) is away
