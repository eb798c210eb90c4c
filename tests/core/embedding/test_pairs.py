"""The pairs between the patches."""

import numpy as np
import pytest

from addon.core.embedding.pairs import arrangement_pairs, balanced
from addon.core.embedding.stress import pair_set


def test_the_arrangement_weighs_its_share_of_what_the_patches_weigh():
    rng = np.random.default_rng(0)
    points = rng.normal(size=(300, 3))
    weights = rng.uniform(0, 1, (200, 200))
    patches = [
        pair_set(members, np.ones((200, 200)), lambda rows, columns, _: weights[rows, columns])
        for members in (np.arange(200), np.arange(100, 300))
    ]
    landmarks = np.array([3, 250, 150, 120])
    pairs = balanced(arrangement_pairs(landmarks, points), patches, 300, 0.7)
    held = np.zeros(300)
    for patch in patches:
        held[patch.vertices] += patch.total_weights()
    assert pairs.total_weights().sum() == pytest.approx(0.7 * held[landmarks].sum())
    apart = np.linalg.norm(points[landmarks][:, None] - points[landmarks], axis=2)
    np.testing.assert_allclose(np.triu(pairs.targets[0]), np.triu(apart))
    assert np.ptp(pairs.weights[0][np.triu_indices(4, 1)]) == 0


def test_an_arrangement_of_one_landmark_has_no_weight_to_scale():
    patch = pair_set(np.arange(3), np.ones((3, 3)), lambda rows, columns, target: np.ones_like(target))
    nothing = arrangement_pairs(np.array([1]), np.zeros((3, 3)))
    assert balanced(nothing, [patch], 3, 0.5) is nothing


def test_replaced_pairs_are_those_of_all_tiles_and_leave_the_rest():
    rng = np.random.default_rng(2)
    count = 500  # five tiles
    wanted, heavy = (np.triu(each, 1) for each in rng.uniform(1, 2, (2, count, count)))
    before = pair_set(np.arange(count), wanted, lambda rows, columns, _: heavy[rows, columns])
    pairs = np.unique(np.sort(rng.choice(count, (400, 2)), axis=1), axis=0)
    pairs = pairs[pairs[:, 0] < pairs[:, 1]]
    pairs = rng.permutation(pairs[(pairs[:, 0] < 100) | (pairs[:, 0] > 250)])  # some tiles stay as they are
    targets, weights = rng.uniform(3, 4, (2, len(pairs)))
    after = before.replaced(pairs, targets, weights)
    wanted, heavy = wanted.copy(), heavy.copy()
    wanted[tuple(pairs.T)], heavy[tuple(pairs.T)] = targets, weights
    start, shared = 0, 0
    for old, target, weight in zip(before.targets, after.targets, after.weights, strict=True):
        rows = slice(start, start + len(target))
        np.testing.assert_array_equal(np.triu(target, 1), np.triu(wanted[rows, start:], 1))
        np.testing.assert_array_equal(weight, np.triu(heavy[rows, start:], 1))
        start += len(target)
        shared += target is old
    assert start == count
    assert 0 < shared < len(after.targets)
