"""The one minimiser."""

from itertools import pairwise

import numpy as np
import pytest

from addon.core import CancelledError
from addon.core.run.monitor import Monitor
from addon.core.stress.majorisation import Majorisation
from addon.core.stress.pairs import AllPairs, Pairs


@pytest.fixture
def terms():
    """Three overlapping sets of pairs with random targets and weights, and a list of others, over 400 points."""
    rng = np.random.default_rng(3)
    made = []
    for low, high in ((0, 170), (160, 310), (290, 400)):
        count = high - low
        targets, weights = rng.uniform(0.2, 2, (2, count, count))
        made.append(AllPairs(rng.permutation(np.arange(low, high)), targets + targets.T, weights + weights.T, 400))
    ends = rng.permutation(400).reshape(-1, 2)
    return [*made, Pairs(ends, rng.uniform(1, 2, 200), 400).wanting_lengths(rng.uniform(1, 2, 200))]


def value_of(terms, points):
    return sum(term.stress(points) for term in terms)


START = np.random.default_rng(4).normal(size=(400, 3))


def test_a_step_solves_with_the_pseudo_inverse_of_v(terms):
    V = sum(term.laplacian() for term in terms).toarray()
    pulled = sum(term.pull(START) for term in terms)
    points, _ = Majorisation(terms).lowered(START, 1)
    expected = np.linalg.pinv(V) @ pulled
    np.testing.assert_allclose(points - points.mean(axis=0), expected, atol=1e-6)
    np.testing.assert_allclose(points.mean(axis=0), START.mean(axis=0), atol=1e-6)


@pytest.mark.parametrize("momentum", [False, True])
def test_stress_never_rises(terms, momentum):
    _, history = Majorisation(terms).lowered(START, 300, tolerance=0.0, momentum=momentum)
    assert len(history) > 100
    assert (np.diff(history) <= 1e-12 * history[:-1]).all()
    assert history[0] == pytest.approx(value_of(terms, START))


def test_every_plain_step_lowers_the_stress_by_what_majorisation_promises(terms):
    V = sum(term.laplacian() for term in terms)
    path = [Majorisation(terms).lowered(START, steps, momentum=False)[0] for steps in range(8)]
    for before, after in pairwise(path):
        step = after - before
        assert value_of(terms, before) - value_of(terms, after) >= (1 - 1e-6) * np.vdot(step, V @ step)


def test_momentum_gets_further_than_plain_steps(terms):
    plain, fast = (Majorisation(terms).lowered(START, 60, momentum=each)[0] for each in (False, True))
    least = Majorisation(terms).lowered(START, 2000, tolerance=1e-12)[1][-1]
    assert value_of(terms, fast) - least < 0.5 * (value_of(terms, plain) - least)


def test_it_stops_at_the_first_step_that_gains_less_than_the_tolerance(terms):
    history = Majorisation(terms).lowered(START, 2000, tolerance=1e-4, momentum=False)[1]
    gains = -np.diff(history) / history[:-1]
    assert gains[-1] < 1e-4 <= gains[:-1].min()


def test_all_steps_are_taken_and_nothing_is_watched_without_a_tolerance(terms):
    told = []
    points, history = Majorisation(terms).lowered(START, 5, monitor=Monitor(lambda done, _: told.append(done)))
    assert len(history) == 0
    assert told == [0.2, 0.4, 0.6, 0.8, 1.0]
    assert value_of(terms, points) < value_of(terms, START)


def test_an_anchor_holds_points_at_their_targets():
    pair = Pairs(np.array([[0, 1]]), np.ones(1), 2).wanting_lengths(np.array([2.0]))
    target = np.array([[0.0, 0, 0], [1, 0, 0]])
    for pull in (1e-3, 1.0, 1e3):
        points, history = Majorisation([pair], np.full(2, pull), target).lowered(target, 500, tolerance=1e-14)
        apart = points[1, 0] - points[0, 0]
        assert apart == pytest.approx((2 + pull / 2) / (1 + pull / 2), rel=1e-5)  # two springs against each other
        assert history[-1] == pytest.approx((2 - apart) ** 2 + pull * ((points - target) ** 2).sum())


def test_points_can_be_changed_after_each_step(terms):
    flat = Majorisation(terms).lowered(START, 9, after=lambda points, solve: points * [1.0, 1.0, 0.0])[0]
    assert (flat[:, 2] == 0).all()


def test_it_hears_a_cancel(terms):
    with pytest.raises(CancelledError):
        Majorisation(terms).lowered(START, 9, monitor=Monitor(cancelled=lambda: True))
