"""Rigid fits, with and without matches, and which mirror image keeps the outside out."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from addon.core.deformation.elastic_body import ElasticBody
from addon.core.measures.alignment import closest_point_fit, closest_points_from, outside_out, rigid_fit
from addon.core.surface.delaunay import intrinsic_delaunay
from addon.core.surface.laplacian import stiffness_and_mass
from addon.core.surface.triangulation import triangulated


def test_closest_points_find_the_turn_that_brute_force_finds():
    rng = np.random.default_rng(0)
    points = rng.normal(size=(40, 3)) * [1.0, 2.0, 3.5]
    turn = Rotation.from_rotvec([0.4, 1.9, -2.0]).as_matrix()
    moved = points @ turn + [5.0, 1.0, -2.0]
    found, shift = closest_point_fit(points, moved)
    np.testing.assert_allclose(points @ found + shift, moved, atol=1e-6)
    noisy = moved + 0.05 * rng.normal(size=moved.shape)
    found, shift = closest_point_fit(points, noisy)
    tries = Rotation.random(4000, random_state=1).as_matrix()
    centre = points.mean(axis=0)

    def error(rotation, centred):
        placed = (points - centre) @ rotation + centred
        return (((placed[:, None] - noisy) ** 2).sum(axis=2).min(axis=1)).mean()

    best = min(error(rotation, noisy.mean(axis=0)) for rotation in tries)
    assert error(found, shift + centre @ found) <= best


def test_rigid_fit_recovers_a_motion_and_refuses_mirrors(rotation):
    points = np.random.default_rng(1).normal(size=(30, 3))
    turn, shift = rigid_fit(points, points @ rotation + [1, 2, 3])
    np.testing.assert_allclose(turn, rotation, atol=1e-12)
    np.testing.assert_allclose(shift, [1, 2, 3], atol=1e-12)
    mirrored = points * [1, 1, -1]
    assert np.linalg.det(rigid_fit(points, mirrored)[0]) == pytest.approx(1)
    assert np.linalg.det(rigid_fit(points, mirrored, mirror=True)[0]) == pytest.approx(-1)


def test_closest_points_find_a_half_turn():
    points = np.random.default_rng(1).normal(size=(300, 3)) * [4.0, 2.0, 1.0] + [1.0, 0, 0]
    turn, shift = closest_point_fit(points, points[::-1] * [-1, -1, 1] + [0, 9, 0])
    np.testing.assert_allclose(points @ turn + shift, points * [-1, -1, 1] + [0, 9, 0], atol=1e-6)


def test_a_mirror_image_is_told_apart(figure, rotation):
    vertices, faces = figure
    surface = intrinsic_delaunay(triangulated(vertices, faces))
    body = ElasticBody(*stiffness_and_mass(surface), vertices, faces)
    np.testing.assert_array_equal(outside_out(body, vertices @ rotation), vertices @ rotation)
    np.testing.assert_array_equal(outside_out(body, vertices * [1, -1, 1]), vertices * [1, -1, -1])


def test_closest_points_come_nearer_step_by_step(figure):
    vertices, _ = figure
    turn = Rotation.from_rotvec([0.15, -0.1, 0.2]).as_matrix()
    found, _, left = closest_points_from(vertices @ turn + 0.05, vertices, np.eye(3), np.zeros(3))
    np.testing.assert_allclose(found, turn.T, atol=1e-6)
    assert left < 1e-6
