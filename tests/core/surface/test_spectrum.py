from contextlib import nullcontext

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.sparse import block_diag

from addon.core import CancelledError, InvalidSettingsError, Settings, SolverError
from addon.core.detection.auto_diffusion import auto_diffusion
from addon.core.run.monitor import Monitor
from addon.core.surface import spectrum
from addon.core.surface.delaunay import intrinsic_delaunay
from addon.core.surface.laplacian import mass, stiffness
from addon.core.surface.spectrum import Spectrum, compute_spectrum
from addon.core.surface.triangulation import triangulated
from tests.meshes import shapes


def operators(vertices, faces):
    surface = intrinsic_delaunay(triangulated(vertices, faces))
    return stiffness(surface), mass(surface)


def test_eigenvalues_of_the_sphere():
    spectrum = compute_spectrum(*operators(*shapes.sphere(5)), 24)  # 10,242 vertices
    true = np.concatenate([[degree * (degree + 1)] * (2 * degree + 1) for degree in range(1, 5)])
    np.testing.assert_allclose(spectrum.eigenvalues, true, rtol=0.01)


def test_eigenvalues_of_a_rectangle_with_free_border():
    spectrum = compute_spectrum(*operators(*shapes.grid(61, 41, 3.0, 2.0)), 6)
    true = sorted((np.pi * i / 3) ** 2 + (np.pi * j / 2) ** 2 for i in range(5) for j in range(5))[1:7]
    np.testing.assert_allclose(spectrum.eigenvalues, true, rtol=0.01)


def test_residual_and_orthonormality(figure):
    L, M = operators(*figure)
    spectrum = compute_spectrum(L, M, 100)
    h = spectrum.eigenvectors
    residual = (L @ h - (M[:, None] * h) * spectrum.eigenvalues) / np.sqrt(M)[:, None]
    assert (np.linalg.norm(residual, axis=0) / spectrum.eigenvalues).max() < 1e-8
    assert np.abs(h.T @ (M[:, None] * h) - np.eye(100)).max() < 1e-9
    assert np.abs(M @ h).max() < 1e-9


def test_sparse_and_dense_solvers_agree(figure):
    L, M = operators(*figure)
    values = eigh(L.toarray(), np.diag(M), eigvals_only=True, subset_by_index=(1, 30))
    np.testing.assert_allclose(compute_spectrum(L, M, 30).eigenvalues, values, rtol=1e-8)
    assert len(compute_spectrum(L, M, 29).eigenvalues) == 29


@pytest.mark.parametrize(("which", "error", "passes"), [("lowest", 0.7, True), ("lowest", 1.5, False),
                                                        ("highest", 0.7, True), ("highest", 1.5, False)])  # fmt: skip
def test_eigenpairs_may_be_as_inexact_as_their_users_can_bear(which, error, passes, monkeypatch, figure):
    """The residual behind the inverse, times λ_1/λ, against 1e-8: a vector that is off towards another by that much."""
    L, M = operators(*figure)
    true = compute_spectrum(L, M, 30).eigenvalues

    def off(*given):
        values, vectors = exact(*given)
        order = np.argsort(-values)
        low, high = order[1], order[30]
        share = 1e-8 * error / (1 - true[0] / true[29])
        wrong, towards = (low, high) if which == "lowest" else (high, low)
        vectors[:, wrong] = vectors[:, wrong] + share * vectors[:, towards]
        return values, vectors

    exact = spectrum._largest
    monkeypatch.setattr(spectrum, "_largest", off)
    with nullcontext() if passes else pytest.raises(SolverError, match="only accurate to"):
        compute_spectrum(L, M, 30)


def test_a_small_mesh_gives_all_it_has():
    assert len(compute_spectrum(*operators(*shapes.sphere(0)), 100).eigenvalues) == 11


def test_auto_diffusion_is_constant_on_a_sphere_and_scales_like_one_over_area(sphere, figure):
    adf = auto_diffusion(compute_spectrum(*operators(*sphere), 24))
    assert np.ptp(adf) < 0.03 * adf.mean()
    vertices, faces = figure
    small, large = (auto_diffusion(compute_spectrum(*operators(vertices * s, faces), 60)) for s in (1, 10))
    np.testing.assert_allclose(large * 100, small, rtol=1e-8)


def test_auto_diffusion_needs_a_positive_time(sphere):
    spectrum = compute_spectrum(*operators(*sphere), 5)
    for time in (0.0, -1.0):
        with pytest.raises(InvalidSettingsError, match="positive"):
            auto_diffusion(spectrum, time)


def test_it_hears_a_cancel(sphere):
    with pytest.raises(CancelledError):
        compute_spectrum(*operators(*sphere), 20, Monitor(cancelled=lambda: True))


def test_auto_diffusion_is_its_formula():
    spectrum = Spectrum(np.array([2.0, 6.0]), np.array([[1.0, 3.0], [2.0, -1.0]]))
    wanted = [1 * np.exp(-0.5) + 9 * np.exp(-1.5), 4 * np.exp(-0.5) + 1 * np.exp(-1.5)]
    np.testing.assert_allclose(auto_diffusion(spectrum, 0.5), wanted, rtol=1e-15)


def test_a_surface_in_two_parts_has_no_spectrum(sphere):
    L, M = operators(*sphere)
    with pytest.raises(SolverError, match="falls into parts"):
        compute_spectrum(block_diag([L, L]).tocsr(), np.concatenate([M, M]), 10)


def test_the_diffusion_time_is_that_of_the_settings():
    spectrum = compute_spectrum(*operators(*shapes.sphere(2)), 20)
    np.testing.assert_array_equal(auto_diffusion(spectrum), auto_diffusion(spectrum, Settings().diffusion_time))


@pytest.mark.parametrize("size", [1.0, 1e3])
def test_a_thread_is_one_surface(size):
    vertices, faces = shapes.grid(300, 2, 100.0, 0.1)
    spectrum = compute_spectrum(*operators(size * vertices, faces), 3)
    assert spectrum.eigenvalues[0] == pytest.approx((np.pi / (100 * size)) ** 2, rel=1e-3)
