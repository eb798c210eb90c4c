import numpy as np
import pytest

from addon.core.measures.detail_kept import (
    area_distortion,
    detail_measures,
    fold_changes,
    neighbouring_triangles,
    thickness,
)
from tests.meshes import shapes


def test_a_ball_is_as_thick_as_its_diameter_wherever_it_is(sphere, rotation):
    vertices, faces = sphere
    measured = thickness(vertices, faces)
    assert np.median(measured) == pytest.approx(2.0, rel=0.05)
    assert measured.max() < 2.01
    assert measured.min() > 1.7  # neighbours, where the normal is not quite the sphere's
    np.testing.assert_allclose(thickness(3 * vertices @ rotation + 7, faces), 3 * measured, rtol=1e-6)


def test_a_ball_that_touches_has_no_vertex_in_it(figure):
    from scipy.spatial.distance import cdist

    from addon.core.mesh.geometry import vertex_normals

    vertices, faces = figure
    normals = vertex_normals(vertices, faces)
    away = vertices[None] - vertices[:, None]  # from p to q
    with np.errstate(divide="ignore", invalid="ignore"):
        through = cdist(vertices, vertices) ** 2 / -np.einsum("pqi,pi->pq", away, normals)
    through[~(through > 0)] = np.inf  # the diameter of the ball that touches at p and goes through q
    size = 2 * np.linalg.norm(np.ptp(vertices, axis=0))
    np.testing.assert_allclose(thickness(vertices, faces), np.minimum(through.min(axis=1), size), rtol=1e-6)


def test_only_some_vertices_are_measured(figure):
    vertices, faces = figure
    np.testing.assert_array_equal(thickness(vertices, faces, np.array([3, 50])), thickness(vertices, faces)[[3, 50]])


def test_a_bent_sheet_is_folded_at_its_bend():
    vertices, faces = shapes.grid(5, 5)
    vertices = vertices.astype(float)
    bend = np.unique(vertices[:, 0])[2]
    bent = vertices.copy()
    beyond = vertices[:, 0] > bend
    bent[beyond] = np.column_stack(
        [np.full(beyond.sum(), bend), vertices[beyond, 1], vertices[beyond, 2] + vertices[beyond, 0] - bend]
    )
    pairs = neighbouring_triangles(faces)
    turned = np.degrees(fold_changes(vertices, bent, faces, pairs))
    assert np.count_nonzero(turned > 45) == 4
    np.testing.assert_allclose(turned[turned > 45], 90)
    np.testing.assert_allclose(fold_changes(bent, bent, faces, pairs), 0)
    one, other = vertices * [1.0, 1, -1], bent * [1.0, 1, -1]
    np.testing.assert_allclose(np.degrees(fold_changes(one, other, faces, pairs)), turned, atol=1e-9)
    sides = np.where(vertices[:, 0] <= bend, 0, 1)
    measured = detail_measures(vertices, bent, faces, sides)
    assert measured["jags"] == pytest.approx(4 / len(pairs))
    assert measured["edge_distortion_999"] == pytest.approx(0, abs=1e-12)
    assert measured["border_jags"] > measured["jags"]


def test_a_valley_that_becomes_a_ridge_is_a_change():
    flat = np.array([[0.0, 0, 0], [0, 1, 0], [-1, 0, 0], [1, 0, 0]])
    up, down = flat.copy(), flat.copy()
    up[3, 2], down[3, 2] = 0.5, -0.5
    faces = np.array([[0, 1, 2], [1, 0, 3]])
    change = fold_changes(up, down, faces, neighbouring_triangles(faces))
    np.testing.assert_allclose(change, 2 * np.arctan(0.5))


def test_nothing_changes_when_the_whole_moves(figure, rotation):
    vertices, faces = figure
    measured = detail_measures(vertices, vertices @ rotation + 3.0, faces)
    assert np.isnan(measured.pop("border_jags"))
    assert max(measured.values()) == pytest.approx(0, abs=1e-9)
    assert area_distortion(vertices, 2 * vertices, faces) == pytest.approx(3)


def test_crossings_are_counted_when_a_form_has_more_of_them():
    ball, faces = shapes.sphere(2)
    apart = np.concatenate([ball, ball + np.array([2.5, 0, 0])])
    both = np.concatenate([faces, faces + len(ball)])
    meeting = np.concatenate([ball, ball + np.array([0.7, 0.03, 0.01])])
    assert detail_measures(apart, meeting, both)["crossings_added"] > 0
    assert detail_measures(meeting, apart, both)["crossings_added"] == 0
