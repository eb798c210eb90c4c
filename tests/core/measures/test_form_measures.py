import numpy as np
import pytest

from addon.core.measures.form_measures import (
    compactness,
    compactness_error,
    edge_stretch,
    hausdorff,
    summary,
)
from addon.core.mesh.geometry import signed_volume, surface_area
from tests.meshes import shapes


def test_compactness_of_a_sphere_and_a_cube(sphere):
    assert compactness(*sphere) == pytest.approx(1 / (36 * np.pi), rel=0.005)
    cube = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    assert signed_volume(cube, faces) == pytest.approx(1.0)
    assert surface_area(cube, faces) == pytest.approx(6.0)
    assert compactness(cube * 7 + 100.0, faces) == pytest.approx(1 / 216)


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
