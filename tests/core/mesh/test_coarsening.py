"""Coarse meshes: still surfaces, evenly covered, and the way back."""

import numpy as np
import pytest

from addon.core import CancelledError
from addon.core.mesh import coarsening
from addon.core.mesh.coarsening import coarsened
from addon.core.mesh.connectivity import component_labels
from addon.core.mesh.edges import is_closed, vertex_pairs
from addon.core.mesh.geometry import signed_volume, surface_area
from addon.core.run.monitor import Monitor
from tests.meshes import shapes
from tests.meshes.shapes import Mesh


@pytest.fixture(scope="module")
def coarse(figure: Mesh):
    return coarsened(*figure, 600)


def test_the_coarse_mesh_is_the_same_surface(figure, coarse):
    vertices, faces = figure
    kept = vertices[coarse.kept]
    assert len(kept) == 600
    assert len(coarse.faces) == 2 * len(kept) - 4  # closed, of genus 0
    assert is_closed(faces)
    assert is_closed(coarse.faces)
    assert component_labels(len(kept), vertex_pairs(coarse.faces)).max() == 0
    assert surface_area(kept, coarse.faces) == pytest.approx(surface_area(vertices, faces), rel=0.06)
    assert signed_volume(kept, coarse.faces) == pytest.approx(signed_volume(vertices, faces), rel=0.06)


def test_triangles_keep_their_side(coarse):
    directed = coarse.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    assert len(np.unique(directed, axis=0)) == len(directed)  # every edge once each way: oriented


def test_what_is_prolonged_is_an_average(figure, coarse):
    vertices, _ = figure
    np.testing.assert_allclose(coarse.prolong(np.ones(600)), 1.0, rtol=1e-12)
    back = coarse.prolong(vertices[coarse.kept])
    np.testing.assert_array_equal(back[coarse.kept], vertices[coarse.kept])
    assert np.linalg.norm(back - vertices, axis=1).mean() < 0.03 * np.sqrt(surface_area(*figure))


def test_on_a_plane_a_linear_function_comes_back_exactly():
    vertices, faces = shapes.grid(31, 31, 1.0, 1.0)
    coarse = coarsened(vertices, faces, 200)
    assert not is_closed(coarse.faces)
    back = coarse.prolong(vertices[coarse.kept])
    inside = (np.abs(vertices[:, :2] - vertices[:, :2].mean(axis=0)) < 0.35).all(axis=1)
    assert np.abs(back - vertices)[inside].max() < 1e-9
    assert surface_area(vertices[coarse.kept], coarse.faces) == pytest.approx(1.0, abs=0.02)  # the border stays


def test_fixed_vertices_stay(figure: Mesh):
    fixed = np.array([5, 77, 901])
    coarse = coarsened(*figure, 300, fixed=fixed)
    assert np.isin(fixed, coarse.kept).all()


def test_a_mesh_that_cannot_shrink_comes_back_whole():
    fan = np.array([[0, 1, k] for k in range(2, 12)])  # an edge of ten triangles,
    fan = np.concatenate([fan, fan[:, [1, 0, 2]]])  # each there twice, so that no vertex is inside or on a border
    points = np.random.default_rng(0).normal(size=(12, 3))
    coarse = coarsened(points, fan, 4)
    np.testing.assert_array_equal(coarse.kept, np.arange(12))
    np.testing.assert_array_equal(coarse.faces, fan)
    assert not coarse.rounds


def test_what_hangs_on_an_edge_of_ten_triangles_is_prolonged():
    fan = np.array([[0, 1, k] for k in range(2, 12)])
    coarse = coarsened(np.random.default_rng(0).normal(size=(12, 3)), fan, 4)
    assert {0, 1} <= set(coarse.kept)
    np.testing.assert_allclose(coarse.prolong(np.ones(len(coarse.kept))), 1.0)


def test_numbers_of_vertices_do_not_matter(figure: Mesh):
    vertices, faces, old = shapes.permuted(*figure)
    one, two = coarsened(*figure, 600), coarsened(vertices, faces, 600)
    share = len(np.intersect1d(one.kept, old[two.kept])) / 600
    assert share > 0.9  # all but exact ties


@pytest.mark.parametrize("scale", [1.0, 7.3, 1e-3])
def test_rounding_decides_nothing_on_a_symmetric_mesh(rotation, scale):
    vertices, faces = shapes.sphere(4)
    vertices = vertices * [1.0, 1.7, 0.6]
    kept = coarsened(vertices, faces, 600).kept
    np.testing.assert_array_equal(coarsened(scale * (vertices @ rotation), faces, 600).kept, kept)


def test_it_stops_when_asked(figure: Mesh):
    with pytest.raises(CancelledError):
        coarsened(*figure, 600, monitor=Monitor(None, lambda: True))


def test_no_vertex_is_left_without_a_triangle():
    vertices, faces = shapes.grid(40, 30)
    rng = np.random.default_rng(0)
    vertices[:, 2] = 0.01 * rng.normal(size=len(vertices))
    ragged = faces[rng.random(len(faces)) > 0.12]  # ears, bow ties and pieces that hang by one vertex
    label = component_labels(len(vertices), vertex_pairs(ragged))[ragged[:, 0]]
    ragged = ragged[label == np.argmax(np.bincount(label))]
    used, corners = np.unique(ragged, return_inverse=True)
    coarse = coarsened(vertices[used], corners.reshape(-1, 3), 250)
    assert len(coarse.kept) < 600
    np.testing.assert_array_equal(np.unique(coarse.faces), np.arange(len(coarse.kept)))


@pytest.mark.parametrize("seed", range(4))
def test_what_hangs_together_at_single_vertices_goes_on_hanging(seed):
    """Some triangles left of many hang on one vertex each; drawn onto each other they would let go."""
    vertices, faces = shapes.grid(24, 24)
    chance = np.random.default_rng(seed)
    some = faces[chance.random(len(faces)) < 0.55]
    label = component_labels(len(vertices), vertex_pairs(some))[some[:, 0]]
    used, corners = np.unique(some[label == np.bincount(label).argmax()], return_inverse=True)
    points = vertices[used] + 0.01 * chance.normal(size=(len(used), 3))
    corners = corners.reshape(-1, 3)
    for share in (0.8, 0.6, 0.4, 0.2):
        coarse = coarsened(points, corners, int(share * len(points)))
        assert component_labels(len(coarse.kept), vertex_pairs(coarse.faces)).max() == 0
        assert np.unique(coarse.faces).tolist() == list(range(len(coarse.kept)))


def test_smaller_arrays_change_nothing(monkeypatch):
    points, faces = shapes.figure(20)
    compact = coarsened(points, faces, 100)
    monkeypatch.setattr(coarsening, "_COMPACT", 0.0)
    whole = coarsened(points, faces, 100)
    np.testing.assert_array_equal(compact.kept, whole.kept)
    np.testing.assert_array_equal(compact.faces, whole.faces)
    np.testing.assert_array_equal(compact.prolong(points[compact.kept]), whole.prolong(points[whole.kept]))
