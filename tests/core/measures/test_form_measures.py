import numpy as np
import pytest

from addon.core.deformation.elastic_body import ElasticBody
from addon.core.measures.alignment import closest_point_fit, outside_out, rigid_fit
from addon.core.measures.form_measures import (
    compactness,
    compactness_error,
    edge_stretch,
    enclosed_volume,
    hausdorff,
    summary,
)
from addon.core.mesh.geometry import surface_area
from addon.core.surface.delaunay import intrinsic_delaunay
from addon.core.surface.triangulation import triangulated
from tests.meshes import shapes


def test_compactness_of_a_sphere_and_a_cube(sphere):
    assert compactness(*sphere) == pytest.approx(1 / (36 * np.pi), rel=0.005)
    cube = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    assert enclosed_volume(cube, faces) == pytest.approx(1.0)
    assert surface_area(cube, faces) == pytest.approx(6.0)
    assert compactness(cube * 7 + 100, faces) == pytest.approx(1 / 216)


def test_compactness_of_an_open_mesh_is_not_a_number():
    assert np.isnan(compactness(*shapes.grid(4, 4)))


def test_compactness_error_and_edge_stretch(figure):
    vertices, faces = figure
    assert compactness_error(vertices, 3 * vertices, faces) == pytest.approx(0, abs=1e-12)
    np.testing.assert_allclose(edge_stretch(vertices, 3 * vertices, faces), 3.0)


def test_hausdorff_sees_shape_and_not_place(figure, rotation):
    vertices, _ = figure
    rng = np.random.default_rng(0)
    shuffled = rng.permutation(vertices)
    assert hausdorff(shuffled @ rotation + [5.0, -3.0, 2.0], vertices) < 1e-6
    bumped = shuffled.copy()
    tip = int(np.argmax(np.linalg.norm(shuffled - shuffled.mean(axis=0), axis=1)))
    bumped[tip] *= 1.2
    assert hausdorff(bumped, vertices) == pytest.approx(0.2 * np.linalg.norm(shuffled[tip]), rel=0.05)


def test_summary_has_every_measure(figure):
    vertices, faces = figure
    assert summary(vertices, vertices, faces)["edge_distortion_95"] == 0
    assert set(summary(vertices, vertices, faces)) == {
        "compactness", "compactness_error", "hausdorff", "edge_distortion_median", "edge_distortion_95",
    }  # fmt: skip


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
    body = ElasticBody(surface, vertices, faces)
    np.testing.assert_array_equal(outside_out(body, vertices @ rotation), vertices @ rotation)
    np.testing.assert_array_equal(outside_out(body, vertices * [1, -1, 1]), vertices * [1, -1, -1])


def test_deformation_follows_rigid_targets_and_rounds_squashed_ones(figure, rotation):
    vertices, faces = figure
    surface = intrinsic_delaunay(triangulated(vertices, faces))
    body = ElasticBody(surface, vertices, faces)
    moved = body.deformed_towards(vertices @ rotation, pull=1.0, steps=3)
    np.testing.assert_allclose(moved, vertices @ rotation, atol=1e-9)
    squashed = vertices.copy()
    thin = vertices[:, 1] > 0.7
    squashed[thin, 0] *= 0.3
    rounded = body.deformed_towards(squashed, pull=0.05, steps=30)
    before, after = (np.abs(edge_stretch(vertices, x, faces) - 1).mean() for x in (squashed, rounded))
    assert after < 0.5 * before
