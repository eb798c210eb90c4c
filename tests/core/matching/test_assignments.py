"""Which feature point is which on another surface."""

import numpy as np
import pytest
from scipy.spatial.distance import cdist

from addon.core.matching import assignments
from addon.core.matching.assignments import MOST_FEATURES, feature_assignments
from addon.core.symmetry.limbs import limbs_of, sided

FOUR_LEGS = np.array([[1.0, 3, 0], [-1, 3, 0], [1.2, -3, 0], [-1.2, -3, 0], [0, 5, 1], [0, -6, 1]]) / 5


def limbs(points, adf=None, handedness=None):
    return limbs_among(cdist(points, points), adf, handedness)


def limbs_among(distances, adf=None, handedness=None):
    count = len(distances)
    flat = np.zeros((count,) * 3) if handedness is None else handedness
    return limbs_of(distances, flat, np.ones(count) if adf is None else adf, lambda: np.arange(float(count)))


def volumes(points):
    """The handedness of a body whose functions are its coordinates along each point: signed volumes."""
    return np.linalg.det(points[np.indices((len(points),) * 3).transpose(1, 2, 3, 0)])


def test_points_in_another_order_are_found_again():
    order = np.array([3, 5, 0, 2, 4, 1])
    thick = np.array([2.0, 2.1, 3, 3.1, 1, 4])
    image, mismatch = feature_assignments(
        limbs(FOUR_LEGS, thick, volumes(FOUR_LEGS)), limbs(FOUR_LEGS[order], thick[order], volumes(FOUR_LEGS[order]))
    )[0]
    assert order[image].tolist() == [0, 1, 2, 3, 4, 5]
    assert mismatch < 1e-9


def test_handedness_decides_where_distances_tie():
    mirrored = FOUR_LEGS[[1, 0, 3, 2, 4, 5]]  # the same distances with left and right exchanged
    best, next_best = feature_assignments(
        limbs(FOUR_LEGS, None, volumes(FOUR_LEGS)), limbs(mirrored, None, volumes(mirrored))
    )[:2]
    assert best[0].tolist() == [1, 0, 3, 2, 4, 5]
    assert best[1] < next_best[1] - 0.02


def test_a_missing_limb_is_left_out_and_the_others_stay():
    image, mismatch = feature_assignments(limbs(FOUR_LEGS), limbs(FOUR_LEGS[[0, 2, 3, 4, 5]]))[0]
    assert sorted(image[image >= 0].tolist()) == [0, 1, 2, 3, 4]
    assert image[4] == 3
    assert mismatch < 0.1


def test_bodies_of_another_kind_have_no_way_or_a_bad_one():
    line = np.arange(6.0)[:, None] * [1.0, 0, 0]
    ways = feature_assignments(limbs(FOUR_LEGS), limbs(line))
    assert not ways or ways[0][1] > 0.1


def test_dozens_of_like_limbs_take_no_longer_than_a_moment():
    angle = np.linspace(0, 2 * np.pi, 30, endpoint=False)
    star = limbs(np.column_stack([np.cos(angle), np.sin(angle), 0 * angle]))
    assert len(feature_assignments(star, star)) <= 6


def test_a_narrow_beam_keeps_the_least_sum_of_squares(monkeypatch):
    monkeypatch.setattr(assignments, "_BEAM", 1)
    own = np.ones((3, 3)) - np.eye(3)
    others = np.ones((4, 4)) - np.eye(4)
    others[2, :2] = others[:2, 2] = 1.075  # two changes: .01125
    others[3, 0] = others[0, 3] = 1.1  # one: .01
    found = feature_assignments(*(limbs_among(far) for far in (own, others)))
    assert [ways.tolist() for ways, _ in found] == [[0, 1, 3]]


def test_thickness_that_differs_speaks_against_an_assignment():
    even = np.ones(6)
    mismatches = [feature_assignments(limbs(FOUR_LEGS, even), limbs(FOUR_LEGS, f * even))[0][1] for f in (1, 1.1, 1.2)]
    assert mismatches[0] < 1e-9
    np.testing.assert_allclose(mismatches, 0.1 * np.log([1, 1.1, 1.2]), atol=1e-9)


def test_between_like_ways_thickness_decides():
    thick = np.array([1.0, 1.2, 1.0, 1.2, 1, 1])
    mirrored = [1, 0, 3, 2, 4, 5]
    image, _ = feature_assignments(limbs(FOUR_LEGS, thick), limbs(FOUR_LEGS[mirrored], thick[mirrored]))[0]
    assert image.tolist() == mirrored


@pytest.mark.parametrize(("own", "others", "ways"), [(0, 3, 0), (3, 0, 0), (0, 0, 0), (1, 1, 1), (1, 3, 3), (3, 1, 3)])
def test_few_points_on_either_side(own, others, ways):
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0]])
    one, other = (limbs(points[: max(count, 1)]).sorted_by(np.arange(count)) for count in (own, others))
    found = feature_assignments(one, other)
    assert len([image for image, _ in found if (image >= 0).any()]) == ways


def test_too_many_points_are_not_assigned():
    points = np.random.default_rng(0).normal(size=(MOST_FEATURES + 1, 3))
    assert feature_assignments(limbs(points), limbs(points[:5])) == []
    assert feature_assignments(limbs(points[:5]), limbs(points)) == []
    assert feature_assignments(limbs(points[:5]), limbs(points[:-1])) != []
    assert feature_assignments(limbs(points[:-1]), limbs(points[:5])) != []


def test_left_and_right_of_the_same_body_are_the_same():
    raised = FOUR_LEGS + np.array([0, 0, 0.3])
    own = limbs(raised, np.array([2.0, 2, 3, 3, 1, 4]), volumes(raised))
    assert sided(own.handedness, own.side, own.along) > 0.1
    assert feature_assignments(own, own)[0][1] < 1e-9


def test_handedness_that_differs_speaks_against_an_assignment():
    """A body and its mirror image, point by point: handedness counts four times, that of all pairs once and a half."""
    raised = FOUR_LEGS + np.array([0, 0, 0.3])
    own = limbs(raised, np.array([2.0, 2, 3, 3, 1, 4]), volumes(raised))
    every = feature_assignments(own, own._replace(handedness=-own.handedness), most=500)
    mismatch = next(each for image, each in every if (image == np.arange(6)).all())
    expected = 4 * 2 * np.sqrt((own.handedness**2).mean())
    assert mismatch == pytest.approx(expected + 1.5 * 2 * sided(own.handedness, own.side, own.along))
