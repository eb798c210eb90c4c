"""The elastic body, its rotations, and the detail pass."""

import numpy as np
import pytest

from addon.core.deformation.elastic_body import ElasticBody
from addon.core.deformation.rotations import nearest_rotations
from addon.core.measures.form_measures import (
    compactness_error,
    edge_stretch,
)
from addon.core.mesh.geometry import moved_by_frames
from addon.core.surface.delaunay import intrinsic_delaunay
from addon.core.surface.laplacian import stiffness_and_mass
from addon.core.surface.triangulation import triangulated
from addon.core.surface.working_surface import working_surface
from tests.meshes.shapes import prepared


def by_singular_values(covariances):
    left, _, right = np.linalg.svd(covariances)
    left[:, :, -1] *= np.sign(np.linalg.det(left @ right))[:, None]
    return left @ right


def test_nearest_rotations_are_those_of_the_singular_values(rotation):
    rng = np.random.default_rng(2)
    many = rng.normal(size=(3000, 3, 3)) * 10.0 ** rng.uniform(-6, 6, (3000, 1, 1))
    flat = many[:500] * [1.0, 1.0, 0.0]
    nearly_flat = many[:500] * [1.0, 1.0, 1e-4]
    turns = np.linalg.qr(rng.normal(size=(2, 2000, 3, 3)))[0]
    values = np.column_stack([np.ones(2000), rng.uniform(0.2, 1, 2000), np.zeros(2000)])
    values[:, 2] = -values[:, 1] + 10.0 ** rng.uniform(-7, -1, 2000)  # two rotations fit almost as well
    close = turns[0] * values[:, None] @ turns[1]
    for given in (many, flat, nearly_flat, close, rotation[None], -rotation[None], 1e-160 * many, 1e150 * many):
        found = nearest_rotations(given)
        np.testing.assert_allclose(found @ found.transpose(0, 2, 1), np.tile(np.eye(3), (len(given), 1, 1)), atol=1e-9)
        fits = [np.einsum("nij,nij->n", turn, given) for turn in (found, by_singular_values(given))]
        given = given / np.abs(given).max(axis=(1, 2), keepdims=True)
        size = np.linalg.norm(given, axis=(1, 2))
        np.testing.assert_allclose(fits[0] / size, fits[1] / size, atol=1e-9)
        assert (np.linalg.det(found) > 0).all()
    np.testing.assert_allclose(nearest_rotations(7 * rotation[None])[0], rotation, atol=1e-12)


def test_rotations_that_nothing_tells_are_still_rotations():
    degenerate = np.stack([np.zeros((3, 3)), np.outer([1.0, 2, 3], [3.0, 1, 2]), -np.eye(3)])
    found = nearest_rotations(degenerate)
    np.testing.assert_allclose(found @ found.transpose(0, 2, 1), np.tile(np.eye(3), (3, 1, 1)), atol=1e-9)
    np.testing.assert_allclose(np.linalg.det(found), 1.0)


@pytest.mark.parametrize("bending", [1.0, 0.0])
def test_a_rigid_motion_of_the_target_is_followed_exactly(figure, rotation, bending):
    points, surface = prepared(*figure)
    target = points @ rotation + 0.3
    body = ElasticBody(*stiffness_and_mass(surface), points, figure[1], np.array([[0, 1000], [7, 2000]]))
    moved = body.towards(target, 10.0, 3, bending=bending, pressed=True)
    np.testing.assert_allclose(moved, target, atol=1e-9)


def test_pressure_keeps_the_compactness(figure):
    points, surface = prepared(*figure)
    squashed = points * [1.0, 1.0, 0.4]
    body = ElasticBody(*stiffness_and_mass(surface), points, figure[1])
    bare = body.towards(squashed, 30.0, 5)
    kept = body.towards(squashed, 30.0, 5, pressed=True)
    assert compactness_error(points, kept, figure[1]) < 0.1 * compactness_error(points, bare, figure[1])


@pytest.mark.parametrize("strain", [0.05, 0.4])
def test_skin_yields_where_a_pose_stretches_it(strain):
    """The tetrahedron again: three steps beyond the springs, each against a force that no longer grows."""
    points = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
    body = ElasticBody(*stiffness_and_mass(triangulated(points, faces)), points, faces)
    firmness, anchor = 4 / np.sqrt(3), 3 * body.mass[0]
    size = (firmness + anchor * (1 + strain)) / (firmness + anchor)
    for _ in range(3):
        size = (firmness * (size - np.clip(size - 1, -0.15, 0.15)) + anchor * (1 + strain)) / (firmness + anchor)
    moved = body.turned_towards(np.tile(np.eye(3), (4, 1, 1)), points * (1 + strain), np.full(4, 3.0))
    np.testing.assert_allclose(moved, points * size, atol=1e-9)


def test_frames_carry_a_rigid_motion_exactly(figure, rotation):
    points, _ = prepared(*figure)
    surface = working_surface(points, figure[1], 500)
    assert surface.coarse
    assert len(surface.points) < 0.5 * len(points)
    body = ElasticBody(*stiffness_and_mass(surface.triangulation), surface.points, surface.faces)
    frames = surface.prolong_frames(*body.frames(surface.points @ rotation + 1.0))
    np.testing.assert_allclose(moved_by_frames(points, *frames), points @ rotation + 1.0, atol=1e-9)


def test_deformation_follows_rigid_targets_and_rounds_squashed_ones(figure, rotation):
    vertices, faces = figure
    surface = intrinsic_delaunay(triangulated(vertices, faces))
    body = ElasticBody(*stiffness_and_mass(surface), vertices, faces)
    moved = body.towards(vertices @ rotation, 1.0, 3)
    np.testing.assert_allclose(moved, vertices @ rotation, atol=1e-9)
    squashed = vertices.copy()
    thin = vertices[:, 1] > 0.7
    squashed[thin, 0] *= 0.3
    rounded = body.towards(squashed, 0.05, 30)
    before, after = (np.abs(edge_stretch(vertices, x, faces) - 1).mean() for x in (squashed, rounded))
    assert after < 0.5 * before
