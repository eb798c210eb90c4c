from contextlib import nullcontext

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.sparse import block_diag, csr_matrix

from addon.core import CancelledError, SolverError
from addon.core.run.monitor import Monitor
from addon.core.surface import spectrum
from addon.core.surface.delaunay import intrinsic_delaunay
from addon.core.surface.laplacian import mass, stiffness
from addon.core.surface.spectrum import compute_spectrum
from addon.core.surface.triangulation import triangulated
from tests.meshes import shapes
from tests.meshes.shapes import Mesh


def operators(vertices: np.ndarray, faces: np.ndarray) -> tuple[csr_matrix, np.ndarray]:
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


def test_it_hears_a_cancel(sphere: Mesh):
    with pytest.raises(CancelledError):
        compute_spectrum(*operators(*sphere), 20, Monitor(cancelled=lambda: True))


def test_a_surface_in_two_parts_has_no_spectrum(sphere):
    L, M = operators(*sphere)
    with pytest.raises(SolverError, match="disconnected"):
        compute_spectrum(block_diag([L, L]).tocsr(), np.concatenate([M, M]), 10)


@pytest.mark.parametrize("size", [1.0, 1e3])
def test_a_thread_is_one_surface(size):
    vertices, faces = shapes.grid(300, 2, 100.0, 0.1)
    spectrum = compute_spectrum(*operators(size * vertices, faces), 3)
    assert spectrum.eigenvalues[0] == pytest.approx((np.pi / (100 * size)) ** 2, rel=1e-3)


def test_eigenvalues_too_large_for_the_inverse_are_large_and_not_negative():
    """Where masses differ by 10²⁴ the inverse knows the highest ones only as zero, with either sign."""
    count = 60
    rows = np.arange(count - 1)
    chain = csr_matrix((np.full(count - 1, -1.0), (rows, rows + 1)), shape=(count, count))
    chain = chain + chain.T
    chain -= csr_matrix(np.diag(np.asarray(chain.sum(axis=1)).ravel()))
    light = np.where(np.arange(count) % 3 == 0, 1.0, 1e-24 * np.random.default_rng(0).uniform(0.5, 2, count))
    found = compute_spectrum(chain, light, count - 1)
    assert (found.eigenvalues > 0).all()
    assert (np.diff(found.eigenvalues) >= 0).all()
