"""Closest points of a surface against every triangle, and against what is known."""

import numpy as np
import pytest

from addon.core import CancelledError
from addon.core.mesh.closest_points import closest_among, closest_points
from addon.core.run.monitor import Monitor
from tests.meshes import shapes


def test_the_points_of_a_sphere_are_straight_below():
    vertices, faces = shapes.sphere(4)
    wanted = np.random.default_rng(0).normal(size=(200, 3))
    wanted /= np.linalg.norm(wanted, axis=1)[:, None]
    found = closest_points(vertices, faces, 1.05 * wanted)
    at = np.einsum("ij,ijk->ik", found.weights, vertices[faces[found.faces]])
    np.testing.assert_allclose(at, wanted, atol=0.01)
    np.testing.assert_allclose(found.distances, 0.05, atol=0.01)


def test_they_are_the_closest_of_all_triangles():
    vertices, faces = shapes.figure(12)
    wanted = vertices[::7] + np.random.default_rng(1).normal(scale=0.1, size=vertices[::7].shape)
    every = np.tile(np.arange(len(faces)), (len(wanted), 1))
    exact = closest_among(vertices, faces, wanted, every)
    found = closest_points(vertices, faces, wanted)
    assert np.mean(found.distances <= exact.distances + 1e-12) > 0.99
    np.testing.assert_allclose(found.distances, exact.distances, atol=0.02)


def test_weights_are_barycentric_also_on_triangles_without_area():
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0]])
    found = closest_points(
        vertices, np.array([[0, 1, 2], [0, 1, 3]]), np.array([[1.5, -1, 0], [0.2, 0.2, 5], [-3, 0, 0]])
    )
    np.testing.assert_allclose(found.weights.sum(axis=1), 1)
    assert found.weights.min() >= 0
    np.testing.assert_allclose(found.distances, [1, 5, 3])


def test_many_points_are_found_in_parts_between_which_a_cancel_is_heard():
    vertices, faces = shapes.sphere(2)
    wanted = np.random.default_rng(2).normal(size=(5000, 3))
    found, last = closest_points(vertices, faces, wanted), closest_points(vertices, faces, wanted[4990:])
    np.testing.assert_array_equal(found.faces[4990:], last.faces)
    np.testing.assert_array_equal(found.weights[4990:], last.weights)
    assert len(closest_points(vertices, faces, wanted[:0]).faces) == 0
    asked = iter([False, False, True])
    with pytest.raises(CancelledError):
        closest_points(vertices, faces, wanted, Monitor(cancelled=lambda: next(asked)))
