"""Swaps of feature points."""

import numpy as np
from scipy.spatial.distance import cdist

from addon.core.symmetry.involutions import feature_involutions as ranked_involutions

FOUR_LEGS = np.array([[1.0, 3, 0], [-1, 3, 0], [1.2, -3, 0], [-1.2, -3, 0], [0, 5, 1], [0, -6, 1]])  # head, tail
SWAPPED = [1, 0, 3, 2, 4, 5]


def feature_involutions(distances, adf, **how):
    """The ways alone, of bodies of which no handedness is known."""
    return [way for way, _ in ranked_involutions(distances, np.zeros((len(adf),) * 3), adf, **how)]


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


def test_handedness_tells_a_mirror_image_from_a_body_whose_forelegs_alone_change_places():
    distances = cdist(FOUR_LEGS, FOUR_LEGS)
    distances[[0, 1, 2, 3], [2, 3, 0, 1]] = distances[[0, 1, 2, 3], [3, 2, 1, 0]] = 6.0  # beside and across alike
    handedness = np.zeros((6, 6, 6))
    for triple, value in (((0, 4, 1), 0.05), ((2, 4, 3), 0.05), ((0, 5, 3), 0.02), ((2, 5, 1), 0.02)):
        for turn in range(3):
            i, j, k = np.roll(triple, turn)
            handedness[i, j, k], handedness[i, k, j] = value, -value
    assert ranked_involutions(distances, handedness, np.ones(6))[0][0].tolist() == SWAPPED
    assert ranked_involutions(distances, handedness, np.ones(6))[0][1] < 0.0


def test_a_stride_that_twists_the_body_does_not_swap_the_legs_alone():
    hands, feet, head = (0, 1), (2, 3), 4
    distances = np.zeros((5, 5))  # of a scanned person with one arm stretched forward
    distances[np.triu_indices(5, 1)] = 1.21, 1.47, 1.47, 0.79, 1.56, 1.52, 0.79, 1.31, 1.38, 1.38
    handedness = np.zeros((5, 5, 5))
    for hand in hands:
        for foot in feet:  # the same after a half turn, reversed where one pair alone is swapped
            value = 0.018 if foot - hand == 2 else -0.018
            for turn in range(3):
                i, j, k = np.roll((hand, foot, head), turn)
                handedness[i, j, k], handedness[i, k, j] = value, -value
    adf = np.array([23.8, 23.0, 17.2, 16.9, 8.0])
    assert ranked_involutions(distances + distances.T, handedness, adf)[0][0].tolist() == [1, 0, 3, 2, 4]
