"""Pairs of points, and what they want."""

import numpy as np
import pytest

from addon.core.stress.pairs import AllPairs, Pairs, length


@pytest.fixture
def listed():
    """Some pairs of 30 points with wanted lengths and weights."""
    rng = np.random.default_rng(0)
    ends = np.array([(i, j) for i in range(30) for j in range(i + 1, 30)])[::3]
    lengths, weight = rng.uniform(0.5, 2, (2, len(ends)))
    return Pairs(ends, weight, 30), lengths


@pytest.fixture
def every():
    """All pairs of 20 of 30 points, with random distances and weights."""
    rng = np.random.default_rng(3)
    chosen = rng.permutation(30)[:20]
    distances, weights = rng.uniform(0.2, 2, (2, 20, 20))
    return AllPairs(chosen, distances + distances.T, weights + weights.T, 30)


def test_lengths_are_a_stress_and_its_gradient(listed):
    pairs, lengths = listed
    points, way = np.random.default_rng(1).normal(size=(2, 30, 3))
    term = pairs.wanting_lengths(lengths)
    pulled, value = term.pull(points), term.stress(points)
    naive = sum(w * (t - np.linalg.norm(points[i] - points[j])) ** 2
                for (i, j), t, w in zip(pairs.ends, lengths, pairs.weight, strict=True))  # fmt: skip
    assert value == pytest.approx(naive, rel=1e-12)
    above, below = (term.stress(points + s * 1e-6 * way) for s in (1, -1))
    assert np.vdot(pulled - term.laplacian() @ points, way) == pytest.approx(-(above - below) / 4e-6, rel=1e-5)


def test_all_pairs_are_a_list_of_all_pairs(every):
    points = np.random.default_rng(1).normal(size=(30, 3))
    one, two = np.triu_indices(20, 1)
    listed = Pairs(np.column_stack([every.chosen[one], every.chosen[two]]), every.weights[one, two], 30)
    term = listed.wanting_lengths(every.distances[one, two])
    np.testing.assert_allclose(every.laplacian().toarray(), term.laplacian().toarray(), atol=1e-12)
    np.testing.assert_allclose(every.pull(points), term.pull(points), atol=1e-12)
    assert every.stress(points) == pytest.approx(term.stress(points), rel=1e-12)


def test_a_laplacian_is_the_quadratic_form_of_the_pairs(listed):
    pairs, _ = listed
    points = np.random.default_rng(1).normal(size=(30, 3))
    V = pairs.laplacian()
    assert np.vdot(points, V @ points) == pytest.approx(float(pairs.weight @ (pairs.apart(points) ** 2).sum(axis=1)))
    np.testing.assert_allclose(V.sum(axis=1), 0, atol=1e-12)


def test_sums_and_means_are_those_of_the_ends(listed):
    pairs, _ = listed
    values = np.random.default_rng(2).normal(size=(len(pairs.ends), 2))
    expected = np.zeros((30, 2))
    for (i, j), w, value in zip(pairs.ends, pairs.weight, values, strict=True):
        expected[i] += w * value
        expected[j] += w * value
    np.testing.assert_allclose(pairs.summed(values), expected, atol=1e-12)
    place = np.arange(30.0)[:, None]
    np.testing.assert_allclose(pairs.mean(place)[:, 0], pairs.ends.mean(axis=1))


def test_pairs_may_want_any_vector(listed):
    pairs, _ = listed
    points = np.random.default_rng(1).normal(size=(30, 3))
    term = pairs.wanting(lambda apart, _: apart)  # what they have
    assert term.stress(points) == 0
    np.testing.assert_allclose(term.pull(points), pairs.laplacian() @ points, atol=1e-12)


def test_points_that_coincide_do_not_divide_by_zero(listed, every):
    pairs, lengths = listed
    for term in (pairs.wanting_lengths(lengths), every):
        assert np.isfinite(term.stress(np.zeros((30, 3))))
        assert (term.pull(np.zeros((30, 3))) == 0).all()


def test_near_pairs_far_from_the_origin_are_measured_well():
    points = np.random.default_rng(2).uniform(-1, 1, (300, 3))
    points[1] = points[0] + [1e-5, 0, 0]
    pairs = AllPairs(np.arange(300), np.full((300, 300), 0.5), np.ones((300, 300)), 300)
    np.testing.assert_allclose(pairs.pull(points + 100.0), pairs.pull(points), atol=1e-5)


def test_a_length_is_never_0():
    np.testing.assert_array_equal(length(np.array([[3.0, 4, 0], [0, 0, 0]])), [5.0, 1e-12])
