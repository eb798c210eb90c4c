from itertools import pairwise

import numpy as np
import pytest
from sklearn.manifold import smacof as sklearn_smacof

from addon.core import CancelledError
from addon.core.embedding.smacof import minimise_stress, smacof, unit_smacof
from addon.core.embedding.stress import Stress, pair_set
from addon.core.embedding.weight_inverse import WeightInverse
from addon.core.run.monitor import Monitor


@pytest.fixture
def sets():
    """Three overlapping sets of pairs with random targets and weights over 400 points."""
    rng = np.random.default_rng(3)
    made = []
    for low, high in ((0, 170), (160, 310), (290, 400)):
        members = rng.permutation(np.arange(low, high))
        targets, weights = rng.uniform(0.2, 2, (2, len(members), len(members)))
        made.append((members, targets, weights))
    return made


def pair_sets(sets):
    return [pair_set(members, targets, tiles_of(weights)) for members, targets, weights in sets]


def tiles_of(weights):
    return lambda rows, columns, _: weights[rows, columns]


def naive_stress(sets, points):
    total = 0.0
    for members, targets, weights in sets:
        for i in range(len(members)):
            for j in range(i + 1, len(members)):
                apart = np.linalg.norm(points[members[i]] - points[members[j]])
                total += weights[i, j] * (targets[i, j] - apart) ** 2
    return total


def dense_v(sets, count):
    v = np.zeros((count, count))
    for members, _, weights in sets:
        upper = np.triu(weights, 1)
        v[np.ix_(members, members)] -= upper + upper.T
    np.fill_diagonal(v, -v.sum(axis=1))
    return v


def test_stress_equals_the_sum_over_pairs(sets):
    points = np.random.default_rng(0).normal(size=(400, 3))
    assert Stress(400, pair_sets(sets)).value(points) == pytest.approx(naive_stress(sets, points), rel=1e-12)


def test_pull_is_minus_half_the_gradient(sets):
    rng = np.random.default_rng(0)
    points, direction = rng.normal(size=(2, 400, 3))
    stress = Stress(400, pair_sets(sets))
    slope = (stress.value(points + 1e-5 * direction) - stress.value(points - 1e-5 * direction)) / 2e-5
    assert -2 * np.vdot(stress.value_and_descent(points)[1], direction) == pytest.approx(slope, rel=1e-6)


@pytest.mark.parametrize("counts", [(700, 420), (420, 700), (3,)])
def test_sets_of_any_size_share_the_working_memory(counts):
    """Tiles of a smaller set may be larger than those of a larger one."""
    rng = np.random.default_rng(1)
    points = rng.normal(size=(max(counts), 3))
    sets = []
    for count in counts:
        one = np.ones((count, 1))
        sets.append(pair_set(np.arange(count), one * one.T, lambda rows, columns, target: np.ones_like(target)))
    expected = 0.0
    for count in counts:
        for row in range(count):
            expected += ((1 - np.linalg.norm(points[row + 1 : count] - points[row], axis=1)) ** 2).sum()
    assert Stress(max(counts), sets).value(points) == pytest.approx(expected, rel=1e-11)


def test_coinciding_points_do_not_divide_by_zero(sets):
    value, pull = Stress(400, pair_sets(sets)).value_and_descent(np.zeros((400, 3)))
    assert np.isfinite(value)
    assert (pull == 0).all()


@pytest.mark.parametrize("size", [1e-9, 1.0, 1e9])
def test_points_that_coincide_do_not_pull_at_each_other(size):
    points = np.array([[0.1, 0.2, 0], [0.7, 0.9, 0], [0.1, 0.2, 0], [0.3, -0.8, 0.4], [0.7, 0.9, 0]])
    ones = np.ones((5, 5))
    stress = Stress(5, [pair_set(np.arange(5), size * ones, lambda rows, columns, _: ones[rows, columns])])
    value, pull = stress.value_and_descent(size * points)
    apart = points[:, None] - points
    distance = np.linalg.norm(apart, axis=2)
    missing = (1 - distance)[np.triu_indices(5, 1)]
    distance[distance == 0] = 1  # which pulls at nothing
    np.testing.assert_allclose(pull / size, ((1 / distance - 1)[:, :, None] * apart).sum(axis=1), atol=1e-12)
    assert value / size**2 == pytest.approx((missing**2).sum())


def test_near_pairs_far_from_the_origin_are_measured_well():
    rng = np.random.default_rng(2)
    points = rng.uniform(-1, 1, (300, 3))
    points[1] = points[0] + [1e-5, 0, 0]
    wanted = np.full((300, 300), 0.5)
    pairs = [pair_set(np.arange(300), wanted, lambda rows, columns, _: np.ones_like(wanted[rows, columns]))]
    away = points - points[:, None]  # x_j - x_i
    apart = np.linalg.norm(away, axis=2) + np.eye(300)
    expected = -((0.5 / apart - 1) * (1 - np.eye(300)))[:, :, None] * away
    for shift in (0.0, 100.0):
        pull = Stress(300, pairs).value_and_descent(points + shift)[1]
        np.testing.assert_allclose(pull, expected.sum(axis=1), atol=1e-5)
    points[1] = points[0]
    pull = Stress(300, pairs).value_and_descent(points)[1]
    assert np.abs(pull[0] - pull[1]).max() < 1e-9


def test_block_elimination_is_the_pseudo_inverse(sets):
    right = np.random.default_rng(1).normal(size=(400, 3))
    right -= right.mean(axis=0)
    expected = np.linalg.pinv(dense_v(sets, 400)) @ right
    np.testing.assert_allclose(WeightInverse(400, pair_sets(sets))(right), expected, atol=1e-10)


