"""Classical scaling, of all pairs and of landmarks, and least squares from there."""

import numpy as np

from addon.core.embedding.classical_scaling import (
    classical_scaling,
    landmark_scaling,
    leading_scaling,
    placed_around,
)


def test_classical_scaling_recovers_points_from_their_distances():
    points = np.random.default_rng(0).normal(size=(50, 3)) * [3.0, 2.0, 1.0]
    wanted = np.linalg.norm(points[:, None] - points, axis=2)
    embedding, values = classical_scaling(wanted)
    np.testing.assert_allclose(np.linalg.norm(embedding[:, None] - embedding, axis=2), wanted, atol=1e-10)
    assert np.abs(values[3:]).max() < 1e-10 * values[0]


def test_landmark_scaling_places_the_rest():
    points = np.random.default_rng(0).normal(size=(80, 3)) * [3.0, 2.0, 1.0]
    wanted = np.linalg.norm(points[:, None] - points, axis=2)
    embedding = landmark_scaling(wanted[:, :9], np.arange(9))
    np.testing.assert_allclose(np.linalg.norm(embedding[:, None] - embedding, axis=2), wanted, atol=1e-9)
    np.testing.assert_allclose(embedding[:9], classical_scaling(wanted[:9, :9])[0], atol=1e-9)


def test_landmark_scaling_of_a_plane_is_flat():
    points = np.random.default_rng(0).normal(size=(40, 3)) * [3.0, 2.0, 0.0]
    wanted = np.linalg.norm(points[:, None] - points, axis=2)
    embedding = landmark_scaling(wanted[:, :8], np.arange(8))
    assert np.abs(embedding[:, 2]).max() < 1e-5
    np.testing.assert_allclose(np.linalg.norm(embedding[:, None] - embedding, axis=2), wanted, atol=1e-5)


def test_the_leading_axes_are_those_of_all_whatever_the_size_and_the_same_each_time():
    points = np.random.default_rng(2).normal(size=(450, 3)) * [0.03, 0.02, 0.01]
    wanted = np.linalg.norm(points[:, None] - points, axis=2)
    embedding = leading_scaling(wanted)
    np.testing.assert_allclose(np.linalg.norm(embedding[:, None] - embedding, axis=2), wanted, atol=1e-9)
    whole, _ = classical_scaling(wanted)
    signs = np.sign((embedding * whole).sum(axis=0))
    np.testing.assert_allclose(embedding * signs, whole, atol=1e-9)
    np.testing.assert_array_equal(leading_scaling(wanted), embedding)


def test_up_to_four_hundred_points_all_axes_are_computed():
    points = np.random.default_rng(3).normal(size=(401, 3))
    wanted = np.linalg.norm(points[:, None] - points, axis=2)
    np.testing.assert_array_equal(leading_scaling(wanted[:400, :400]), classical_scaling(wanted[:400, :400])[0])
    assert (leading_scaling(wanted) != classical_scaling(wanted)[0]).any()


def test_axes_that_are_none_have_no_length():
    """Points on a line have one axis."""
    line = np.linspace(0, 1, 450)
    embedding = leading_scaling(np.abs(line[:, None] - line))
    assert np.ptp(embedding[:, 0]) > 0.99
    assert np.abs(embedding[:, 1:]).max() < 1e-6


def test_placing_around_landmarks_does_not_depend_on_the_unit():
    points = np.random.default_rng(6).normal(size=(40, 3))
    distances = np.linalg.norm(points[:, None] - points[:6], axis=2)
    start, fixed = points + 0.3, points[:6] * 1.1
    placed = placed_around(distances, np.arange(6), fixed, start, steps=2)
    for unit in (1e-4, 1e4):
        scaled = placed_around(unit * distances, np.arange(6), unit * fixed, unit * start, steps=2)
        np.testing.assert_allclose(scaled, unit * placed, rtol=1e-9)
