from math import log2

import numpy as np
import pytest
from scipy.special import lpmv

from addon.evaluation import descriptor, pair_descriptor
from addon.evaluation.descriptor import harmonic_descriptor
from addon.evaluation.retrieval import precision_at_recall, retrieval, tier_lead
from tests.meshes import shapes

# six shapes on a line: three of class A, two of B, one alone
PLACES = np.array([0.0, 1.0, 5.0, 2.2, 6.5, 9.5])
CLASSES = ["A", "A", "A", "B", "B", "C"]
DISTANCES = np.abs(PLACES[:, None] - PLACES)


def test_measures_by_hand():
    # 0 sees A B A B C, 1 sees A B A B C, 2 sees B B A C A, 3 sees A A A B C, 4 sees A C B A A; 5 has nobody to look for
    third, fifth = 1 / log2(3), 1 / log2(5)
    found = retrieval(DISTANCES, CLASSES)
    assert found.queries == 5
    assert found.nearest_neighbour == pytest.approx((1 + 1 + 0 + 0 + 0) / 5)
    assert found.first_tier == pytest.approx((1 / 2 + 1 / 2 + 0 + 0 + 0) / 5)
    assert found.second_tier == pytest.approx((1 + 1 + 1 / 2 + 0 + 0) / 5)
    gains = [(1 + third) / 2, (1 + third) / 2, (third + fifth) / 2, 1 / log2(4), third]
    assert found.discounted_gain == pytest.approx(sum(gains) / 5)
    assert found.first_tiers == pytest.approx({"A": 1 / 3, "B": 0.0})
    perfect = retrieval(1.0 - np.equal.outer(CLASSES, CLASSES), CLASSES)
    assert tier_lead(perfect, found) == pytest.approx((5 / 6, np.std([2 / 3, 1], ddof=1) / np.sqrt(2)))
    assert np.isnan(tier_lead(perfect, retrieval(np.zeros((2, 2)), ["X", "Y"]))[0])


def test_precision_by_hand():
    # at half of the class: 0 and 1 have 1; 2 has 1/3, bettered by 2/5; 3 has 1/4; 4 has 1/3
    assert precision_at_recall(DISTANCES, CLASSES, 2) == pytest.approx(
        [(1 + 1 + 2 / 5 + 1 / 4 + 1 / 3) / 5, (2 / 3 + 2 / 3 + 2 / 5 + 1 / 4 + 1 / 3) / 5]
    )


def test_perfect_and_hopeless_retrieval():
    labels = ["A", "A", "B", "B"]
    near = 1.0 - np.equal.outer(labels, labels) * np.ones((4, 4))
    best = retrieval(near, labels)
    assert (best.nearest_neighbour, best.first_tier, best.second_tier, best.discounted_gain) == (1, 1, 1, 1)
    worst = retrieval(1 - near, labels)
    assert (worst.nearest_neighbour, worst.first_tier, worst.second_tier) == (0, 0, 0)
    assert np.isnan(retrieval(np.zeros((2, 2)), ["A", "B"]).nearest_neighbour)


def test_harmonics_are_those_of_scipy():
    rng = np.random.default_rng(0)
    direction = rng.normal(size=(50, 3))
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    ours = descriptor._harmonics(direction)
    degree, order = descriptor._degrees_and_orders()
    angle = np.arctan2(direction[:, 1], direction[:, 0])
    for column, (n, m) in enumerate(zip(degree, order, strict=True)):
        norm = np.sqrt((2 * n + 1) / (4 * np.pi) * np.prod(1.0 / np.arange(n - m + 1, n + m + 1)))
        np.testing.assert_allclose(
            ours[:, column], norm * lpmv(m, n, direction[:, 2]) * np.exp(1j * m * angle), atol=1e-10
        )


def test_the_descriptor_knows_the_shape_and_nothing_else(figure, sphere, rotation):
    vertices, faces = figure
    described = harmonic_descriptor(vertices, faces)
    moved = harmonic_descriptor(12.0 * vertices @ rotation + [3.0, 4.0, -1.0], faces)
    mirrored = harmonic_descriptor(vertices * [1.0, -1.0, 1.0], faces[:, ::-1])
    np.testing.assert_allclose(moved, described, atol=1e-9)
    np.testing.assert_allclose(mirrored, described, atol=1e-9)
    assert np.linalg.norm(described) == pytest.approx(1)
    other = harmonic_descriptor(*sphere)
    assert np.linalg.norm(other - described) > 0.3
    assert other.reshape(descriptor.SHELLS, descriptor.DEGREES)[:, 1:].max() < 0.02  # a sphere is of degree 0
    finer = harmonic_descriptor(*shapes.sphere(5))
    assert np.linalg.norm(other - finer) < 0.01


def test_pairs_know_the_shape_and_hardly_anything_else(figure, rotation):
    vertices, faces = figure
    described = pair_descriptor.pair_descriptor(vertices, faces)
    assert np.linalg.norm(described) == pytest.approx(1)
    moved = pair_descriptor.pair_descriptor(12.0 * vertices @ rotation + [3.0, 4.0, -1.0], faces)
    assert np.abs(moved**2 - described**2).sum() < 0.01  # pairs at the border of two intervals
    mirrored = pair_descriptor.pair_descriptor(vertices * [-1.0, 1.0, 1.0], faces[:, ::-1])
    shuffled = pair_descriptor.pair_descriptor(vertices, np.random.default_rng(0).permutation(faces))
    sampling = max(np.linalg.norm(each - described) for each in (mirrored, shuffled))  # other points, the same shape
    stretched = pair_descriptor.pair_descriptor(vertices * [1.0, 1.0, 1.5], faces)
    assert sampling < 0.5 * np.linalg.norm(stretched - described)


def test_pairs_on_a_sphere_are_those_of_the_formula():
    intervals = pair_descriptor.COSINES
    described = pair_descriptor.pair_descriptor(*shapes.sphere(5))
    cells = (described**2).reshape(pair_descriptor.DISTANCES, intervals, intervals, intervals)
    # the line between two points meets both normals at the cosine −d / 2r, whose square is even from 0 to 1
    assert cells[:, : intervals // 2, : intervals // 2].sum() == pytest.approx(1, abs=1e-3)
    assert cells.sum(axis=(0, 2, 3))[:2] == pytest.approx([3 / 4, 1 / 4], abs=0.02)
    assert cells.sum(axis=(0, 1, 2)) == pytest.approx(np.full(intervals, 1 / intervals), abs=0.02)  # normals: any