def test_one_set_alone_has_its_pseudo_inverse_too(sets):
    alone = sets[:1]
    right = np.random.default_rng(1).normal(size=(170, 3))
    right -= right.mean(axis=0)
    expected = np.linalg.pinv(dense_v(alone, 170)) @ right
    np.testing.assert_allclose(WeightInverse(170, pair_sets(alone))(right), expected, atol=1e-10)


@pytest.mark.parametrize("extrapolation", [0, 6])
def test_stress_never_rises(sets, extrapolation):
    start = np.random.default_rng(4).normal(size=(400, 3))
    made = pair_sets(sets)
    _, history = minimise_stress(
        Stress(400, made), WeightInverse(400, made), start, tolerance=0.0, extrapolation=extrapolation
    )
    assert len(history) > 100
    assert (np.diff(history) <= 1e-12 * history[:-1]).all()


@pytest.mark.parametrize("extrapolation", [0, 6])
def test_every_step_lowers_the_stress_by_what_majorisation_promises(sets, extrapolation):
    made = pair_sets(sets)
    stress, inverse = Stress(400, made), WeightInverse(400, made)
    here = np.random.default_rng(4).normal(size=(400, 3))
    options = {"tolerance": 0.0, "extrapolation": extrapolation}
    points = [minimise_stress(stress, inverse, here, max_iterations=steps, **options)[0] for steps in range(12)]
    for before, after in pairwise(points):
        value, pull = stress.value_and_descent(before)
        assert value - stress.value(after) >= (1 - 1e-9) * np.vdot(inverse(pull), pull)


def test_extrapolation_gets_further_than_plain_steps():
    rng = np.random.default_rng(8)
    cloud = rng.normal(size=(120, 3))
    wanted = np.linalg.norm(cloud[:, None] - cloud, axis=2) * rng.uniform(0.7, 1.3, (120, 120))
    wanted = (wanted + wanted.T) / 2
    start = rng.normal(size=(120, 3))
    plain = smacof(wanted, start, max_iterations=60, tolerance=0.0, extrapolation=0)[1]
    fast = smacof(wanted, start, max_iterations=60, tolerance=0.0)[1]
    longest = smacof(wanted, start, max_iterations=2000, tolerance=1e-13, extrapolation=0)[1][-1]
    assert fast[-1] - longest < 0.2 * (plain[-1] - longest)


@pytest.mark.parametrize("fit", [smacof, unit_smacof])
def test_it_stops_at_the_first_step_that_gains_less_than_a_millionth(fit):
    rng = np.random.default_rng(8)
    cloud = rng.normal(size=(60, 5))
    wanted = np.linalg.norm(cloud[:, None] - cloud, axis=2)
    history = fit(wanted, rng.normal(size=(60, 3)), max_iterations=2000, extrapolation=0)[1]
    gains = -np.diff(history) / history[:-1]
    assert gains[-1] < 1e-6 <= gains[:-1].min() < 1.2e-6


def test_plain_steps_are_those_of_scikit_learn():
    rng = np.random.default_rng(0)
    cloud = rng.normal(size=(60, 5))
    wanted = np.linalg.norm(cloud[:, None] - cloud, axis=2)
    start = rng.normal(size=(60, 3))
    theirs, stress = sklearn_smacof(
        wanted, n_components=3, init=start, n_init=1, max_iter=25, eps=0, normalized_stress=False
    )
    ours, history = smacof(wanted, start, max_iterations=25, tolerance=0.0, extrapolation=0)
    assert history.min() == pytest.approx(stress, rel=0.01)
    apart = [np.linalg.norm(x[:, None] - x, axis=2) for x in (ours, theirs)]
    assert np.abs(apart[0] - apart[1]).max() < 0.02 * apart[0].max()


def test_it_hears_a_cancel(sets):
    made = pair_sets(sets)
    with pytest.raises(CancelledError):
        WeightInverse(400, made, Monitor(cancelled=lambda: True))


def test_v_of_many_tiles_is_that_of_the_weights():
    rng = np.random.default_rng(4)
    weights = rng.uniform(size=(700, 700))
    members = rng.permutation(900)[:700]
    pairs = pair_set(members, np.ones((700, 700)), lambda rows, columns, _: weights[rows, columns])
    assert len(pairs.weights) > 3
    upper = np.triu(weights, 1) + np.triu(weights, 1).T
    np.testing.assert_allclose(pairs.laplacian()[0], np.diag(upper.sum(axis=1)) - upper, atol=1e-12)
    np.testing.assert_allclose(pairs.scaled(2.0).laplacian()[0], 2 * pairs.laplacian()[0], atol=1e-11)


def test_the_tolerance_decides_where_it_ends():
    points = np.random.default_rng(4).normal(size=(40, 6))  # which do not fit into space
    wanted = np.linalg.norm(points[:, None] - points, axis=2)
    start = np.random.default_rng(5).normal(size=(40, 3))
    for method in (smacof, unit_smacof):
        steps = [len(method(wanted, start, tolerance=tolerance, max_iterations=60)[1]) for tolerance in (0.5, 1e-3, 0)]
        assert steps[0] < steps[1] < steps[2]
    history = smacof(wanted, start, tolerance=1e-3)[1]
    drops = -np.diff(history) / history[:-1]
    assert (drops[:-1] >= 1e-3).all()
    assert drops[-1] < 1e-3
