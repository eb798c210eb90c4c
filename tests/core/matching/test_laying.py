"""Laying one form onto another."""

import numpy as np
import pytest
from scipy.spatial.distance import cdist

from addon.core.matching.assignments import feature_assignments
from addon.core.matching.laying import completed, laid_by_limbs, laid_by_vertices
from addon.core.measures.alignment import closest_points_from, rigid_fit
from addon.core.symmetry.limbs import limbs_of

QUARTER = np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]])


def limbs(points, adf=None):
    count = len(points)
    return limbs_of(
        cdist(points, points), np.zeros((count,) * 3), np.ones(count) if adf is None else adf,
        lambda: np.arange(float(count)),
    )  # fmt: skip


@pytest.fixture
def cloud():
    """A lopsided cloud of 60 points within a length of 1; the first five are its tips."""
    return np.random.default_rng(5).uniform(0, 1, (60, 3)) * [1.0, 0.6, 0.3]


def test_vertices_are_laid_by_least_squares_under_their_weights(cloud):
    weights = np.where(np.arange(60) < 30, 1.0, 1e-12)
    other = cloud @ QUARTER + [3.0, 0, 0]
    other[30:] += 5  # what weighs nothing may lie anywhere
    laying = laid_by_vertices(cloud, other, weights, np.arange(5), np.arange(5))
    np.testing.assert_allclose(laying.rotation, QUARTER, atol=1e-6)
    np.testing.assert_allclose(laying.shift, [3, 0, 0], atol=1e-6)
    assert laying.mismatch < 1e-4


def test_their_mismatch_is_the_weighted_root_mean_square(cloud):
    weights = np.linspace(1, 2, 60)
    other = cloud * [1.0, 1.5, 1]
    laying = laid_by_vertices(cloud, other, weights, np.arange(5), np.arange(5))
    rotation, shift = rigid_fit(cloud, other, weights)
    apart = np.linalg.norm(cloud @ rotation + shift - other, axis=1)
    assert laying.mismatch == pytest.approx(np.sqrt(np.average(apart**2, weights=weights)))


def test_feature_points_of_poses_are_the_same_where_they_are_near(cloud):
    order = np.array([4, 2, 0, 1])
    laying = laid_by_vertices(cloud, cloud, np.ones(60), np.arange(4), order)
    near = cdist(cloud[:4], cloud[order])
    expected = [int(np.flatnonzero(order == tip)[0]) if tip in order else -1 for tip in range(4)]
    found = laying.image.tolist()
    assert [found[tip] for tip in (0, 1, 2)] == expected[:3]
    assert found[3] in (-1, 0)
    assert (found[3] == 0) == (near[3, 0] < 0.25)


def test_limbs_lay_a_turned_body_back_and_tell_which_tip_is_which(cloud):
    order = np.array([3, 0, 4, 1, 2])
    thick = np.array([1.0, 1.1, 1.2, 1.3, 1.4])
    laying = laid_by_limbs(
        cloud @ QUARTER + 2, cloud, np.arange(5), order, limbs(cloud[:5], thick), limbs(cloud[order], thick[order])
    )
    assert order[laying.image].tolist() == [0, 1, 2, 3, 4]
    np.testing.assert_allclose((cloud @ QUARTER + 2) @ laying.rotation + laying.shift, cloud, atol=1e-6)
    assert laying.mismatch < 1e-6


def test_the_mismatch_is_that_of_the_tips_and_twice_the_distance_left(cloud):
    other = cloud * [1.0, 1.1, 0.8]
    own, others = limbs(cloud[:5]), limbs(other[:5])
    laying = laid_by_limbs(cloud, other, np.arange(5), np.arange(5), own, others)
    ways = []
    for image, mismatch in feature_assignments(own, others):
        known = np.flatnonzero(image >= 0)
        *motion, left = closest_points_from(cloud, other, *rigid_fit(cloud[known], other[image[known]]))
        ways.append((mismatch + 2 * left, motion))
    best = min(ways, key=lambda way: way[0])
    assert len(ways) > 1
    assert best[0] > 0.01
    assert laying.mismatch == pytest.approx(best[0])
    np.testing.assert_allclose(laying.rotation, best[1][0])
    np.testing.assert_allclose(laying.shift, best[1][1])


def test_the_surface_decides_where_tips_tie():
    """Four tips at the corners of a square say nothing of which is which; what lies between them does."""
    square = np.array([[1.0, 1, 0], [1, -1, 0], [-1, -1, 0], [-1, 1, 0]]) / 2
    between = np.array([[0.5, 0.2, 0.1], [0.5, 0.1, 0.2], [0.5, -0.3, 0.1], [-0.1, 0.5, 0.0], [-0.2, -0.1, 0.3]])
    form, tips = np.vstack([square, between]), np.arange(4)
    turned = form @ QUARTER @ QUARTER
    laying = laid_by_limbs(turned, form, tips, tips, limbs(square), limbs(square))
    np.testing.assert_allclose(turned @ laying.rotation + laying.shift, form, atol=1e-6)
    assert laying.image.tolist() == [0, 1, 2, 3]


def test_without_three_tips_the_principal_axes_lay_it(cloud):
    tips = np.arange(2)
    turned = cloud @ QUARTER + 1
    laying = laid_by_limbs(turned, cloud, tips, tips, limbs(cloud[:2]), limbs(cloud[:2]))
    np.testing.assert_allclose(turned @ laying.rotation + laying.shift, cloud, atol=1e-6)
    assert laying.image.tolist() == [0, 1]
    assert laying.mismatch < 1e-6
    stretched = cloud * [1.0, 1.3, 1]
    rough = laid_by_limbs(stretched, cloud, tips, tips, limbs(cloud[:2]), limbs(cloud[:2]))
    left = np.sqrt((cdist(stretched @ rough.rotation + rough.shift, cloud).min(axis=1) ** 2).mean())
    assert rough.mismatch == pytest.approx(2 * left)


def test_tips_without_their_like_get_the_nearest_one_left():
    others = np.array([[0.0, 0, 0], [0.2, 0, 0], [1, 0, 0], [5, 0, 0]])
    tips = np.array([[0.0, 0, 0], [0.05, 0, 0], [1.2, 0, 0], [5.3, 0, 0]])
    given = np.array([0, -1, -1, -1])
    assert completed(given, tips, others).tolist() == [0, 1, 2, -1]
    assert given.tolist() == [0, -1, -1, -1]


def test_tips_are_completed_as_a_whole_and_only_when_nearer_than_a_quarter():
    others = np.array([[0.0, 0, 0], [0.1, 0, 0]])
    tips = np.array([[0.06, 0, 0], [0.2, 0, 0]])  # the first is nearest to what the second needs
    assert completed(np.array([-1, -1]), tips, others).tolist() == [0, 1]
    assert completed(np.array([-1]), np.array([[0.25, 0, 0]]), others[:1]).tolist() == [-1]
    assert completed(np.array([-1]), np.array([[0.2499, 0, 0]]), others[:1]).tolist() == [0]
