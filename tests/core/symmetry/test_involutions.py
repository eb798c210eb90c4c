"""Swaps of feature points."""

import numpy as np
from scipy.spatial.distance import cdist

from addon.core.symmetry.involutions import feature_involutions

FOUR_LEGS = np.array([[1.0, 3, 0], [-1, 3, 0], [1.2, -3, 0], [-1.2, -3, 0], [0, 5, 1], [0, -6, 1]])  # head, tail
SWAPPED = [1, 0, 3, 2, 4, 5]


def test_left_and_right_legs_are_swapped_and_head_and_tail_stay():
    best = feature_involutions(cdist(FOUR_LEGS, FOUR_LEGS), np.ones(6))[0]
    assert best.tolist() == SWAPPED


def test_every_way_swaps_a_pair_and_is_its_own_inverse():
    ways = feature_involutions(cdist(FOUR_LEGS, FOUR_LEGS), np.ones(6), most=100)
    assert len(ways) > 1
    for way in ways:
        assert (way[way] == np.arange(6)).all()
        assert (way != np.arange(6)).any()


def test_another_order_gives_the_same_swaps():
    order = np.array([3, 5, 0, 2, 4, 1])
    best = feature_involutions(cdist(FOUR_LEGS[order], FOUR_LEGS[order]), np.ones(6))[0]
    assert order[best].tolist() == np.array(SWAPPED)[order].tolist()


def test_limbs_of_unlike_size_are_not_swapped():
    unlike = np.array([1.0, 5.0, 1.0, 1.0, 1.0, 1.0])
    assert all(way[0] == 0 or way[0] != 1 for way in feature_involutions(cdist(FOUR_LEGS, FOUR_LEGS), unlike))


def test_unlike_distances_have_no_swap():
    line = np.array([[0.0], [3.0], [10.0]])
    assert feature_involutions(cdist(line, line), np.ones(3)) == []


def test_many_like_limbs_take_no_longer_than_a_moment():
    angle = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    star = np.column_stack([np.cos(angle), np.sin(angle)])
    ways = feature_involutions(cdist(star, star), np.ones(40))
    assert len(ways) <= 6
