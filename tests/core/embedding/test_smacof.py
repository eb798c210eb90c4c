"""Least-squares scaling of a full matrix of distances."""

import numpy as np
import pytest
from sklearn.manifold import smacof as sklearn_smacof

from addon.core.embedding.smacof import smacof


def cloud(count, dimensions, seed=0):
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(count, dimensions))
    return np.linalg.norm(points[:, None] - points, axis=2), rng.normal(size=(count, 3))


def test_plain_steps_are_those_of_scikit_learn():
    wanted, start = cloud(60, 5)
    theirs, stress = sklearn_smacof(
        wanted, n_components=3, init=start, n_init=1, max_iter=25, eps=0, normalized_stress=False
    )
    ours, history = smacof(wanted, start, max_iterations=25, tolerance=0.0, momentum=False)
    assert history.min() == pytest.approx(stress, rel=0.01)
    apart = [np.linalg.norm(x[:, None] - x, axis=2) for x in (ours, theirs)]
    assert np.abs(apart[0] - apart[1]).max() < 0.02 * apart[0].max()


def test_equal_weights_need_no_factorisation():
    wanted, start = cloud(60, 5)
    bare, weighted = (
        smacof(wanted, start, weights=weights, max_iterations=20, tolerance=0.0)
        for weights in (None, np.ones((60, 60)))
    )
    np.testing.assert_allclose(bare[0], weighted[0], atol=1e-5)
    np.testing.assert_allclose(bare[1], weighted[1], rtol=1e-6)


def test_it_stops_at_the_first_step_that_gains_less_than_a_millionth():
    wanted, start = cloud(60, 5, 8)
    history = smacof(wanted, start, max_iterations=2000, momentum=False)[1]
    gains = -np.diff(history) / history[:-1]
    assert gains[-1] < 1e-6 <= gains[:-1].min() < 1.2e-6


def test_distances_of_points_in_space_are_restored():
    wanted, start = cloud(40, 3, 5)
    fitted, history = smacof(wanted, start, max_iterations=5000, tolerance=1e-13)
    if history[-1] < 1e-6:  # else it ended in another minimum
        np.testing.assert_allclose(np.linalg.norm(fitted[:, None] - fitted, axis=2), wanted, atol=1e-3)
    assert history[-1] < 0.1 * history[0]
