from math import log2

import numpy as np
import pytest
from scipy.special import lpmv

from addon.evaluation import descriptor
from addon.evaluation.descriptor import harmonic_descriptor
from addon.evaluation.retrieval import precision_at_recall, retrieval
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
