"""The sampled stress: pairs of a few samples with everybody, its V⁺, and where the samples lie."""

import numpy as np
import pytest

from addon.core.monitor import Monitor
from addon.core.pairs import balanced, patch_geodesics, spread_samples
from addon.core.smacof import minimise_stress
from addon.core.spectrum import Spectrum
from addon.core.stress import CrossPairs, Stress, pair_set
from addon.core.surface import triangulated
from addon.core.weight_inverse import SampledWeightInverse
from tests.sample import shapes


@pytest.fixture
def sets():
    """Two overlapping patches with samples, and a set of pairs between them."""
    rng = np.random.default_rng(5)
    parts = (np.arange(0, 40), np.arange(35, 70))
    cross = []
    for part in parts:
        rows = part[::5]
        weights = rng.random((len(rows), len(part)))
        weights[np.arange(len(rows)), np.searchsorted(part, rows)] = 0.0
        cross.append(CrossPairs(rows, part, rng.random(weights.shape) + 0.5, weights))
    between = np.array([0, 33, 50, 66])
    distances = rng.random((4, 4))
    pairs = pair_set(between, distances + distances.T, lambda rows, columns, target: np.full_like(target, 0.7))
    return cross, [pairs]


def dense(cross, pairs, count):
    matrix = np.zeros((count, count))
    for each in cross:
        for row, weights in zip(each.rows, each.weights, strict=True):
            matrix[row, each.columns] -= weights
            matrix[each.columns, row] -= weights
    for each in pairs:
        matrix[np.ix_(each.vertices, each.vertices)] += each.laplacian() - np.diag(np.diag(each.laplacian()))
    np.fill_diagonal(matrix, 0)
    np.fill_diagonal(matrix, -matrix.sum(axis=1))
    return matrix


def test_stress_is_the_sum_pair_by_pair(sets):
    cross, pairs = sets
    points = np.random.default_rng(1).normal(size=(70, 3))
    total = 0.0
    for each in cross:
        for i, row in enumerate(each.rows):
            for j, column in enumerate(each.columns):
                apart = np.linalg.norm(points[row] - points[column])
                total += each.weights[i, j] * (each.targets[i, j] - apart) ** 2 if row != column else 0.0
    total += Stress(70, pairs).value(points)
    assert Stress(70, pairs, cross=cross).value(points) == pytest.approx(total, rel=1e-12)


def test_the_pull_is_minus_half_the_gradient(sets):
    cross, pairs = sets
    stress = Stress(70, pairs, cross=cross)
    points = np.random.default_rng(2).normal(size=(70, 3))
    way = np.random.default_rng(3).normal(size=(70, 3))
    slope = (stress.value(points + 1e-6 * way) - stress.value(points - 1e-6 * way)) / 2e-6
    assert slope == pytest.approx(-2 * np.vdot(stress.value_and_pull(points)[1], way), rel=1e-5)


def test_the_inverse_is_the_pseudo_inverse(sets):
    cross, pairs = sets
    right = np.random.default_rng(4).normal(size=(70, 3))
    right -= right.mean(axis=0)
    expected = np.linalg.pinv(dense(cross, pairs, 70)) @ right
    np.testing.assert_allclose(SampledWeightInverse(70, cross, pairs)(right), expected, atol=1e-9)


def test_the_stress_never_rises(sets):
    cross, pairs = sets
    start = np.random.default_rng(6).normal(size=(70, 3))
    inverse = SampledWeightInverse(70, cross, pairs)
    for extrapolation in (0, 6):
        _, history = minimise_stress(Stress(70, pairs, cross=cross), inverse, start, 60, 0.0, extrapolation)
        assert (np.diff(history) <= 1e-12 * history[:-1]).all()
        assert history[-1] < 0.5 * history[0]


def test_balanced_pairs_have_their_share(sets):
    cross, pairs = sets
    scaled = balanced(pairs[0], cross, 70, 0.25)
    held = -dense(cross, [], 70)[pairs[0].vertices].clip(max=0).sum()
    assert scaled.total_weights().sum() == pytest.approx(0.25 * held)


def test_samples_are_spread_and_start_where_asked():
    angle = 2 * np.pi * np.arange(100) / 100
    spectrum = Spectrum(np.array([1.0, 1.0]), np.column_stack([np.cos(angle), np.sin(angle)]))
    samples = spread_samples(spectrum, np.arange(100), 7, 4)
    assert samples[0] == 7
    assert sorted((samples - 7) % 100) == [0, 25, 50, 75]
    assert len(spread_samples(spectrum, np.arange(3), 0, 10)) == 3


def test_smoothed_geodesics_are_plain_near_and_positive():
    vertices, faces = shapes.grid(41, 41, 1.0, 1.0)
    surface = triangulated(vertices, faces)
    sources = np.array([0, 840])
    plain = patch_geodesics(surface, sources, None, Monitor())
    smooth = patch_geodesics(surface, sources, 0.1, Monitor())
    true = np.linalg.norm(vertices[sources][:, None] - vertices[None], axis=2)
    assert (np.abs(plain - true)[true > 0] / true[true > 0]).mean() < 0.03
    assert (smooth[true > 0] > 0).all()
    assert np.corrcoef(smooth.ravel(), true.ravel())[0, 1] > 0.97
