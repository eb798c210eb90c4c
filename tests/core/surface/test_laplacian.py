import numpy as np
import pytest
import robust_laplacian

from addon.core.surface.delaunay import intrinsic_delaunay
from addon.core.surface.laplacian import mass, stiffness
from addon.core.surface.triangulation import triangulated
from tests.meshes import shapes


def test_constants_have_no_stiffness_and_mass_is_area(figure):
    surface = triangulated(*figure)
    L = stiffness(surface)
    assert np.abs(L @ np.ones(L.shape[0])).max() < 1e-12 * abs(L).max()
    assert abs(L - L.T).max() == 0
    assert mass(triangulated(*shapes.grid(5, 5, 2.0, 3.0))).sum() == pytest.approx(6.0)


def test_dirichlet_energy_of_a_linear_function_is_exact():
    vertices, faces = shapes.grid(8, 6, 2.0, 1.5)
    vertices[8:-8, :2] += np.random.default_rng(0).uniform(-0.05, 0.05, (len(vertices) - 16, 2)) * (
        (vertices[8:-8, :1] > 0) & (vertices[8:-8, :1] < 2)
    )
    linear = 3 * vertices[:, 0] - 2 * vertices[:, 1]
    assert linear @ stiffness(triangulated(vertices, faces)) @ linear == pytest.approx(13 * 3.0)


def test_intrinsic_delaunay_laplacian_agrees_with_robust_laplacian(figure):
    vertices, faces = figure
    vertices = vertices * [1.0, 3.0, 0.5]
    surface = intrinsic_delaunay(triangulated(vertices, faces))
    L, M = robust_laplacian.mesh_laplacian(vertices, faces)
    assert abs(L - stiffness(surface)).max() < 1e-9 * abs(L).max()
    np.testing.assert_allclose(mass(surface), M.diagonal(), rtol=1e-9)
