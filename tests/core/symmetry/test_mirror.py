"""Mirror planes, and forms held symmetric."""

import numpy as np
import pytest
from scipy.spatial import KDTree

from addon.core.deformation.elastic_body import ElasticBody
from addon.core.mesh.geometry import surface_area
from addon.core.surface.laplacian import stiffness_and_mass
from addon.core.surface.triangulation import triangulated
from addon.core.symmetry.mirror import MirrorMap, asymmetry, held_symmetric, mirror_plane
from tests.meshes import shapes


@pytest.fixture(scope="module")
def ball():
    vertices, faces = shapes.sphere(3)
    vertices = vertices / np.sqrt(surface_area(vertices, faces))
    partner = KDTree(vertices).query(vertices * [-1.0, 1, 1])[1]
    return ElasticBody(*stiffness_and_mass(triangulated(vertices, faces)), vertices, faces), partner


def test_the_plane_of_a_mirrored_cloud_is_found_wherever_it_lies(rotation):
    cloud = np.random.default_rng(0).normal(size=(50, 3)) @ rotation + 3.0
    normal = rotation[1]
    mirrored = cloud - 2 * ((cloud - 7.0) @ normal)[:, None] * normal
    plane = mirror_plane(cloud, mirrored, np.ones(50))
    np.testing.assert_allclose(plane.mirrored(cloud), mirrored, atol=1e-10)
    np.testing.assert_allclose(plane.mirrored(plane.mirrored(cloud)), cloud, atol=1e-12)


def test_a_symmetric_form_stays_and_a_skew_one_comes_to_the_mean(ball):
    body, partner = ball
    assert asymmetry(body.points, partner, body.mass) < 1e-10
    np.testing.assert_allclose(held_symmetric(body, body.points, MirrorMap(partner, 1.0)), body.points, atol=1e-10)
    swung = body.points + 0.2 * np.maximum(body.points[:, :1], 0) ** 2 * [0, 1, 0]  # one side alone
    before = asymmetry(swung, partner, body.mass)
    held = held_symmetric(body, swung, MirrorMap(partner, 1.0))
    assert asymmetry(held, partner, body.mass) < 0.2 * before
    np.testing.assert_array_equal(held_symmetric(body, swung, MirrorMap(partner, 0.0)), swung)


def test_what_is_small_keeps_its_side(ball):
    body, partner = ball
    wart = np.zeros(len(body.points))
    wart[np.argmax(body.points[:, 0])] = 0.05
    warty = body.points * (1 + wart)[:, None]
    held = held_symmetric(body, warty, MirrorMap(partner, 1.0))
    assert np.abs(held - warty).max() < 0.2 * np.abs(warty - body.points).max()
