"""The Auto Diffusion Function."""

import numpy as np
import pytest
from scipy.sparse import csr_matrix

from addon.core import InvalidSettingsError, Settings
from addon.core.detection.auto_diffusion import auto_diffusion
from addon.core.surface.delaunay import intrinsic_delaunay
from addon.core.surface.laplacian import mass, stiffness
from addon.core.surface.spectrum import Spectrum, compute_spectrum
from addon.core.surface.triangulation import triangulated
from tests.meshes import shapes
from tests.meshes.shapes import Mesh


def operators(vertices: np.ndarray, faces: np.ndarray) -> tuple[csr_matrix, np.ndarray]:
    surface = intrinsic_delaunay(triangulated(vertices, faces))
    return stiffness(surface), mass(surface)


def test_auto_diffusion_is_constant_on_a_sphere_and_scales_like_one_over_area(sphere: Mesh, figure):
    adf = auto_diffusion(compute_spectrum(*operators(*sphere), 24))
    assert np.ptp(adf) < 0.03 * adf.mean()
    vertices, faces = figure
    small, large = (auto_diffusion(compute_spectrum(*operators(vertices * s, faces), 60)) for s in (1, 10))
    np.testing.assert_allclose(large * 100, small, rtol=1e-8)


def test_auto_diffusion_needs_a_positive_time(sphere: Mesh):
    spectrum = compute_spectrum(*operators(*sphere), 5)
    for time in (0.0, -1.0):
        with pytest.raises(InvalidSettingsError, match="positive"):
            auto_diffusion(spectrum, time)


def test_auto_diffusion_is_its_formula():
    spectrum = Spectrum(np.array([2.0, 6.0]), np.array([[1.0, 3.0], [2.0, -1.0]]))
    wanted = [1 * np.exp(-0.5) + 9 * np.exp(-1.5), 4 * np.exp(-0.5) + 1 * np.exp(-1.5)]
    np.testing.assert_allclose(auto_diffusion(spectrum, 0.5), wanted, rtol=1e-15)


def test_the_diffusion_time_is_that_of_the_settings():
    spectrum = compute_spectrum(*operators(*shapes.sphere(2)), 20)
    np.testing.assert_array_equal(auto_diffusion(spectrum), auto_diffusion(spectrum, Settings().diffusion_time))
